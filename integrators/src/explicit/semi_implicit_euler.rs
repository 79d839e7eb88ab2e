//! Semi-implicit (symplectic) Euler: `v1 = v0 + h a(t0, q0, v0)`, `q1 = q0 + h v1`.
//!
//! First order, symplectic for separable systems, one force per step. E. Hairer, C. Lubich, G. Wanner,
//! *Geometric Numerical Integration*, I.1.2.

use crate::archive::{Archive, ArchiveError};
use crate::error::StepError;
use crate::method::{MethodInfo, OneStep, Stepping, Tolerance, Work};
use crate::system::{SecondOrderSystem, State};

/// Declared properties of semi-implicit Euler.
pub static INFO: MethodInfo = MethodInfo {
    id: "semi-implicit-euler",
    name: "semi-implicit Euler",
    order: 1,
    implicit: false,
    stepping: Stepping::Fixed,
    tolerance_slope: 0.0,
    dissipative: false,
    linear_part: false,
    dense_matrices: false,
    parameters: &[],
    citation: "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), I.1.2",
};

/// The semi-implicit Euler method with its acceleration buffer.
#[derive(Clone, Debug, Default)]
pub struct SemiImplicitEuler {
    a: Vec<f64>,
}

impl OneStep for SemiImplicitEuler {
    fn info(&self) -> &'static MethodInfo {
        &INFO
    }

    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        // The length of the buffer.
        archive.numbers(&mut self.a)
    }

    fn restart(&mut self, _sys: &mut dyn SecondOrderSystem, s: &State, _work: &mut Work) {
        self.a.resize(s.q.len(), 0.0);
    }

    fn step(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        from: &State,
        h: f64,
        _tolerance: &Tolerance,
        to: &mut State,
        work: &mut Work,
    ) -> Result<f64, StepError> {
        sys.force(from.at(), &mut self.a);
        sys.solve_mass(from.at(), &mut self.a);
        work.force_evaluations += 1;
        for i in 0..self.a.len() {
            to.v[i] = from.v[i] + h * self.a[i];
            to.q[i] = from.q[i] + h * to.v[i];
        }
        to.t = from.t + h;
        Ok(0.0)
    }

    fn advance(&mut self) {}

    // The velocity lags half a step, so a Hermite interpolant would oscillate; the method is linear inside.
    fn interpolate(&self, from: &State, to: &State, theta: f64, q: &mut [f64], v: &mut [f64]) {
        for i in 0..q.len() {
            q[i] = from.q[i] + theta * (to.q[i] - from.q[i]);
            v[i] = from.v[i] + theta * (to.v[i] - from.v[i]);
        }
    }
}
