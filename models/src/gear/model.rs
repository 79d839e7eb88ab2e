//! The interface of gear models to contact and integrator.
//!
//! A gear has generalised coordinates (those of its mount first, then its own), a contact row, a mass and internal
//! forces. The data that all gears share are in [`HubBody`]; optional capabilities are small traits
//! ([`super::capabilities`]), which a gear returns. A gear may take part in several meshes; the gears of a mesh may
//! have different models.

use super::body::MeshedBody;
use super::capabilities::{
    CoupledMass, DeformedLines, FlankSurface, LargeGear, LinearMotion, ToothCoordinates,
};
use super::hub_body::{HubBody, HubState};
use crate::Vec3;
use crate::kinematics::{Motion, Point, Row, Wrench};
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{Coeffs, Energy, Power, Singular, StateView};

/// A gear model. `at` has the coordinates and the discrete state of this gear only. Every default is that of a rigid
/// body on its hub, or is valid for any gear.
pub trait GearModel {
    /// Returns the hub that carries the gear, and its data.
    fn hub(&self) -> &HubBody;

    /// Returns the hub for a change of its prescribed motion; the number of its coordinates has to be preserved.
    fn hub_mut(&mut self) -> &mut HubBody;

    /// Sets the initial state of the coordinates for a hub that moves at `speed`.
    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], _discrete: &mut [f64]) {
        q.fill(0.0);
        v.fill(0.0);
        if self.hub().is_free() {
            v[0] = speed;
        }
    }

    /// Appends `d(x_p . n)/dq` to a row of this gear; returns the part of `d(x_p . n)/dt` [m/s] from a driven mount.
    fn row(&self, at: StateView<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        self.hub().row(at, &p.x, n, row)
    }

    /// Adds internal forces; called where there are own coordinates or a bearing.
    fn forces(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.hub().add_lateral_forces(at, f);
    }

    /// Adds `(df/dq) dq + (df/dv) dv` of the internal forces; by default from central differences.
    fn tangent(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        if self.hub().is_internal() {
            add_difference(self, at, [dq, dv], df);
        }
    }

    /// Solves `x = (c.m M + c.d D + c.k K)^-1 rhs` without contact and loads, but with `hub_damping` [N m s/rad] from
    /// viscous loads on the coordinate of the mount. The scene adds contacts as low-rank terms. The default is a dense
    /// solve, for gears of few coordinates.
    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        correct_dense(self, at, c, hub_damping, rhs_to_x)
    }

    /// Returns kinetic and strain energy [J].
    fn energy(&self, at: StateView<'_>) -> Energy {
        let hub = self.hub();
        Energy {
            kinetic: hub.kinetic(at),
            strain: hub.bearing_energy(at)[0],
            ..Energy::default()
        }
    }

    /// Returns the powers [W]: losses inside the gear, power of a stiffness that varies with position, and power of a
    /// prescribed motion on the own coordinates.
    fn powers(&self, at: StateView<'_>) -> Power {
        let hub = self.hub();
        Power {
            dissipated: hub.bearing_energy(at)[1],
            external: hub.driven_power(at),
            ..Power::default()
        }
    }

    /// Returns hub motion and momentum of the whole gear.
    fn hub_state(&self, at: StateView<'_>) -> HubState {
        self.hub().state(at)
    }

    /// Returns position and velocity of the hub in its six directions.
    fn hub_motion(&self, at: StateView<'_>) -> Motion {
        self.hub().motion(at.t, at.q, at.v)
    }

    /// Returns the force and moment of the mount on the gear: by Newton's law the rate of its momentum less the
    /// `contact` forces. `forces` are those of contacts and loads on its coordinates. The default is that of a body
    /// that moves as its hub does.
    fn mount_reaction(&self, at: StateView<'_>, _forces: &[f64], contact: &Wrench) -> Wrench {
        self.hub().reaction_at(at, contact)
    }

    /// Returns the flanks as grids of nodes, for gears whose contact is searched point by point. Such a gear accepts
    /// [`Locus::Quadrature`](crate::kinematics::Locus) points in [`Self::row`].
    fn surface(&self) -> Option<FlankSurface<'_>> {
        None
    }

    /// Returns the flanks as lines, for gears in contact with half-spaces at the positions of their nodes.
    fn deformed_lines(&self) -> Option<&dyn DeformedLines> {
        None
    }

    /// Returns the finite-element body, for figures.
    fn body(&self) -> Option<&dyn MeshedBody> {
        None
    }

    /// Returns the closed-form motion between contacts, if there is one.
    fn linear(&self) -> Option<&dyn LinearMotion> {
        None
    }

    /// Returns the individual displacements of the teeth, if they differ from that of the hub.
    fn teeth(&self) -> Option<&dyn ToothCoordinates> {
        None
    }

    /// Returns the interface of a gear with many coordinates of which a contact acts on few.
    fn large(&self) -> Option<&dyn LargeGear> {
        None
    }

    /// Returns the mass matrix, if it is not constant and diagonal.
    fn coupled_mass(&self) -> Option<&dyn CoupledMass> {
        None
    }
}

/// Relative step of central differences: the cube root of the rounding unit.
const STEP: f64 = 6e-6;

fn add_difference<G: GearModel + ?Sized>(
    gear: &mut G,
    at: StateView<'_>,
    [dq, dv]: [&[f64]; 2],
    df: &mut [f64],
) {
    let norm = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let none = vec![0.0; df.len()];
    let (mut q, mut v) = (at.q.to_vec(), at.v.to_vec());
    let mut f = vec![0.0; df.len()];
    // Coordinates and velocities apart: they differ in size.
    for (dq, dv, size) in [(dq, &none[..], norm(at.q)), (&none[..], dv, norm(at.v))] {
        let unit = norm(dq).max(norm(dv));
        if unit == 0.0 {
            continue;
        }
        let h = STEP * size.max(1.0) / unit;
        for (sign, weight) in [(h, 0.5 / h), (-h, -0.5 / h)] {
            let moved = |x: &mut [f64], from: &[f64], by: &[f64]| {
                for ((x, from), by) in x.iter_mut().zip(from).zip(by) {
                    *x = from + sign * by;
                }
            };
            moved(&mut q, at.q, dq);
            moved(&mut v, at.v, dv);
            f.fill(0.0);
            gear.forces(StateView { q: &q, v: &v, ..at }, &mut f);
            for (df, f) in df.iter_mut().zip(&f) {
                *df += weight * f;
            }
        }
    }
}

fn correct_dense<G: GearModel + ?Sized>(
    gear: &mut G,
    at: StateView<'_>,
    c: Coeffs,
    hub_damping: f64,
    x: &mut [f64],
) -> Result<(), Singular> {
    let n = x.len();
    let mut matrix = vec![0.0; n * n];
    let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
    for j in 0..n {
        unit.fill(0.0);
        let scaled = |by: f64, unit: &mut Vec<f64>| unit[j] = by;
        scaled(1.0, &mut unit);
        column.fill(0.0);
        match gear.coupled_mass() {
            Some(mass) => mass.apply(at, &unit, &mut column),
            None => {
                gear.hub().diagonal_mass(&mut column);
                let own = column[j];
                column.fill(0.0);
                column[j] = own;
            }
        }
        for i in 0..n {
            matrix[i * n + j] = c.m * column[i];
        }
        // Forces fall with stiffness and damping: A = c.m M - c.k df/dq - c.d df/dv.
        let (mut dq, mut dv) = (unit.clone(), unit.clone());
        dq[j] = c.k;
        dv[j] = c.d;
        column.fill(0.0);
        gear.tangent(at, &dq, &dv, &mut column);
        for i in 0..n {
            matrix[i * n + j] -= column[i];
        }
    }
    if gear.hub().is_free() {
        matrix[0] += c.d * hub_damping;
    }
    solve_in_place(&mut matrix, x)
}
