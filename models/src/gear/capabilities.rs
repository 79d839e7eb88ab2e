//! What only some gears can do: small traits that a gear hands out through [`GearModel`](super::GearModel).

use super::flank_displacement::FlankDisplacement;
use super::free_flight::FreeFlight;
use crate::Vec3;
use crate::geometry::{Flanks, Side};
use crate::kinematics::{Row, Tooth};
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::{At, Change, Coeffs, Singular};
use std::sync::Arc;

/// The flanks of a gear as grids of nodes.
#[derive(Clone, Copy)]
pub struct FlankSurface<'a> {
    /// The grids.
    pub flanks: &'a Flanks,
    /// Where their nodes are.
    pub nodes: &'a dyn FlankNodes,
    /// Displacements of the nodes along their normals, on top of the rigid motion that [`Self::nodes`] then tells;
    /// `None` for gears whose node positions are the deformed ones.
    pub displacement: Option<&'a dyn FlankDisplacement>,
}

/// Flanks as [lines](super::elastic::lines) of a gear whose nodes say where they are, for contact on half-spaces: their
/// outward displacements are no linear function of the coordinates, and no compliance is left beside these.
pub trait DeformedLines {
    /// Flanks whose nodes are the lines.
    fn flanks(&self) -> &Flanks;

    /// Displacement of the lines of each flank by line loads, as [`FlankDisplacement::near_field`].
    fn near_field(&self) -> &Arc<Vec<Vec<f64>>>;

    /// Outward displacement of a line [m], and its slope by the displacement of the hub while the nodes stay in space.
    fn outward(&self, at: At<'_>, line: u32) -> (f64, f64);

    /// Appends the slopes of `sum w_i a_i` of the outward displacements of lines by the places of their nodes to a row
    /// that is targeted at this gear.
    fn row(&self, at: At<'_>, lines: &[u32; 4], weights: &[f64; 4], row: &mut Row);
}

/// Positions of flank nodes.
pub trait FlankNodes {
    /// Positions in space [m] of some nodes. The search asks for a flank at a time, once per evaluation.
    fn positions(&self, at: At<'_>, nodes: &[u32], out: &mut [Vec3]);
}

/// The spring behind a tooth in its present state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToothSpring {
    /// Angle of the tooth relative to its body, `S - phi` [rad]; displacement of a rack's tooth [m].
    pub deflection: f64,
    /// Force of spring and damper on the tooth, `k r_d (phi - S) + c r_d (phi' - S')` [N].
    pub force: f64,
}

/// Teeth with a displacement of their own.
pub trait ToothCoordinates {
    /// Angle of a tooth from its assembled position [rad] (displacement [m] for a rack), pitch not included.
    fn displacement(&self, at: At<'_>, tooth: Tooth) -> f64;

    /// [`Self::displacement`] of consecutive teeth from `first` on.
    fn displacements(&self, at: At<'_>, first: Tooth, out: &mut [f64]) {
        for (index, displacement) in (first.index..).zip(out) {
            *displacement = self.displacement(at, Tooth { index, ..first });
        }
    }

    /// The coordinate of the gear that is the displacement of a tooth, where a contact force acts on that one alone, by
    /// the effective radius arm of the hub; `None` where teeth move by several.
    fn coordinate(&self, _discrete: &[f64], _tooth: Tooth) -> Option<usize> {
        None
    }

    /// The spring between a tooth and its body; `None` where a tooth has none of its own.
    fn spring(&self, _at: At<'_>, _tooth: Tooth) -> Option<ToothSpring> {
        None
    }

    /// How many cells of its discrete state [`Self::coordinate`] depends on, from the first on.
    fn places(&self) -> usize {
        0
    }

    /// Its springs know the contact radius: [`Self::engage`] has to be told of contacts.
    fn follows_contact(&self) -> bool {
        false
    }

    /// A contact of a tooth opened or closed.
    fn engage(&self, _discrete: &mut [f64], _tooth: Tooth, _side: Side, _closed: bool) -> Change {
        Change::None
    }

    /// After an accepted step: hand teeth over. The slices are the gear's own.
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
    /// Damping ratios.
    pub zeta: &'a [f64],
}

/// A gear whose motion is linear between contacts, so that it is known in closed form.
pub trait LinearMotion {
    /// The oscillators that its coordinates are, with a constant diagonal mass; `None` where they are coupled.
    fn oscillators(&self) -> Option<Oscillators<'_>> {
        None
    }

    /// Coriolis forces couple its modes.
    fn spins(&self) -> bool {
        false
    }

    /// Adds what of the internal forces is not its [`Self::oscillators`]: the inertia of its own coordinates where the
    /// hub's motion is prescribed, what couples them with a bearing.
    fn add_other_forces(&self, _at: At<'_>, _f: &mut [f64]) {}

    /// A method lets the [`Self::oscillators`] give less than `1/omega^2` to forces that last, by so much per unit of
    /// acceleration [s^2]; gears with a residual compliance give the remainder by it. `None`: nothing is left out.
    fn set_quasi_static_correction(&self, _missing: Option<&[f64]>) {}

    /// Its free flight from a state under a steady `load` on a free hub; `None` where its motion is not known.
    fn free_flight(&self, at: At<'_>, load: f64) -> Option<FreeFlight>;

    /// Adds that motion to a free flight, its coordinates from `first` on; called where there is a
    /// [`Self::free_flight`].
    fn add_to_path(&self, at: At<'_>, load: f64, first: usize, path: &mut FlightPath);

    /// Cuts its vibrations off, about the deflection of a steady `load`; its momentum stays. The slices are its own.
    /// False when they rested, up to rounding.
    fn cut_off_vibrations(
        &self,
        _t: f64,
        _load: f64,
        _q: &mut [f64],
        _v: &mut [f64],
        _discrete: &mut [f64],
    ) -> bool {
        false
    }

    /// Work of a steady `load` on a free hub, or of a prescribed motion on the gear's own coordinates, between two
    /// states of a flight [J].
    fn steady_work(&self, from: At<'_>, to: At<'_>, load: f64) -> f64;
}

/// A gear with many coordinates of which a contact touches few: the scene then condenses the Newton correction to
/// those.
pub trait LargeGear {
    /// Restriction of `A^-1` of [`GearModel::correct`](super::GearModel::correct) to some coordinates, `g[i * n + j] = A^-1[c_i, c_j]`,
    /// symmetric; `g` holds `n * n` values.
    fn condensed(
        &self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        coordinates: &[u32],
        g: &mut [f64],
    ) -> Result<(), Singular>;

    /// `x += A^-1 E f`: the response of all coordinates to forces on some.
    fn add_response(
        &self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        touched: (&[u32], &[f64]),
        x: &mut [f64],
    ) -> Result<(), Singular>;

    /// Factorisations that were needed so far.
    fn factorisations(&self) -> u64;
}

/// A mass matrix that is not constant and diagonal.
pub trait CoupledMass {
    /// `f <- M^-1 f`.
    fn solve(&self, at: At<'_>, f_to_a: &mut [f64]);

    /// `y = M x`.
    fn apply(&self, at: At<'_>, x: &[f64], y: &mut [f64]);
}
