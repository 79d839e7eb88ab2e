//! What only a gear of many coupled coordinates can do: solves with its mass matrix, and the condensed correction of a
//! few of its coordinates.

use super::FullOrder;
use super::frame::unit_motion;
use super::gear::Nodal;
use super::kinematics::dot3;
use crate::assembly::tie::Tie;
use gearbench_integrators::system::{At, Coeffs, Singular};
use gearbench_models::gear::{CoupledMass, LargeGear};

impl CoupledMass for FullOrder {
    fn solve(&self, at: At<'_>, f_to_a: &mut [f64]) {
        let frame = self.frame(at);
        let mass_only = Coeffs {
            m: 1.0,
            d: 0.0,
            k: 0.0,
        };
        // The mass matrix is positive definite: its factorisation does not fail.
        let solved = (self.correction.borrow_mut()).solve(frame, mass_only, 0.0, f_to_a);
        if solved.is_err() {
            f_to_a.fill(f64::NAN);
        }
    }

    fn apply(&self, at: At<'_>, x: &[f64], y: &mut [f64]) {
        let frame = self.frame(at);
        let speed = if self.own > 0 { x[0] } else { 0.0 };
        let mut nodal = self.scratch.borrow_mut();
        let Nodal { u, g, .. } = &mut *nodal;
        self.velocities(frame, speed, x, u);
        self.body.apply_nodal_mass(u, g);
        for (k, &node) in self.body.free.iter().enumerate() {
            y[self.own + 3 * k..][..3].copy_from_slice(&g[3 * node as usize..][..3]);
        }
        if self.own > 0 {
            let mut sum = self.body.added_inertia * speed;
            for (node, &place) in self.body.place.iter().enumerate() {
                if place == Tie::HELD {
                    let unit = unit_motion(&self.body.position[node].into(), self.slide());
                    sum += dot3(frame.to_space(unit), &g[3 * node..3 * node + 3]);
                }
            }
            y[0] = sum;
        }
    }
}

impl LargeGear for FullOrder {
    fn condensed(
        &self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        coordinates: &[u32],
        g: &mut [f64],
    ) -> Result<(), Singular> {
        let frame = self.frame(at);
        self.correction
            .borrow_mut()
            .flexibility(frame, c, hub_damping, coordinates, g)
    }

    fn add_response(
        &self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        (coordinates, forces): (&[u32], &[f64]),
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let frame = self.frame(at);
        self.correction
            .borrow_mut()
            .add_response(frame, c, hub_damping, coordinates, forces, x)
    }

    fn factorisations(&self) -> u64 {
        self.correction.borrow().factorisations()
    }
}
