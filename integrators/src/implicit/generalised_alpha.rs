//! The generalised-alpha family: Newmark-beta, HHT-alpha, generalised-alpha.
//!
//! The equations of motion hold at the end of every step, `M a_1 = f(t_1, q_1, v_1)`, and an auxiliary
//! acceleration `b` carries the weighting (Arnold, Bruels, *Multibody Syst. Dyn.* 18 (2007) 185):
//!
//! ```text
//! (1 - am) b1 + am b0 = (1 - af) a1 + af a0
//! q1 = q0 + h v0 + h^2 [(1/2 - beta) b0 + beta b1]
//! v1 = v0 + h [(1 - gamma) b0 + gamma b1]
//! ```
//!
//! | method | parameter | am | af | gamma | beta |
//! |---|---|---|---|---|---|
//! | Newmark | beta, gamma | 0 | 0 | gamma | beta |
//! | HHT | alpha in [0, 1/3] | 0 | alpha | 1/2 + alpha | (1 + alpha)^2 / 4 |
//! | generalised-alpha | rho = spectral radius at infinity | (2 rho - 1)/(rho + 1) | rho/(rho + 1) | 1/2 + af - am | (1 + af - am)^2 / 4 |
//!
//! All are of order two (Newmark with gamma = 1/2). Newton solves for `a1` with the system's analytic
//! tangent, `(M + gamma' h D + beta' h^2 K) da = f - M a1`, `beta' = beta (1 - af)/(1 - am)` and alike for
//! gamma. N. M. Newmark (1959); H. M. Hilber, T. J. R. Hughes, R. L. Taylor (1977); J. Chung,
//! G. M. Hulbert, *J. Appl. Mech.* 60 (1993) 371.

use crate::archive::{Archive, ArchiveError};
use crate::error::StepError;
use crate::interpolation::hermite_with_acceleration;
use crate::linear_stability::{Flip, Stability};
use crate::method::{MethodInfo, OneStep, Parameter, Stepping, Tolerance, Work};
use crate::system::{Coeffs, SecondOrderSystem, State, StateView};

/// Declared properties of Newmark-beta.
pub static NEWMARK: MethodInfo = MethodInfo {
    id: "newmark",
    name: "Newmark-beta",
    order: 2,
    implicit: true,
    stepping: Stepping::Fixed,
    tolerance_slope: 0.0,
    dissipative: false,
    linear_part: false,
    dense_matrices: false,
    parameters: &[Parameter {
        name: "beta",
        default: 0.25,
        range: (0.0, 0.5),
        meaning: "weight of the new acceleration in the displacement; 1/4 is unconditionally stable",
    }],
    citation: "Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67",
};

/// Declared properties of HHT-alpha.
pub static HHT: MethodInfo = MethodInfo {
    id: "hht-alpha",
    name: "HHT-alpha",
    order: 2,
    implicit: true,
    stepping: Stepping::Fixed,
    tolerance_slope: 0.0,
    dissipative: true,
    linear_part: false,
    dense_matrices: false,
    parameters: &[Parameter {
        name: "alpha",
        default: 0.05,
        range: (0.0, 1.0 / 3.0),
        meaning: "numerical damping; the spectral radius at infinity is (1 - alpha)/(1 + alpha)",
    }],
    citation: "Hilber, Hughes, Taylor, Earthquake Eng. Struct. Dyn. 5 (1977) 283",
};

/// Declared properties of generalised-alpha.
pub static GENERALISED_ALPHA: MethodInfo = MethodInfo {
    id: "generalised-alpha",
    name: "generalised-alpha",
    order: 2,
    implicit: true,
    stepping: Stepping::Fixed,
    tolerance_slope: 0.0,
    dissipative: true,
    linear_part: false,
    dense_matrices: false,
    parameters: &[Parameter {
        name: "rho_inf",
        default: 0.8,
        range: (0.0, 1.0),
        meaning: "spectral radius at infinite frequency",
    }],
    citation: "Chung, Hulbert, J. Appl. Mech. 60 (1993) 371; Arnold, Bruels (2007)",
};

/// Largest number of Newton iterations of a step.
const MAX_ITERATIONS: u32 = 60;
/// Largest number of force evaluations of a line search along a correction.
const SEARCHES: usize = 12;
/// Number of Newton iterations with the whole correction. Smooth forces and most contacts need fewer.
const PATIENCE: u32 = 6;
/// Size of the correction, relative to the scales of the system, at which Newton's method ends.
const NEWTON_TOLERANCE: f64 = 1e-11;

/// A method of the generalised-alpha family.
#[derive(Clone, Debug)]
pub struct GeneralisedAlpha {
    info: &'static MethodInfo,
    alpha_m: f64,
    alpha_f: f64,
    beta: f64,
    gamma: f64,
    /// True acceleration `a` and auxiliary acceleration `b` at both ends of the step.
    a0: Vec<f64>,
    a1: Vec<f64>,
    b0: Vec<f64>,
    b1: Vec<f64>,
    residual: Vec<f64>,
    /// Residual before the correction.
    raw: Vec<f64>,
}

impl GeneralisedAlpha {
    /// Builds the Newmark method with gamma = 1/2.
    pub fn newmark(beta: f64) -> Self {
        Self::of(&NEWMARK, 0.0, 0.0, beta, 0.5)
    }

    /// Builds the Hilber-Hughes-Taylor method; `alpha` lies in [0, 1/3].
    pub fn hht(alpha: f64) -> Self {
        Self::of(&HHT, 0.0, alpha, 0.25 * (1.0 + alpha).powi(2), 0.5 + alpha)
    }

    /// Builds the Chung-Hulbert method with spectral radius `rho` at infinite frequency.
    pub fn chung_hulbert(rho: f64) -> Self {
        let am = (2.0 * rho - 1.0) / (rho + 1.0);
        let af = rho / (rho + 1.0);
        Self::of(
            &GENERALISED_ALPHA,
            am,
            af,
            0.25 * (1.0 + af - am).powi(2),
            0.5 + af - am,
        )
    }

    /// Returns the stability limit on linear systems. At `z = -1` the recurrence gives, for `gamma = 1/2`, a velocity
    /// of zero and `4 M - (1 - 4 beta) h^2 K`, so that dampers have no influence. With the parameters of HHT-alpha and
    /// generalised-alpha `beta' >= gamma' / 2` holds, and every step is stable.
    #[must_use]
    pub fn stability(&self) -> Stability {
        let newmark = self.alpha_m == 0.0 && self.alpha_f == 0.0 && self.gamma == 0.5;
        if newmark && self.beta < 0.25 {
            Stability::Flip(Flip {
                d: 0.0,
                k: 1.0 - 4.0 * self.beta,
            })
        } else {
            Stability::Unconditional
        }
    }

    fn of(info: &'static MethodInfo, alpha_m: f64, alpha_f: f64, beta: f64, gamma: f64) -> Self {
        GeneralisedAlpha {
            info,
            alpha_m,
            alpha_f,
            beta,
            gamma,
            a0: Vec::new(),
            a1: Vec::new(),
            b0: Vec::new(),
            b1: Vec::new(),
            residual: Vec::new(),
            raw: Vec::new(),
        }
    }

    /// Computes coordinates and velocities at the end of the step from the acceleration there.
    fn displace(&mut self, from: &State, h: f64, to: &mut State) {
        let (am, af, beta, gamma) = (self.alpha_m, self.alpha_f, self.beta, self.gamma);
        let (wa, wb) = (1.0 / (1.0 - am), am / (1.0 - am));
        for i in 0..self.a1.len() {
            let b1 = ((1.0 - af) * self.a1[i] + af * self.a0[i]) * wa - wb * self.b0[i];
            self.b1[i] = b1;
            to.q[i] = from.q[i] + h * (from.v[i] + h * ((0.5 - beta) * self.b0[i] + beta * b1));
            to.v[i] = from.v[i] + h * ((1.0 - gamma) * self.b0[i] + gamma * b1);
        }
    }

    /// Computes the residual `f - M a1` at the end of the step; the content of `b1` is overwritten.
    fn residual(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        from: &State,
        to: &State,
        work: &mut Work,
    ) {
        let at = StateView {
            t: to.t,
            q: &to.q,
            v: &to.v,
            discrete: &from.discrete,
        };
        sys.force(at, &mut self.residual);
        work.force_evaluations += 1;
        sys.apply_mass(at, &self.a1, &mut self.b1);
        for (r, m) in self.residual.iter_mut().zip(&self.b1) {
            *r -= m;
        }
    }

    /// Returns the fraction of a correction to apply. Forces are piecewise linear where contacts open and where their
    /// dashpots end. Between two soft pieces a stiff one may lie, across which whole corrections alternate without
    /// end. A change of sign of the work of the residual on the correction shows this, and its zero is then searched
    /// (H. Matthies, G. Strang, *Int. J. Numer. Methods Eng.* 14 (1979) 1613).
    fn search_along(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        from: &State,
        h: f64,
        to: &mut State,
        work: &mut Work,
    ) -> f64 {
        let along: Vec<f64> = self.residual.clone();
        let work_of = |r: &[f64]| r.iter().zip(&along).map(|(r, d)| r * d).sum::<f64>();
        let start = work_of(&self.raw);
        if start <= 0.0 {
            return 1.0;
        }
        let mut at = |this: &mut Self, from_to: f64| {
            for (a, d) in this.a1.iter_mut().zip(&along) {
                *a += from_to * d;
            }
            this.displace(from, h, to);
            this.residual(sys, from, to, work);
            work_of(&this.residual)
        };
        let (mut low, mut high) = ((0.0, start), (1.0, at(self, 1.0)));
        let mut length = 1.0;
        if high.1 < -0.3 * start {
            for _ in 0..SEARCHES {
                let part = low.1 / (low.1 - high.1);
                let next = low.0 + part.clamp(0.1, 0.9) * (high.0 - low.0);
                let found = at(self, next - length);
                length = next;
                if found.abs() < 0.1 * start {
                    break;
                }
                if found > 0.0 {
                    low = (next, found);
                } else {
                    high = (next, found);
                }
            }
        }
        for (a, d) in self.a1.iter_mut().zip(&along) {
            *a -= length * d;
        }
        self.residual.copy_from_slice(&along);
        length
    }
}

impl OneStep for GeneralisedAlpha {
    fn info(&self) -> &'static MethodInfo {
        self.info
    }

    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        for x in [
            &mut self.a0,
            &mut self.a1,
            &mut self.b0,
            &mut self.b1,
            &mut self.residual,
            &mut self.raw,
        ] {
            archive.numbers(x)?;
        }
        Ok(())
    }

    fn restart(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, work: &mut Work) {
        let n = s.q.len();
        for x in [
            &mut self.a0,
            &mut self.a1,
            &mut self.b0,
            &mut self.b1,
            &mut self.residual,
            &mut self.raw,
        ] {
            x.resize(n, 0.0);
        }
        sys.force(s.at(), &mut self.a0);
        sys.solve_mass(s.at(), &mut self.a0);
        work.force_evaluations += 1;
        // b0 = a0 is off by O(h), which reaches q and v as O(h^2): order two survives restarts.
        self.b0.copy_from_slice(&self.a0);
    }

    fn step(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        from: &State,
        h: f64,
        tolerance: &Tolerance,
        to: &mut State,
        work: &mut Work,
    ) -> Result<f64, StepError> {
        let n = self.a0.len();
        let (am, af, beta, gamma) = (self.alpha_m, self.alpha_f, self.beta, self.gamma);
        let wa = 1.0 / (1.0 - am);
        let c = Coeffs {
            m: 1.0,
            d: h * gamma * (1.0 - af) * wa,
            k: h * h * beta * (1.0 - af) * wa,
        };
        to.t = from.t + h;
        self.a1.copy_from_slice(&self.a0);
        let mut size = f64::INFINITY;
        for iteration in 0..MAX_ITERATIONS {
            self.displace(from, h, to);
            if size <= NEWTON_TOLERANCE {
                return Ok(0.0);
            }
            self.residual(sys, from, to, work);
            let at = StateView {
                t: to.t,
                q: &to.q,
                v: &to.v,
                discrete: &from.discrete,
            };
            self.raw.copy_from_slice(&self.residual);
            work.correct(sys, at, c, &mut self.residual)
                .map_err(|_| StepError::SingularTangent { t: from.t, h })?;
            work.newton_iterations += 1;
            let previous = size;
            let length = if iteration < PATIENCE {
                1.0
            } else {
                self.search_along(sys, from, h, to, work)
            };
            size = 0.0;
            let mut rounding = 0.0_f64;
            for i in 0..n {
                let da = self.residual[i];
                self.a1[i] += length * da;
                // What one unit of rounding in the accelerations does to the coordinates: no correction
                // can be smaller, and with omega h >> 1 that is above the tolerance.
                let a = self.a1[i].abs() + self.b0[i].abs();
                rounding = rounding.max(h * h * a / tolerance.q[i] + h * a / tolerance.v[i]);
                let scaled = (c.k * da / tolerance.q[i]).abs() + (c.d * da / tolerance.v[i]).abs();
                if !scaled.is_finite() {
                    return Err(StepError::NonFinite { t: to.t, dof: i });
                }
                size = size.max(scaled);
            }
            // Rounding stalls the correction before it meets the tolerance on stiff systems.
            let stalled = size > 0.5 * previous && size < 1e3 * NEWTON_TOLERANCE;
            // Steadily decreasing corrections bound the next one, which then need not be computed.
            let rate = size / previous;
            let next_is_small = previous.is_finite()
                && length == 1.0
                && rate < 0.1
                && size * rate <= NEWTON_TOLERANCE;
            if stalled || next_is_small || size < 4.0 * f64::EPSILON * rounding {
                size = 0.0;
            }
            if iteration + 1 == MAX_ITERATIONS {
                return Err(StepError::NewtonDiverged {
                    t: from.t,
                    h,
                    residual: size,
                    iterations: MAX_ITERATIONS,
                });
            }
        }
        Ok(0.0)
    }

    fn advance(&mut self) {
        std::mem::swap(&mut self.a0, &mut self.a1);
        std::mem::swap(&mut self.b0, &mut self.b1);
    }

    fn interpolate(&self, from: &State, to: &State, theta: f64, q: &mut [f64], v: &mut [f64]) {
        hermite_with_acceleration(from, to, [&self.a0, &self.a1], theta, q, v);
    }
}
