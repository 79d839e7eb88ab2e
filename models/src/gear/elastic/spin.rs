//! Inertia terms of a rotating frame in the elastic gear; the formulas are in [`super::inertia`].
//!
//! With them the mass matrix of a free gear depends on `q`, in its row and column of the turn alone:
//!
//! ```text
//! [ J(q)  -(C q)^T ] [theta'']   [f_0]
//! [ -C q      1    ] [  q''  ] = [ f ],     theta'' = (f_0 + (C q).f) / (J(q) - |C q|^2)
//! ```

use super::body::Elastic;
use super::inertia::{AUTO_LIMIT, Integrals, SpinTerms};
use crate::cholesky::dot;
use crate::error::Reason;
use crate::spec::Mount;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{Singular, StateView};

impl Elastic {
    /// Sets the inertia terms of the rotating frame; the default is [`SpinTerms::Auto`].
    ///
    /// # Errors
    /// Terms asked for that the body does not have: a rack, or a reduction without inertia integrals.
    pub fn with_spin_terms(mut self, terms: SpinTerms) -> Result<Self, Reason> {
        if terms == SpinTerms::Full {
            if self.hub.slide.is_some() {
                return Err((
                    "a rack does not rotate and has no spin terms",
                    "remove them",
                )
                    .into());
            }
            if self.data.integrals.is_none() {
                return Err((
                    "the reduction contains no inertia integrals",
                    "reduce the gear again, with fewer modes if there were very many",
                )
                    .into());
            }
        }
        self.spin.terms = terms;
        self.spin.active = terms == SpinTerms::Full;
        Ok(self)
    }

    /// Decides [`SpinTerms::Auto`] by the initial speed of the hub [rad/s], for a driven hub by the largest prescribed
    /// speed.
    pub fn decide_spin_terms(&mut self, mut speed: f64) {
        if self.spin.terms != SpinTerms::Auto {
            return;
        }
        if let Mount::Driven(course) = &self.hub.mount {
            speed = speed.abs().max(course.greatest());
        }
        let lowest = self
            .data
            .omega
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        self.spin.active = self.hub.slide.is_none()
            && self.data.integrals.is_some()
            && speed.abs() > AUTO_LIMIT * lowest;
    }

    /// Returns the inertia integrals, if the spin terms are active.
    pub(super) fn spinning(&self) -> Option<&Integrals> {
        let moves = !matches!(self.hub.mount, Mount::Fixed);
        let integrals = self.data.integrals.as_ref();
        integrals.filter(|i| self.spin.active && moves && i.modes() > 0)
    }

    /// Adds centrifugal and Coriolis forces, and the terms of a prescribed acceleration.
    pub(super) fn add_spin_force(
        &self,
        i: &Integrals,
        at: StateView<'_>,
        acceleration: f64,
        f: &mut [f64],
    ) {
        let (q, v) = (&at.q[self.own..], &at.v[self.own..]);
        let speed = self.hub.speed(at.t, at.v);
        let mut room = self.spin.room.borrow_mut();
        let [outward, coriolis, turned] = room.each_mut().map(|x| sized(x, q.len()));
        i.outward(q, outward);
        i.coriolis(v, coriolis);
        if self.turns() {
            f[0] -= 2.0 * speed * dot(outward, v);
        } else if acceleration != 0.0 {
            i.coriolis(q, turned);
        }
        for (k, f) in f[self.own..].iter_mut().enumerate() {
            *f += speed * (speed * outward[k] + 2.0 * coriolis[k]);
            if !self.turns() && acceleration != 0.0 {
                *f += acceleration * turned[k];
            }
        }
    }

    /// Adds the change of the spin forces in a direction.
    pub(super) fn add_spin_tangent(
        &self,
        i: &Integrals,
        at: StateView<'_>,
        acceleration: f64,
        [dq, dv]: [&[f64]; 2],
        df: &mut [f64],
    ) {
        let own = self.own;
        let (q, v) = (&at.q[own..], &at.v[own..]);
        let speed = self.hub.speed(at.t, at.v);
        let change = if self.turns() { dv[0] } else { 0.0 };
        let mut room = self.spin.room.borrow_mut();
        let [a, b, c] = room.each_mut().map(|x| sized(x, q.len()));
        // The terms of the state, scaled by the change of the speed.
        i.outward(q, a);
        i.coriolis(v, b);
        i.softening(&dq[own..], c);
        if self.turns() {
            df[0] -= 2.0 * (change * dot(a, v) + speed * (dot(c, v) + dot(a, &dv[own..])));
        }
        for k in 0..q.len() {
            df[own + k] += 2.0 * change * (speed * a[k] + b[k]) + speed * speed * c[k];
        }
        i.coriolis(&dv[own..], a);
        for (df, a) in df[own..].iter_mut().zip(&*a) {
            *df += 2.0 * speed * a;
        }
        if !self.turns() && acceleration != 0.0 {
            i.coriolis(&dq[own..], a);
            for (df, a) in df[own..].iter_mut().zip(&*a) {
                *df += acceleration * a;
            }
        }
    }

    /// Returns `J(q)` and computes `C q` in `turned`.
    fn turning_mass(
        &self,
        i: &Integrals,
        q: &[f64],
        outward: &mut [f64],
        turned: &mut [f64],
    ) -> f64 {
        i.outward(q, outward);
        i.coriolis(q, turned);
        self.hub.inertia + dot(&i.radial, q) + dot(outward, q)
    }

    /// Returns the increase of `J(q)` and computes `C q` in `turned`.
    fn grown(&self, i: &Integrals, q: &[f64], outward: &mut [f64], turned: &mut [f64]) -> f64 {
        self.turning_mass(i, q, outward, turned) - self.hub.inertia
    }

    /// Solves with the mass matrix, `f <- M^-1 f`, for a gear that is free to rotate or to move out of the plane.
    pub(super) fn solve_mass(&self, at: StateView<'_>, f: &mut [f64]) -> Result<(), Singular> {
        let (mut hub, n) = self.hub_mass(at);
        let (on_hub, modes) = f.split_at_mut(n);
        let mut room = self.spin.room.borrow_mut();
        let [outward, turned, _] = room.each_mut().map(|x| sized(x, modes.len()));
        let couples = self.spinning().filter(|_| self.turns());
        if let Some(i) = couples {
            // Spin terms of the rigid body leave the inertia about its own axis as it is but for tilts.
            let tilted = hub[0] - self.hub.inertia;
            let inertia = self.turning_mass(i, &at.q[n..], outward, turned) + tilted;
            hub[0] = inertia - dot(turned, turned);
            on_hub[0] += dot(turned, modes);
        }
        solve_in_place(&mut hub[..n * n], on_hub)?;
        if couples.is_some() {
            for (f, t) in modes.iter_mut().zip(&*turned) {
                *f += on_hub[0] * t;
            }
        }
        Ok(())
    }

    /// Multiplies by the mass matrix, `y = M x`, for a gear that is free to rotate or to move out of the plane.
    pub(super) fn apply_mass(&self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        let (hub, n) = self.hub_mass(at);
        for (y, row) in y.iter_mut().zip(hub.chunks_exact(n.max(1))).take(n) {
            *y = dot(row, &x[..n]);
        }
        y[n..].copy_from_slice(&x[n..]);
        if let Some(i) = self.spinning().filter(|_| self.turns()) {
            let mut room = self.spin.room.borrow_mut();
            let [outward, turned, _] = room.each_mut().map(|v| sized(v, x.len() - n));
            let grown = self.grown(i, &at.q[n..], outward, turned);
            y[0] += grown * x[0] - dot(turned, &x[n..]);
            for (y, t) in y[n..].iter_mut().zip(&*turned) {
                *y -= t * x[0];
            }
        }
    }

    /// Computes the accelerations of all coordinates under `forces` of contact and loads.
    pub(super) fn spin_accelerations(
        &self,
        i: &Integrals,
        at: StateView<'_>,
        forces: &[f64],
        prescribed: f64,
    ) -> Vec<f64> {
        let mut f = forces.to_vec();
        for k in self.own..f.len() {
            let (w, z) = (self.omega[k], self.zeta[k]);
            f[k] -= w * (w * at.q[k] + 2.0 * z * at.v[k])
                + prescribed * self.data.participation[k - self.own];
        }
        self.add_spin_force(i, at, prescribed, &mut f);
        self.add_bearing(at, true, &mut f);
        if self.own > 0 && self.solve_mass(at, &mut f).is_err() {
            f.fill(f64::NAN);
        }
        f
    }

    /// Returns the rate of [`Self::spin_momentum`] for a gear with a fixed or driven hub, from the accelerations `a`
    /// of its modes.
    pub(super) fn spin_torque(
        &self,
        i: &Integrals,
        at: StateView<'_>,
        prescribed: f64,
        a: &[f64],
    ) -> f64 {
        let (q, v) = (&at.q[self.own..], &at.v[self.own..]);
        let mut room = self.spin.room.borrow_mut();
        let [outward, turned, _] = room.each_mut().map(|x| sized(x, q.len()));
        let grown = self.grown(i, q, outward, turned);
        let speed = self.hub.speed(at.t, at.v);
        prescribed * grown + 2.0 * speed * dot(outward, v) - dot(turned, &a[self.own..])
    }

    /// Returns the contribution of the deformation to the momentum about the axis, `theta' (2 a.q + q.G q) + q.C q'`.
    pub(super) fn spin_momentum(&self, i: &Integrals, at: StateView<'_>) -> f64 {
        let (q, v) = (&at.q[self.own..], &at.v[self.own..]);
        let mut room = self.spin.room.borrow_mut();
        let [outward, turned, _] = room.each_mut().map(|x| sized(x, q.len()));
        let grown = self.grown(i, q, outward, turned);
        self.hub.speed(at.t, at.v) * grown - dot(turned, v)
    }

    /// Returns the contribution of the deformation to the kinetic energy of a free gear.
    pub(super) fn spin_energy(&self, i: &Integrals, at: StateView<'_>) -> f64 {
        let (q, v) = (&at.q[self.own..], &at.v[self.own..]);
        let mut room = self.spin.room.borrow_mut();
        let [outward, turned, _] = room.each_mut().map(|x| sized(x, q.len()));
        let grown = self.grown(i, q, outward, turned);
        at.v[0] * (0.5 * at.v[0] * grown - dot(turned, v))
    }

    /// Returns the power of a prescribed motion on the modes beyond the coupling without rotation; Coriolis forces do
    /// no work.
    pub(super) fn spin_power(&self, i: &Integrals, at: StateView<'_>, acceleration: f64) -> f64 {
        let speed = self.hub.speed(at.t, at.v);
        let mut room = self.spin.room.borrow_mut();
        let (q, v) = (&at.q[self.own..], &at.v[self.own..]);
        let [outward, turned, _] = room.each_mut().map(|x| sized(x, q.len()));
        i.outward(q, outward);
        i.coriolis(q, turned);
        speed * speed * dot(outward, v) + acceleration * dot(turned, v)
    }
}

/// Resizes a buffer; it allocates at the first use only.
fn sized(x: &mut Vec<f64>, n: usize) -> &mut [f64] {
    x.resize(n, 0.0);
    x
}

#[cfg(test)]
mod tests;
