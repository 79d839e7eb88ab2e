//! Capabilities of a gear with many coupled coordinates: solves with its mass matrix, and the condensed correction of
//! a few of its coordinates.

use super::FullOrder;
use super::correction::Weights;
use super::frame::unit_motion;
use super::gear::Nodal;
use super::kinematics::dot3;
use crate::assembly::tie::Tie;
use gearbench_integrators::system::{Coeffs, Singular, StateView};
use gearbench_models::gear::{CoupledMass, LargeGear};

impl FullOrder {
    /// Returns the weights of the Newton matrix of the body, whose damping goes with its stiffness.
    fn weights(&self, c: Coeffs, hub_damping: f64) -> Weights {
        Weights {
            body: Coeffs {
                k: c.k + self.hub.retardation * c.d,
                ..c
            },
            hub: c,
            hub_damping,
        }
    }

    /// `x <- A^-1 x`.
    pub(super) fn solve(
        &self,
        at: StateView<'_>,
        (c, hub_damping): (Coeffs, f64),
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let (mut nodes, mut border) = (self.correction.borrow_mut(), self.border.borrow_mut());
        let weights = self.weights(c, hub_damping);
        match (&mut *border, self.held()) {
            (Some(border), Some(held)) => {
                border.solve(&mut nodes, (&self.hub, held), at, weights, x)
            }
            _ => nodes.solve(self.frame(at), weights, x),
        }
    }
}

impl CoupledMass for FullOrder {
    fn solve(&self, at: StateView<'_>, f_to_a: &mut [f64]) {
        let mass_only = Coeffs {
            m: 1.0,
            d: 0.0,
            k: 0.0,
        };
        // The mass matrix is positive definite: its factorisation does not fail.
        if FullOrder::solve(self, at, (mass_only, 0.0), f_to_a).is_err() {
            f_to_a.fill(f64::NAN);
        }
    }

    fn apply(&self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        if let Some(held) = self.held() {
            return self.floating_mass(held, at, x, y);
        }
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
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        coordinates: &[u32],
        g: &mut [f64],
    ) -> Result<(), Singular> {
        let (mut nodes, mut border) = (self.correction.borrow_mut(), self.border.borrow_mut());
        let weights = self.weights(c, hub_damping);
        if let (Some(border), Some(held)) = (&mut *border, self.held()) {
            let hub = (&self.hub, held);
            return border.flexibility(&mut nodes, hub, at, weights, (coordinates, g));
        }
        nodes.flexibility(self.frame(at), weights, coordinates, g)
    }

    fn add_response(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        (coordinates, forces): (&[u32], &[f64]),
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let (mut nodes, mut border) = (self.correction.borrow_mut(), self.border.borrow_mut());
        let weights = self.weights(c, hub_damping);
        if let (Some(border), Some(held)) = (&mut *border, self.held()) {
            let hub = (&self.hub, held);
            return border.add_response(&mut nodes, hub, at, weights, (coordinates, forces), x);
        }
        nodes.add_response(self.frame(at), weights, coordinates, forces, x)
    }

    fn factorisations(&self) -> u64 {
        self.correction.borrow().factorisations()
    }
}
