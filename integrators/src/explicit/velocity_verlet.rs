//! Velocity Verlet (central difference): kick-drift-kick with one force per step.
//!
//! `q1 = q0 + h v0 + h^2 a0 / 2`, `v1 = v0 + h (a0 + a1) / 2`. Forces that depend on velocity are evaluated
//! at the predicted `v0 + h a0`, or, where the system can, implicitly at `v1`
//! ([`force_after`](SecondOrderSystem::force_after)); both keep order two. Symplectic for separable systems, stable for
//! `omega h < 2`. L. Verlet, *Phys. Rev.* 159 (1967) 98; W. C. Swope et al., *J. Chem. Phys.* 76 (1982) 637.

use crate::archive::{Archive, ArchiveError};
use crate::error::StepError;
use crate::interpolation::hermite_with_acceleration;
use crate::method::{MethodInfo, OneStep, Stepping, Tolerance, Work};
use crate::system::{HalfStepImpulse, SecondOrderSystem, State, StateView};

/// Declared properties of velocity Verlet.
pub static INFO: MethodInfo = MethodInfo {
    id: "velocity-verlet",
    name: "velocity Verlet",
    order: 2,
    implicit: false,
    stepping: Stepping::Fixed,
    tolerance_slope: 0.0,
    dissipative: false,
    linear_part: false,
    dense_matrices: false,
    parameters: &[],
    citation: "Verlet, Phys. Rev. 159 (1967) 98; Swope et al., J. Chem. Phys. 76 (1982) 637",
};

/// The velocity Verlet method with the accelerations at both ends of a step.
#[derive(Clone, Debug, Default)]
pub struct VelocityVerlet {
    a0: Vec<f64>,
    a1: Vec<f64>,
    v: Vec<f64>,
    before: Vec<f64>,
}

impl OneStep for VelocityVerlet {
    fn info(&self) -> &'static MethodInfo {
        &INFO
    }

    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        for x in [&mut self.a0, &mut self.a1, &mut self.v, &mut self.before] {
            archive.numbers(x)?;
        }
        Ok(())
    }

    fn restart(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, work: &mut Work) {
        let n = s.q.len();
        self.a0.resize(n, 0.0);
        self.a1.resize(n, 0.0);
        self.v.resize(n, 0.0);
        self.before.resize(n, 0.0);
        sys.force(s.at(), &mut self.a0);
        sys.solve_mass(s.at(), &mut self.a0);
        work.force_evaluations += 1;
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
        let n = self.a0.len();
        let half = 0.5 * h;
        let (q0, v0, a0) = (&from.q[..n], &from.v[..n], &self.a0[..n]);
        let (q, v, before) = (&mut to.q[..n], &mut self.v[..n], &mut self.before[..n]);
        for i in 0..n {
            q[i] = q0[i] + h * (v0[i] + half * a0[i]);
            v[i] = v0[i] + h * a0[i];
            before[i] = v0[i] + half * a0[i];
        }
        to.t = from.t + h;
        let at = StateView {
            t: to.t,
            q: &to.q,
            v: &self.v,
            discrete: &from.discrete,
        };
        let kick = HalfStepImpulse {
            time: half,
            before: &self.before,
            steady: &[],
            filter: &[],
        };
        sys.force_after(at, &kick, &mut self.a1);
        sys.solve_mass(at, &mut self.a1);
        work.force_evaluations += 1;
        let (v1, a1) = (&mut to.v[..n], &self.a1[..n]);
        for i in 0..n {
            v1[i] = v0[i] + half * (a0[i] + a1[i]);
        }
        Ok(0.0)
    }

    fn advance(&mut self) {
        std::mem::swap(&mut self.a0, &mut self.a1);
    }

    fn interpolate(&self, from: &State, to: &State, theta: f64, q: &mut [f64], v: &mut [f64]) {
        hermite_with_acceleration(from, to, [&self.a0, &self.a1], theta, q, v);
    }
}
