//! Optional capabilities of gears: small traits that a gear provides through [`GearModel`](super::GearModel).

use super::flank_displacement::FlankDisplacement;
use super::free_flight::FreeFlight;
use crate::Vec3;
use crate::geometry::{Flanks, Side};
use crate::kinematics::{PointWrench, Row, Tooth};
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::{Change, Coeffs, Singular, StateView};
use std::sync::Arc;

/// Flanks of a gear as grids of nodes.
#[derive(Clone, Copy)]
pub struct FlankSurface<'a> {
    /// Grids of all flanks.
    pub flanks: &'a Flanks,
    /// Positions of the nodes.
    pub nodes: &'a dyn FlankNodes,
    /// Displacements of the nodes along their normals, to be added to the rigid motion in [`Self::nodes`]; `None` for
    /// gears whose node positions are the deformed ones.
    pub displacement: Option<&'a dyn FlankDisplacement>,
}

/// Flanks as [lines](super::elastic::lines) of a gear with explicit node positions, for contact on half-spaces. Their
/// outward displacements are no linear function of the coordinates, and there is no residual compliance.
pub trait DeformedLines {
    /// Returns the flanks whose nodes are the lines.
    fn flanks(&self) -> &Flanks;

    /// Returns the displacement of the lines of each flank under line loads, as [`FlankDisplacement::near_field`].
    fn near_field(&self) -> &Arc<Vec<Vec<f64>>>;

    /// Returns the outward displacement of a line [m], and its derivative by the motion of the hub at fixed node
    /// positions.
    fn outward(&self, at: StateView<'_>, line: u32) -> (f64, PointWrench);

    /// Appends the slopes of `sum w_i a_i` of the outward displacements of lines by the positions of their nodes to a
    /// row of this gear.
    fn row(&self, at: StateView<'_>, lines: &[u32; 4], weights: &[f64; 4], row: &mut Row);
}

/// Positions of flank nodes in space.
pub trait FlankNodes {
    /// Computes the positions in space [m] of some nodes; called for one flank at a time, once per evaluation.
    fn positions(&self, at: StateView<'_>, nodes: &[u32], out: &mut [Vec3]);
}

/// Deflection and force of the spring of a tooth at a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToothSpring {
    /// Angle of the tooth relative to its body, `S - phi` [rad]; displacement of a rack's tooth [m].
    pub deflection: f64,
    /// Force of spring and damper on the tooth, `k r_d (phi - S) + c r_d (phi' - S')` [N].
    pub force: f64,
}

/// Teeth with individual displacements.
pub trait ToothCoordinates {
    /// Returns the angle of a tooth from its assembled position [rad] (displacement [m] for a rack), without the
    /// pitch.
    fn displacement(&self, at: StateView<'_>, tooth: Tooth) -> f64;

    /// Computes [`Self::displacement`] of consecutive teeth from `first` on.
    fn displacements(&self, at: StateView<'_>, first: Tooth, out: &mut [f64]) {
        for (index, displacement) in (first.index..).zip(out) {
            *displacement = self.displacement(at, Tooth { index, ..first });
        }
    }

    /// Returns the coordinate that is the displacement of a tooth, where a contact force acts on that coordinate
    /// alone, by the effective radius arm of the hub; `None` where teeth move by several.
    fn coordinate(&self, _discrete: &[f64], _tooth: Tooth) -> Option<usize> {
        None
    }

    /// Returns the spring between a tooth and its body; `None` for a tooth without a spring.
    fn spring(&self, _at: StateView<'_>, _tooth: Tooth) -> Option<ToothSpring> {
        None
    }

    /// Returns the number of cells of the discrete state, from the first on, on which [`Self::coordinate`] depends.
    fn places(&self) -> usize {
        0
    }

    /// Returns true if the springs depend on the contact radius, so that [`Self::engage`] has to be called.
    fn follows_contact(&self) -> bool {
        false
    }

    /// Updates the discrete state when a contact of a tooth opens or closes.
    fn engage(&self, _discrete: &mut [f64], _tooth: Tooth, _side: Side, _closed: bool) -> Change {
        Change::None
    }

    /// Hands teeth over after an accepted step. The slices are those of the gear.
    fn commit(&self, _t: f64, _q: &mut [f64], _v: &mut [f64], _discrete: &mut [f64]) -> Change {
        Change::None
    }
}

/// Independent oscillators, `M^-1 f = -omega^2 q - 2 zeta omega v + remainder`, one entry per coordinate; zero for the
/// motion of a hub.
#[derive(Clone, Copy, Debug)]
pub struct Oscillators<'a> {
    /// Angular frequencies [rad/s].
    pub omega: &'a [f64],
    /// Damping ratios [-].
    pub zeta: &'a [f64],
}

/// A gear whose motion between contacts is linear and has a closed form.
pub trait LinearMotion {
    /// Returns the oscillators of the coordinates, with a constant diagonal mass; `None` where they are coupled.
    fn oscillators(&self) -> Option<Oscillators<'_>> {
        None
    }

    /// Returns true if Coriolis forces couple the modes.
    fn spins(&self) -> bool {
        false
    }

    /// Adds the internal forces that are not in [`Self::oscillators`]: the inertia of the modal coordinates under a
    /// prescribed motion of the hub, and their coupling by a bearing.
    fn add_other_forces(&self, _at: StateView<'_>, _f: &mut [f64]) {}

    /// Sets the compliance per unit of acceleration [s^2] that a method leaves out of the [`Self::oscillators`] under
    /// quasi-static forces; gears with a residual compliance add the remainder to it. `None` for a method that leaves
    /// nothing out.
    fn set_quasi_static_correction(&self, _missing: Option<&[f64]>) {}

    /// Returns the free flight from a state under a steady `load` on a free hub; `None` where there is no closed form.
    fn free_flight(&self, at: StateView<'_>, load: f64) -> Option<FreeFlight>;

    /// Adds that motion to a closed-form path, its coordinates from `first` on; called only where there is a
    /// [`Self::free_flight`].
    fn add_to_path(&self, at: StateView<'_>, load: f64, first: usize, path: &mut FlightPath);

    /// Returns the work of a steady `load` on a free hub, or of a prescribed motion on the modal coordinates, between
    /// two states of a flight [J].
    fn steady_work(&self, from: StateView<'_>, to: StateView<'_>, load: f64) -> f64;
}

/// A gear with many coordinates of which a contact acts on few: the scene then condenses the Newton correction to
/// those.
pub trait LargeGear {
    /// Computes the restriction of `A^-1` of [`GearModel::correct`](super::GearModel::correct) to some coordinates,
    /// `g[i * n + j] = A^-1[c_i, c_j]`, symmetric; `g` has `n * n` values.
    fn condensed(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        coordinates: &[u32],
        g: &mut [f64],
    ) -> Result<(), Singular>;

    /// Adds the response of all coordinates to forces on some: `x += A^-1 E f`.
    fn add_response(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        touched: (&[u32], &[f64]),
        x: &mut [f64],
    ) -> Result<(), Singular>;

    /// Returns the number of factorisations so far.
    fn factorisations(&self) -> u64;
}

/// A mass matrix that is not constant and diagonal.
pub trait CoupledMass {
    /// Solves with the mass matrix in place: `f <- M^-1 f`.
    fn solve(&self, at: StateView<'_>, f_to_a: &mut [f64]);

    /// Multiplies by the mass matrix: `y = M x`.
    fn apply(&self, at: StateView<'_>, x: &[f64], y: &mut [f64]);
}
