//! The rigid gear: the mount's coordinate only; all compliance sits in the contact law.
//!
//! `J phi'' = T + sum_c N_c d(x_c . n_c)/dphi`, on the line of action the lever arm is the base radius.

use super::free_flight::Flight;
use super::model::{Coordinates, GearModel, HubState, Magnitudes, Oscillators};
use crate::Vec3;
use crate::kinematics::{Hub, Point, Row, Tooth};
use gearbench_integrators::Coast;
use gearbench_integrators::system::{At, Coeffs, Energy, Singular};

/// A rigid gear or rack.
#[derive(Clone, Debug)]
pub struct Rigid {
    hub: Hub,
    /// Converts a deflection on the line of action to the hub's coordinate.
    lever: f64,
}

impl Rigid {
    /// A rigid body on its hub; `lever` is the base radius [m], or `cos(alpha)` for a rack.
    pub fn new(hub: Hub, lever: f64) -> Self {
        Rigid { hub, lever }
    }
}

impl GearModel for Rigid {
    fn id(&self) -> &'static str {
        "rigid"
    }

    fn hub(&self) -> &Hub {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut Hub {
        &mut self.hub
    }

    fn coordinates(&self) -> Coordinates {
        Coordinates {
            n: self.hub.coordinates(),
            memory: 0,
        }
    }

    fn scales(&self, m: Magnitudes, q: &mut [f64], v: &mut [f64]) {
        q.fill(m.deflection / self.lever);
        v.fill(m.speed / self.lever);
    }

    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], _memory: &mut [f64]) {
        q.fill(0.0);
        v.fill(speed);
    }

    fn contact_mass(&self) -> f64 {
        if self.hub.coordinates() > 0 {
            self.hub.inertia / self.lever.powi(2)
        } else {
            f64::INFINITY
        }
    }

    #[inline]
    fn tooth_travel(&self, at: At<'_>, _tooth: Tooth) -> f64 {
        self.hub.travel(at.t, at.q)
    }

    #[inline]
    fn tooth_travels(&self, at: At<'_>, _first: Tooth, out: &mut [f64]) {
        out.fill(self.hub.travel(at.t, at.q));
    }

    fn moves_as_one(&self) -> bool {
        true
    }

    fn has_internal_force(&self) -> bool {
        false
    }

    fn uses_engagement(&self) -> bool {
        false
    }

    #[inline]
    fn row(&self, _at: At<'_>, p: &Point, n: &Vec3, row: &mut Row) {
        if self.hub.coordinates() > 0 {
            row.push(0, self.hub.lever(&p.x, n));
        }
    }

    #[inline]
    fn solve_mass(&mut self, _at: At<'_>, f_to_a: &mut [f64]) {
        for f in f_to_a {
            *f /= self.hub.inertia;
        }
    }

    #[inline]
    fn apply_mass(&mut self, _at: At<'_>, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y = self.hub.inertia * x;
        }
    }

    fn constant_mass(&self, diagonal: &mut [f64]) -> bool {
        diagonal.fill(self.hub.inertia);
        true
    }

    fn correct(
        &mut self,
        _at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        let a = c.m * self.hub.inertia + c.d * hub_damping;
        for x in rhs_to_x {
            if a == 0.0 {
                return Err(Singular);
            }
            *x /= a;
        }
        Ok(())
    }

    fn condensed(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        _coordinates: &[u32],
        g: &mut [f64],
    ) -> Result<(), Singular> {
        g.fill(1.0);
        self.correct(at, c, hub_damping, g)
    }

    fn add_response(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        _coordinates: &[u32],
        forces: &[f64],
        x: &mut [f64],
    ) -> Result<(), Singular> {
        for (x, f) in x.iter_mut().zip(forces) {
            let mut y = [*f];
            self.correct(at, c, hub_damping, &mut y)?;
            *x += y[0];
        }
        Ok(())
    }

    fn energy(&self, at: At<'_>) -> Energy {
        let speed = self.hub.speed(at.t, at.v);
        let kinetic = if self.hub.coordinates() > 0 {
            0.5 * self.hub.inertia * speed * speed
        } else {
            0.0
        };
        Energy {
            kinetic,
            ..Energy::default()
        }
    }

    fn oscillators(&self) -> Option<Oscillators<'_>> {
        const NONE: &[f64] = &[0.0];
        let own = &NONE[..self.hub.coordinates()];
        Some(Oscillators {
            omega: own,
            zeta: own,
        })
    }

    fn flight(&self, at: At<'_>, load: f64) -> Option<Flight> {
        let hub = &self.hub;
        Some(Flight {
            frame: [
                hub.travel(at.t, at.q),
                hub.speed(at.t, at.v),
                hub.acceleration(at.t, load),
            ],
            ..Flight::default()
        })
    }

    fn coast(&self, at: At<'_>, load: f64, first: usize, coast: &mut Coast) {
        if self.hub.coordinates() > 0 {
            let acceleration = self.hub.acceleration(at.t, load);
            coast.swing(0.0, 0.0, [at.q[0], at.v[0]], acceleration);
            coast.moves(first, 1.0);
        }
    }

    fn hub_state(&self, at: At<'_>) -> HubState {
        let speed = self.hub.speed(at.t, at.v);
        HubState {
            travel: self.hub.travel(at.t, at.q),
            speed,
            momentum: self.hub.inertia * speed,
        }
    }
}
