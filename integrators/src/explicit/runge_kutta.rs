//! Explicit Runge-Kutta methods on `(q, v)`: the classical RK4 and Dormand-Prince 5(4).
//!
//! Stages of `y' = F(t, y)`, `y = (q, v)`, `F = (v, a)`: `Y_i = y0 + h sum_j a_ij F_j`. Dormand-Prince
//! carries an embedded fourth-order solution for the step control, reuses its last stage, and has a
//! fourth-order interpolant. W. Kutta (1901); J. R. Dormand, P. J. Prince, *J. Comp. Appl. Math.* 6 (1980)
//! 19; interpolant from L. F. Shampine, *Math. Comp.* 46 (1986) 135.

use crate::archive::{Archive, ArchiveError};
use crate::error::StepError;
use crate::interpolation::hermite_with_acceleration;
use crate::linear_stability::Stability;
use crate::method::{MethodInfo, OneStep, Stepping, Tolerance, Work};
use crate::system::{SecondOrderSystem, State, StateView};

/// Declared properties of the classical Runge-Kutta method.
pub static RK4: MethodInfo = MethodInfo {
    id: "rk4",
    name: "Runge-Kutta 4",
    order: 4,
    implicit: false,
    stepping: Stepping::Fixed,
    tolerance_slope: 0.0,
    dissipative: true,
    linear_part: false,
    dense_matrices: false,
    parameters: &[],
    citation: "Kutta, Z. Math. Phys. 46 (1901) 435",
};

/// Declared properties of the Dormand-Prince method.
pub static DOPRI5: MethodInfo = MethodInfo {
    id: "dopri5",
    name: "Dormand-Prince 5(4)",
    order: 5,
    implicit: false,
    stepping: Stepping::Both,
    tolerance_slope: 1.0,
    dissipative: true,
    linear_part: false,
    dense_matrices: false,
    parameters: &[],
    citation: "Dormand, Prince, J. Comp. Appl. Math. 6 (1980) 19",
};

/// Coefficients of a method: strictly lower triangle row by row, weights, nodes.
struct Tableau {
    stages: usize,
    a: &'static [&'static [f64]],
    b: &'static [f64],
    c: &'static [f64],
    /// Weights of the error estimate (solution minus embedded solution); empty without an estimate.
    e: &'static [f64],
    /// True if the last stage is the first stage of the next step.
    first_same_as_last: bool,
}

static RK4_TABLEAU: Tableau = Tableau {
    stages: 4,
    a: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    b: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    c: &[0.0, 0.5, 0.5, 1.0],
    e: &[],
    first_same_as_last: false,
};

static DOPRI5_TABLEAU: Tableau = Tableau {
    stages: 7,
    a: &[
        &[],
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
        &[
            35.0 / 384.0,
            0.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
        ],
    ],
    b: &[
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
        0.0,
    ],
    c: &[0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0],
    e: &[
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
    first_same_as_last: true,
};

/// Weights of the fifth interpolation term of Shampine.
const DOPRI5_DENSE: [f64; 7] = [
    -12715105075.0 / 11282082432.0,
    0.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

/// An explicit Runge-Kutta method.
#[derive(Clone)]
pub struct RungeKutta {
    info: &'static MethodInfo,
    tableau: &'static Tableau,
    n: usize,
    /// Velocities and accelerations of the stages, `stages x n` each.
    kq: Vec<f64>,
    kv: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    /// True if the first stage already has the acceleration at the start of the step.
    first_known: bool,
}

impl RungeKutta {
    /// Builds the classical method of order four.
    pub fn rk4() -> Self {
        Self::of(&RK4, &RK4_TABLEAU)
    }

    /// Builds Dormand-Prince 5(4), for fixed steps or a tolerance.
    pub fn dopri5() -> Self {
        Self::of(&DOPRI5, &DOPRI5_TABLEAU)
    }

    /// Returns the stability polynomial `R(z) = 1 + sum_k z^(k+1) b^T A^k 1`.
    #[must_use]
    pub fn stability(&self) -> Stability {
        let tb = self.tableau;
        let mut power = vec![1.0; tb.stages];
        let mut coefficients = vec![1.0];
        for _ in 0..tb.stages {
            coefficients.push(tb.b.iter().zip(&power).map(|(b, x)| b * x).sum());
            let next =
                tb.a.iter()
                    .map(|row| row.iter().zip(&power).map(|(a, x)| a * x).sum());
            power = next.collect();
        }
        // Stages that only serve the step control leave a zero.
        while coefficients.last() == Some(&0.0) {
            coefficients.pop();
        }
        Stability::Polynomial(coefficients)
    }

    fn of(info: &'static MethodInfo, tableau: &'static Tableau) -> Self {
        RungeKutta {
            info,
            tableau,
            n: 0,
            kq: Vec::new(),
            kv: Vec::new(),
            q: Vec::new(),
            v: Vec::new(),
            first_known: false,
        }
    }
}

impl RungeKutta {
    /// Makes one step of `N` coordinates; `N = 0` stands for a number known only at run time. A number known to the
    /// compiler unrolls the inner loops: a step of two coordinates is otherwise mostly bookkeeping.
    #[inline]
    fn step_of<const N: usize>(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        from: &State,
        h: f64,
        tolerance: &Tolerance,
        to: &mut State,
        work: &mut Work,
    ) -> f64 {
        let n = if N == 0 { self.n } else { N };
        let tb = self.tableau;
        let size = n * tb.stages;
        let (kq, kv) = (&mut self.kq[..size], &mut self.kv[..size]);
        let (q, v) = (&mut self.q[..n], &mut self.v[..n]);
        let (q0, v0) = (&from.q[..n], &from.v[..n]);
        let mut derivative = |t: f64, q: &[f64], v: &[f64], a: &mut [f64]| {
            let at = StateView {
                t,
                q,
                v,
                discrete: &from.discrete,
            };
            sys.force(at, a);
            sys.solve_mass(at, a);
            work.force_evaluations += 1;
        };
        kq[..n].copy_from_slice(v0);
        if !self.first_known {
            derivative(from.t, q0, v0, &mut kv[..n]);
            self.first_known = true;
        }
        // (A system may have no coordinate at all, chunks may not.)
        let chunk = n.max(1);
        // Sums `sum_j w_j k_j` over the stages so far, into `(q, v)`.
        let sum = |w: &[f64], kq: &[f64], kv: &[f64], q: &mut [f64], v: &mut [f64]| {
            let (q, v) = (&mut q[..n], &mut v[..n]);
            let mut first = true;
            for (w, (kq, kv)) in w
                .iter()
                .zip(kq.chunks_exact(chunk).zip(kv.chunks_exact(chunk)))
            {
                if *w == 0.0 {
                    continue;
                }
                let (kq, kv) = (&kq[..n], &kv[..n]);
                if std::mem::take(&mut first) {
                    for i in 0..n {
                        q[i] = w * kq[i];
                        v[i] = w * kv[i];
                    }
                } else {
                    for i in 0..n {
                        q[i] += w * kq[i];
                        v[i] += w * kv[i];
                    }
                }
            }
        };
        for stage in 1..tb.stages {
            sum(tb.a[stage], kq, kv, q, v);
            for i in 0..n {
                q[i] = q0[i] + h * q[i];
                v[i] = v0[i] + h * v[i];
            }
            derivative(from.t + tb.c[stage] * h, q, v, &mut kv[stage * n..][..n]);
            kq[stage * n..][..n].copy_from_slice(v);
        }
        if tb.first_same_as_last {
            // The last stage point is the solution itself.
            to.q[..n].copy_from_slice(q);
            to.v[..n].copy_from_slice(v);
        } else {
            sum(tb.b, kq, kv, q, v);
            for i in 0..n {
                to.q[i] = q0[i] + h * q[i];
                to.v[i] = v0[i] + h * v[i];
            }
        }
        to.t = from.t + h;
        if tb.e.is_empty() || tolerance.rtol == 0.0 {
            return 0.0;
        }
        sum(tb.e, kq, kv, q, v);
        let (scale_q, scale_v) = (&tolerance.q[..n], &tolerance.v[..n]);
        let mut worst = 0.0_f64;
        let mut all = 0.0;
        for i in 0..n {
            let rq = (q[i] / scale_q[i]).abs();
            let rv = (v[i] / scale_v[i]).abs();
            worst = worst.max(rq).max(rv);
            // max() drops NaN, a sum keeps it.
            all += rq + rv;
        }
        if all.is_finite() {
            h * worst / tolerance.rtol
        } else {
            f64::NAN
        }
    }
}

impl OneStep for RungeKutta {
    fn info(&self) -> &'static MethodInfo {
        self.info
    }

    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        archive.count(&mut self.n, u32::MAX as usize)?;
        for x in [&mut self.kq, &mut self.kv, &mut self.q, &mut self.v] {
            archive.numbers(x)?;
        }
        if self.kq.len() != self.tableau.stages * self.n || self.q.len() != self.n {
            return Err(ArchiveError::Value("number of stages"));
        }
        archive.flag(&mut self.first_known)
    }

    fn restart(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, work: &mut Work) {
        self.n = s.q.len();
        let size = self.n * self.tableau.stages;
        self.kq.resize(size, 0.0);
        self.kv.resize(size, 0.0);
        self.q.resize(self.n, 0.0);
        self.v.resize(self.n, 0.0);
        self.first_known = false;
        if self.tableau.first_same_as_last {
            sys.force(s.at(), &mut self.kv[..self.n]);
            sys.solve_mass(s.at(), &mut self.kv[..self.n]);
            work.force_evaluations += 1;
            self.first_known = true;
        }
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
        Ok(match self.n {
            1 => self.step_of::<1>(sys, from, h, tolerance, to, work),
            2 => self.step_of::<2>(sys, from, h, tolerance, to, work),
            3 => self.step_of::<3>(sys, from, h, tolerance, to, work),
            4 => self.step_of::<4>(sys, from, h, tolerance, to, work),
            _ => self.step_of::<0>(sys, from, h, tolerance, to, work),
        })
    }

    fn advance(&mut self) {
        if self.tableau.first_same_as_last {
            let last = (self.tableau.stages - 1) * self.n;
            self.kv.copy_within(last..last + self.n, 0);
        } else {
            self.first_known = false;
        }
    }

    fn interpolate(&self, from: &State, to: &State, theta: f64, q: &mut [f64], v: &mut [f64]) {
        let (n, h) = (self.n, to.t - from.t);
        if !self.tableau.first_same_as_last {
            // The interpolant of order three of the classical method (Hairer, Norsett, Wanner, II.6).
            let t2 = theta * theta;
            let middle = h * t2 * (1.0 - 2.0 / 3.0 * theta);
            let b = [
                h * (theta - t2 * (1.5 - 2.0 / 3.0 * theta)),
                middle,
                middle,
                h * t2 * (2.0 / 3.0 * theta - 0.5),
            ];
            q.copy_from_slice(&from.q);
            v.copy_from_slice(&from.v);
            let (q, v) = (&mut q[..n], &mut v[..n]);
            for (j, b) in b.into_iter().enumerate() {
                let (kq, kv) = (&self.kq[j * n..][..n], &self.kv[j * n..][..n]);
                for i in 0..n {
                    q[i] += b * kq[i];
                    v[i] += b * kv[i];
                }
            }
            return;
        }
        let last = (self.tableau.stages - 1) * n;
        hermite_with_acceleration(
            from,
            to,
            [&self.kv[..n], &self.kv[last..last + n]],
            theta,
            q,
            v,
        );
        let w = h * (theta * (1.0 - theta)).powi(2);
        let (q, v) = (&mut q[..n], &mut v[..n]);
        for (j, d) in DOPRI5_DENSE.iter().enumerate() {
            let d = w * d;
            let (kq, kv) = (&self.kq[j * n..][..n], &self.kv[j * n..][..n]);
            for i in 0..n {
                q[i] += d * kq[i];
                v[i] += d * kv[i];
            }
        }
    }
}
