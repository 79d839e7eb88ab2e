//! The one gear-contact interface: what a gear model must tell the contact and the integrator.
//!
//! A gear has generalised coordinates (those of its mount first, then its own), a pose for each tooth,
//! a contact row, a mass and internal forces. Rigid, movable teeth and elastic bodies
//! differ in nothing else. A gear may take part in several meshes; the gears of a mesh may have different
//! models.

use super::free_flight::Flight;
use super::normal_field::NormalField;
use crate::Vec3;
use crate::geometry::{Flanks, Side};
use crate::kinematics::{Hub, MeshView, Point, Row, Tooth, Wrench};
use gearbench_integrators::Coast;
use gearbench_integrators::system::{At, Change, Coeffs, Energy, Singular};

/// Sizes of a gear model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coordinates {
    /// Free coordinates, the mount's first.
    pub n: usize,
    /// Length of the gear's memory.
    pub memory: usize,
}

/// Typical magnitudes that turn a relative tolerance into absolute ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnitudes {
    /// Deflection along the line of action [m].
    pub deflection: f64,
    /// Speed along the line of action [m/s].
    pub speed: f64,
}

/// Quantities of the hub and the whole body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HubState {
    /// Angle [rad] or travel [m] of the hub from the assembled position.
    pub travel: f64,
    /// Its rate.
    pub speed: f64,
    /// Angular momentum about the axis [kg m^2/s], or momentum along the slide [kg m/s].
    pub momentum: f64,
}

/// A gear whose coordinates are independent oscillators, `M^-1 f = -omega^2 q - 2 zeta omega v + rest`, one entry
/// per coordinate; zero for the motion of a hub.
#[derive(Clone, Copy, Debug)]
pub struct Oscillators<'a> {
    /// Angular frequencies [rad/s].
    pub omega: &'a [f64],
    /// Damping ratios.
    pub zeta: &'a [f64],
}

/// A gear at some fidelity. `at` holds the gear's own coordinates and memory only.
pub trait GearModel {
    /// Id of the model.
    fn id(&self) -> &'static str;

    /// The hub that carries the gear.
    fn hub(&self) -> &Hub;

    /// Its hub, to prescribe another motion; the number of its coordinates has to stay.
    fn hub_mut(&mut self) -> &mut Hub;

    /// Sizes.
    fn coordinates(&self) -> Coordinates;

    /// Tells the gear of one of its meshes, in order. Called while the scene is assembled, before
    /// [`Self::coordinates`] counts.
    fn attach(&mut self, _view: MeshView) {}

    /// Tells the gear how fast its hub moves at the start. Called once while the scene is assembled, before
    /// [`Self::constant_mass`] and [`Self::oscillators`].
    fn prepare(&mut self, _speed: f64) {}

    /// Magnitudes of coordinates and velocities.
    fn scales(&self, magnitudes: Magnitudes, q: &mut [f64], v: &mut [f64]);

    /// Sets the initial state of its coordinates for a hub that moves at `speed`.
    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], memory: &mut [f64]);

    /// Mass that a contact feels at first, `1 / (w^T M^-1 w)` of its row [kg]; infinite for a gear that is held.
    fn contact_mass(&self) -> f64;

    /// Shortest natural time of the gear's own coordinates, `1/omega` [s]; infinite without any.
    fn pace(&self) -> f64 {
        f64::INFINITY
    }

    /// Angle of a tooth from its assembled position [rad] (travel [m] for a rack), pitch not included.
    fn tooth_travel(&self, at: At<'_>, tooth: Tooth) -> f64;

    /// [`Self::tooth_travel`] of consecutive teeth from `first` on.
    fn tooth_travels(&self, at: At<'_>, first: Tooth, out: &mut [f64]) {
        for (index, travel) in (first.index..).zip(out) {
            *travel = self.tooth_travel(at, Tooth { index, ..first });
        }
    }

    /// True when all teeth always have the travel of the hub.
    fn moves_as_one(&self) -> bool {
        false
    }

    /// Its flanks as grids of nodes, for gears whose contact is searched point by point. Such a gear takes
    /// [`Locus::Quadrature`](crate::kinematics::Locus) points in [`Self::row`].
    fn flanks(&self) -> Option<&Flanks> {
        None
    }

    /// Displacements of its flank nodes along their normals, on top of the rigid motion that
    /// [`Self::node_positions`] then tells; `None` for gears whose node positions are the deformed ones.
    fn field(&self) -> Option<&dyn NormalField> {
        None
    }

    /// Deformed positions in space [m] of nodes of its [`Self::flanks`] (moved rigidly, for a gear with a
    /// [`Self::field`]). The search asks for a flank at a time, once per evaluation.
    fn node_positions(&self, _at: At<'_>, _nodes: &[u32], _out: &mut [Vec3]) {}

    /// Appends `d(x_p . n)/dq` to a row that is already targeted at this gear.
    fn row(&self, at: At<'_>, p: &Point, n: &Vec3, row: &mut Row);

    /// Prescribed part of `d(x_p . n)/dt` [m/s], for driven mounts.
    fn drift(&self, at: At<'_>, p: &Point, n: &Vec3) -> f64 {
        let hub = self.hub();
        if hub.coordinates() > 0 {
            return 0.0;
        }
        hub.lever(&p.x, n) * hub.speed(at.t, at.v)
    }

    /// False lets the scene skip [`Self::internal_force`].
    fn has_internal_force(&self) -> bool {
        true
    }

    /// Adds internal forces.
    fn internal_force(&mut self, _at: At<'_>, _f: &mut [f64]) {}

    /// Adds `(df/dq) dq + (df/dv) dv` of the internal forces.
    fn internal_tangent(&mut self, _at: At<'_>, _dq: &[f64], _dv: &[f64], _df: &mut [f64]) {}

    /// `f <- M^-1 f`.
    fn solve_mass(&mut self, at: At<'_>, f_to_a: &mut [f64]);

    /// `y = M x`.
    fn apply_mass(&mut self, at: At<'_>, x: &[f64], y: &mut [f64]);

    /// Writes the mass matrix where it is diagonal and constant; false where it is not.
    fn constant_mass(&self, _diagonal: &mut [f64]) -> bool {
        false
    }

    /// `x = (c.m M + c.d D + c.k K)^-1 rhs` without contact and loads, but with `hub_damping` [N m s/rad]
    /// from viscous loads on the mount's coordinate. The scene adds contacts as low-rank terms.
    fn correct(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular>;

    /// Factorisations that [`Self::correct`] needed so far, for gears that keep factors.
    fn factorisations(&self) -> Option<u64> {
        None
    }

    /// True for gears with many coordinates of which a contact touches few: the scene then condenses the
    /// Newton correction to those, with [`Self::condensed`] and [`Self::add_response`].
    fn prefers_condensed(&self) -> bool {
        false
    }

    /// Restriction of `A^-1` of [`Self::correct`] to some coordinates, `g[i * n + j] = A^-1[c_i, c_j]`,
    /// symmetric; `g` holds `n * n` values. The default solves once per coordinate.
    fn condensed(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        coordinates: &[u32],
        g: &mut [f64],
    ) -> Result<(), Singular> {
        let mut x = vec![0.0; at.q.len()];
        let n = coordinates.len();
        for (j, &unit) in coordinates.iter().enumerate() {
            x.fill(0.0);
            x[unit as usize] = 1.0;
            self.correct(at, c, hub_damping, &mut x)?;
            for (i, &coordinate) in coordinates.iter().enumerate() {
                g[i * n + j] = x[coordinate as usize];
            }
        }
        Ok(())
    }

    /// `x += A^-1 E f`: the response of all coordinates to forces on some. The default solves once.
    fn add_response(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        coordinates: &[u32],
        forces: &[f64],
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let mut y = vec![0.0; at.q.len()];
        for (&i, f) in coordinates.iter().zip(forces) {
            y[i as usize] += f;
        }
        self.correct(at, c, hub_damping, &mut y)?;
        for (x, y) in x.iter_mut().zip(&y) {
            *x += y;
        }
        Ok(())
    }

    /// Kinetic and strain energy [J].
    fn energy(&self, at: At<'_>) -> Energy;

    /// False for gears that neither lose power nor have any put in.
    fn has_powers(&self) -> bool {
        true
    }

    /// Power lost inside the gear [W].
    fn dissipated(&self, _at: At<'_>) -> f64 {
        0.0
    }

    /// Power that stiffness varying with position puts in [W].
    fn parametric(&self, _at: At<'_>) -> f64 {
        0.0
    }

    /// Power that a prescribed motion puts into the gear's own coordinates [W].
    fn driven_power(&self, _at: At<'_>) -> f64 {
        0.0
    }

    /// Speed of the hub, which viscous loads see: of the mount's coordinate where that is the hub's.
    fn hub_speed(&self, at: At<'_>) -> f64 {
        self.hub().speed(at.t, at.v)
    }

    /// Adds a load on a hub that is free to move [N m] or [N].
    fn add_hub_load(&self, load: f64, f: &mut [f64]) {
        if self.hub().coordinates() > 0 {
            f[0] += load;
        }
    }

    /// The oscillators that its coordinates are, with a constant diagonal mass; `None` for other gears.
    fn oscillators(&self) -> Option<Oscillators<'_>> {
        None
    }

    /// Adds what of [`Self::internal_force`] is not its [`Self::oscillators`]: the inertia of its own coordinates where
    /// the hub's motion is prescribed.
    fn add_inertia_force(&self, _t: f64, _f: &mut [f64]) {}

    /// A method lets the [`Self::oscillators`] give less than `1/omega^2` to forces that last, by `lag` per unit of
    /// acceleration [s^2]; gears with a residual compliance give the rest by it. `None`: nothing is left out.
    fn set_lag(&mut self, _lag: Option<&[f64]>) {}

    /// Its flight from a state under a steady `load` on a free hub; `None` where its motion is not known in closed form.
    fn flight(&self, _at: At<'_>, _load: f64) -> Option<Flight> {
        None
    }

    /// Adds that motion to a coast, its coordinates from `first` on; called where there is a [`Self::flight`].
    fn coast(&self, _at: At<'_>, _load: f64, _first: usize, _coast: &mut Coast) {}

    /// Share of the energy of the next impact below which its oscillators are put to rest in flight; 0: never.
    fn sleep(&self) -> f64 {
        0.0
    }

    /// Puts its oscillators to rest, about the deflection of a steady `load`; its momentum stays. The slices are its own.
    /// False when they rested, up to rounding.
    fn put_to_rest(
        &self,
        _t: f64,
        _load: f64,
        _q: &mut [f64],
        _v: &mut [f64],
        _memory: &mut [f64],
    ) -> bool {
        false
    }

    /// Work of a steady `load` on a free hub, or of a prescribed motion on the gear's own coordinates, between two states
    /// of a flight [J].
    fn steady_work(&self, from: At<'_>, to: At<'_>, load: f64) -> f64 {
        if self.hub().coordinates() == 0 || load == 0.0 {
            return 0.0;
        }
        load * (self.hub_state(to).travel - self.hub_state(from).travel)
    }

    /// Hub motion and momentum of the whole gear.
    fn hub_state(&self, at: At<'_>) -> HubState;

    /// What the mount exerts on the gear: by Newton's law the rate of its momentum less the `contact` forces. `forces`
    /// are those of contacts and loads on its coordinates. The default is that of a body that moves as its hub does.
    fn mount_reaction(&self, at: At<'_>, _forces: &[f64], contact: &Wrench) -> Wrench {
        self.hub().reaction(at.t, contact)
    }

    /// False lets the scene skip [`Self::engage`].
    fn uses_engagement(&self) -> bool {
        true
    }

    /// A contact of a tooth opened or closed: gears whose springs know the contact radius use it.
    fn engage(&mut self, _memory: &mut [f64], _tooth: Tooth, _side: Side, _closed: bool) -> Change {
        Change::None
    }

    /// After an accepted step: hand teeth over. The slices are the gear's own.
    fn commit(&mut self, _t: f64, _q: &mut [f64], _v: &mut [f64], _memory: &mut [f64]) -> Change {
        Change::None
    }
}
