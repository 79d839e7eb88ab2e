//! A gear with movable teeth as a gear model.

use super::teeth::{MovableTeeth, Spring};
use crate::Vec3;
use crate::gear::capabilities::{LinearMotion, ToothCoordinates};
use crate::gear::hub_body::{HubBody, HubState};
use crate::gear::model::GearModel;
use crate::kinematics::{Point, Row, Wrench};
use gearbench_integrators::system::{Coeffs, Energy, Power, Singular, StateView};

/// Returns the derivative of a tooth's torque by the angle of the tooth: stiffness, and its dependence on the contact
/// radius.
fn own_spring(c: Coeffs, p: Spring, stretch: f64) -> f64 {
    c.d * p.c + c.k * (p.k + 2.0 * p.dk * stretch + p.bend * stretch * stretch)
}

impl GearModel for MovableTeeth {
    fn hub(&self) -> &HubBody {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut HubBody {
        &mut self.hub
    }

    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], discrete: &mut [f64]) {
        q.fill(0.0);
        v.fill(0.0);
        if self.hub.is_free() {
            v[0] = speed;
        }
        v[self.first()..].fill(speed);
        discrete.fill(0.0);
        for m in 0..self.views.len() {
            discrete[m] = self.nearest(m, 0.0).round();
        }
    }

    #[inline]
    fn row(&self, at: StateView<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        // A tooth outside its window carries no force, so the mean stands for it.
        let i = self.own_or_mean(at.discrete, p.tooth);
        let hub = &self.hub.hub;
        let hub_pose = hub.hub_pose(at.t, at.q);
        row.push(i, hub.effective_radius_on(hub_pose.as_ref(), &p.x, n));
        // A tooth has a coordinate whatever its hub does: nothing of its turn is prescribed.
        hub_pose.map_or(0.0, |s| hub.lateral_row_on(at.t, &s, (&p.x, n), row, false))
    }

    fn forces(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.hub.add_lateral_forces(at, f);
        let first = self.first();
        let (phi, speed) = (
            self.hub.displacement(at.t, at.q),
            self.hub.speed(at.t, at.v),
        );
        let mut on_body = 0.0;
        if !self.constant.is_empty() {
            let own = f[first..]
                .iter_mut()
                .zip(&at.q[first..])
                .zip(&at.v[first..]);
            for (((f, s), v), p) in own.zip(&self.constant) {
                let torque = p.k * (s - phi) + p.c * (v - speed);
                *f -= torque;
                on_body += torque;
            }
            if self.hub.is_free() {
                f[0] += on_body;
            }
            return;
        }
        for (i, s, v, p) in self.each_spring(at) {
            let (stretch, damped) = (s - phi, p.c * (v - speed));
            // The force is the derivative of the energy, which also changes with the stiffness along the path.
            f[first + i] -= p.k * stretch + 0.5 * p.dk * stretch * stretch + damped;
            on_body += p.k * stretch + damped;
        }
        if self.hub.is_free() {
            f[0] += on_body;
        }
    }

    fn tangent(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        let first = self.first();
        let phi = self.hub.displacement(at.t, at.q);
        self.hub.add_lateral_tangent(at, [dq, dv], df);
        let (dphi, dspeed) = if self.hub.is_free() {
            (dq[0], dv[0])
        } else {
            (0.0, 0.0)
        };
        let mut on_body = 0.0;
        for (i, s, _, p) in self.each_spring(at) {
            let (ds, du) = (dq[first + i], dv[first + i]);
            let (turn, damped) = (p.dk * (s - phi), p.c * (du - dspeed));
            let torque = p.k * (ds - dphi) + turn * ds + damped;
            df[first + i] -= torque + turn * (ds - dphi) + p.bend * ds * (s - phi).powi(2);
            on_body += torque;
        }
        if self.hub.is_free() {
            df[0] += on_body;
        }
    }

    /// Solves with an arrow matrix, which is symmetric: the teeth are coupled through the hub only.
    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let first = self.first();
        let phi = self.hub.displacement(at.t, at.q);
        let (mut hub, mut rhs) = (c.m * self.body + c.d * hub_damping, 0.0);
        for (i, s, _, p) in self.each_spring(at) {
            let spring = c.d * p.c + c.k * p.k;
            let turning = spring + c.k * p.dk * (s - phi);
            let diagonal = c.m * p.inertia + own_spring(c, p, s - phi);
            if diagonal == 0.0 {
                return Err(Singular);
            }
            hub += spring - turning * turning / diagonal;
            rhs += turning * x[first + i] / diagonal;
        }
        let free = self.hub.is_free();
        if free {
            if hub == 0.0 {
                return Err(Singular);
            }
            x[0] = (x[0] + rhs) / hub;
        }
        let dphi = if free { x[0] } else { 0.0 };
        self.hub
            .correct_lateral(at, c, &mut x[usize::from(free)..first])?;
        for (i, s, _, p) in self.each_spring(at) {
            let spring = c.d * p.c + c.k * p.k;
            let turning = spring + c.k * p.dk * (s - phi);
            let diagonal = c.m * p.inertia + own_spring(c, p, s - phi);
            x[first + i] = (x[first + i] + turning * dphi) / diagonal;
        }
        Ok(())
    }

    fn energy(&self, at: StateView<'_>) -> Energy {
        let first = self.first();
        let phi = self.hub.displacement(at.t, at.q);
        let mut e = Energy {
            strain: self.hub.bearing_energy(at)[0],
            ..Energy::default()
        };
        // The body's, and of the whole gear sideways.
        for (m, v) in self.hub.masses.iter().zip(&at.v[..first]) {
            e.kinetic += 0.5 * m * v * v;
        }
        for (_, s, v, p) in self.each_spring(at) {
            e.kinetic += 0.5 * p.inertia * v * v;
            e.strain += 0.5 * p.k * (s - phi).powi(2);
        }
        if self.slots > 0 {
            // The cross terms with the mean vanish because the deviations sum to zero.
            let (dd, vv) =
                self.deviations()
                    .squares(&self.springs, at.t, &at.discrete[self.head()..]);
            let (k, m, r2) = (
                self.springs.stiffness[0],
                self.springs.mass[0],
                self.springs.radius_squared,
            );
            e.strain += 0.5 * k * r2 * dd;
            e.kinetic += 0.5 * m * r2 * vv;
        }
        e
    }

    fn powers(&self, at: StateView<'_>) -> Power {
        Power {
            dissipated: self.dissipated(at) + self.hub.bearing_energy(at)[1],
            external: self.driven_power(at) + self.hub.driven_power(at),
            ..Power::default()
        }
    }

    fn hub_state(&self, at: StateView<'_>) -> HubState {
        let first = self.first();
        let speed = self.hub.speed(at.t, at.v);
        let teeth: f64 = (0..at.q.len() - first)
            .map(|i| self.tooth_inertia(i) * at.v[first + i])
            .sum();
        HubState {
            displacement: self.hub.displacement(at.t, at.q),
            speed,
            momentum: self.body * speed + teeth,
        }
    }

    fn mount_reaction(&self, at: StateView<'_>, forces: &[f64], contact: &Wrench) -> Wrench {
        self.reaction(at, forces, contact)
    }

    fn linear(&self) -> Option<&dyn LinearMotion> {
        Some(self)
    }

    fn teeth(&self) -> Option<&dyn ToothCoordinates> {
        Some(self)
    }
}

impl MovableTeeth {
    fn dissipated(&self, at: StateView<'_>) -> f64 {
        let speed = self.hub.speed(at.t, at.v);
        let mut power = 0.0;
        for (_, _, v, p) in self.each_spring(at) {
            power += p.c * (v - speed).powi(2);
        }
        if self.slots > 0 && self.springs.damping[0] > 0.0 {
            let (_, vv) =
                self.deviations()
                    .squares(&self.springs, at.t, &at.discrete[self.head()..]);
            power += self.springs.damping[0] * self.springs.radius_squared * vv;
        }
        power
    }

    fn driven_power(&self, at: StateView<'_>) -> f64 {
        if self.hub.is_free() {
            return 0.0;
        }
        let (phi, speed) = (
            self.hub.displacement(at.t, at.q),
            self.hub.speed(at.t, at.v),
        );
        -self
            .each_spring(at)
            .map(|(_, s, v, p)| (p.k * (s - phi) + p.c * (v - speed)) * speed)
            .sum::<f64>()
    }
}
