//! Explicit Runge-Kutta methods on `(q, v)`: the classical RK4 and Dormand-Prince 5(4).
//!
//! Stages of `y' = F(t, y)`, `y = (q, v)`, `F = (v, a)`: `Y_i = y0 + h sum_j a_ij F_j`. Dormand-Prince
//! carries an embedded fourth-order solution for the step control, reuses its last stage, and has a
//! fourth-order interpolant. W. Kutta (1901); J. R. Dormand, P. J. Prince, *J. Comp. Appl. Math.* 6 (1980)
//! 19; interpolant from L. F. Shampine, *Math. Comp.* 46 (1986) 135.

use crate::interpolation::hermite_with_acceleration;
use crate::method::{MethodInfo, OneStep, StepError, Stepping, Tolerance, Work};
use crate::system::{At, SecondOrderSystem, State};

/// What RK4 declares.
pub static RK4: MethodInfo = MethodInfo {
    id: "rk4",
    name: "Runge-Kutta 4",
    order: 4,
    implicit: false,
    stepping: Stepping::Fixed,
    tolerance_slope: 0.0,
    dissipative: true,
    parameters: &[],
    citation: "Kutta, Z. Math. Phys. 46 (1901) 435",
};

/// What Dormand-Prince declares.
pub static DOPRI5: MethodInfo = MethodInfo {
    id: "dopri5",
    name: "Dormand-Prince 5(4)",
    order: 5,
    implicit: false,
    stepping: Stepping::Both,
    tolerance_slope: 1.0,
    dissipative: true,
    parameters: &[],
    citation: "Dormand, Prince, J. Comp. Appl. Math. 6 (1980) 19",
};

/// Coefficients of a method: strictly lower triangle row by row, weights, nodes.
struct Tableau {
    stages: usize,
    a: &'static [&'static [f64]],
    b: &'static [f64],
    c: &'static [f64],
    /// Weights of the error estimate (solution minus embedded one), empty without.
    e: &'static [f64],
    /// The last stage is the first of the next step.
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

/// Weights of Shampine's fifth interpolation term.
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
pub struct RungeKutta {
    info: &'static MethodInfo,
    tableau: &'static Tableau,
    n: usize,
    /// Stage velocities and accelerations, `stages x n` each.
    kq: Vec<f64>,
    kv: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    zero: Vec<f64>,
    /// The first stage holds the acceleration at the start of the step already.
    first_known: bool,
}

impl RungeKutta {
    /// The classical method of order four.
    pub fn rk4() -> Self {
        Self::of(&RK4, &RK4_TABLEAU)
    }

    /// Dormand-Prince 5(4), at fixed steps or under a tolerance.
    pub fn dopri5() -> Self {
        Self::of(&DOPRI5, &DOPRI5_TABLEAU)
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
            zero: Vec::new(),
            first_known: false,
        }
    }
}

/// `out = base + h sum_j a_j k_j` over the first stages of `k`, each as long as `out`.
#[inline]
fn combine(out: &mut [f64], base: &[f64], h: f64, a: &[f64], k: &[f64]) {
    // Numbers of terms and of coordinates known to the compiler are worth a factor of three to five in a
    // step of two coordinates.
    match out.len() {
        1 => terms::<1>(out, base, h, a, k),
        2 => terms::<2>(out, base, h, a, k),
        3 => terms::<3>(out, base, h, a, k),
        4 => terms::<4>(out, base, h, a, k),
        _ => terms::<0>(out, base, h, a, k),
    }
}

#[inline]
fn terms<const N: usize>(out: &mut [f64], base: &[f64], h: f64, a: &[f64], k: &[f64]) {
    match a.len() {
        1 => sum::<1, N>(out, base, h, a, k),
        2 => sum::<2, N>(out, base, h, a, k),
        3 => sum::<3, N>(out, base, h, a, k),
        4 => sum::<4, N>(out, base, h, a, k),
        5 => sum::<5, N>(out, base, h, a, k),
        6 => sum::<6, N>(out, base, h, a, k),
        _ => sum::<7, N>(out, base, h, a, k),
    }
}

/// `S` terms of `N` coordinates; `N = 0` means a number of coordinates known at run time only.
#[inline(always)]
fn sum<const S: usize, const N: usize>(
    out: &mut [f64],
    base: &[f64],
    h: f64,
    a: &[f64],
    k: &[f64],
) {
    let n = if N == 0 { out.len() } else { N };
    let (out, base, a, k) = (&mut out[..n], &base[..n], &a[..S], &k[..S * n]);
    for i in 0..n {
        let mut sum = 0.0;
        for j in 0..S {
            sum += a[j] * k[j * n + i];
        }
        out[i] = base[i] + h * sum;
    }
}

impl OneStep for RungeKutta {
    fn info(&self) -> &'static MethodInfo {
        self.info
    }

    fn restart(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, work: &mut Work) {
        self.n = s.q.len();
        let size = self.n * self.tableau.stages;
        self.kq.resize(size, 0.0);
        self.kv.resize(size, 0.0);
        self.q.resize(self.n, 0.0);
        self.v.resize(self.n, 0.0);
        self.zero.resize(self.n, 0.0);
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
        let (n, tb) = (self.n, self.tableau);
        self.kq[..n].copy_from_slice(&from.v);
        if !self.first_known {
            sys.force(from.at(), &mut self.kv[..n]);
            sys.solve_mass(from.at(), &mut self.kv[..n]);
            work.force_evaluations += 1;
        }
        let last = tb.stages - 1;
        for stage in 1..tb.stages {
            let a = tb.a[stage];
            combine(&mut self.q, &from.q, h, a, &self.kq);
            combine(&mut self.v, &from.v, h, a, &self.kv);
            if stage == last && tb.first_same_as_last {
                // The last stage point is the solution itself.
                to.q.copy_from_slice(&self.q);
                to.v.copy_from_slice(&self.v);
            }
            let at = At {
                t: from.t + tb.c[stage] * h,
                q: &self.q,
                v: &self.v,
                memory: &from.memory,
            };
            let kv = &mut self.kv[stage * n..][..n];
            sys.force(at, kv);
            sys.solve_mass(at, kv);
            work.force_evaluations += 1;
            self.kq[stage * n..][..n].copy_from_slice(&self.v);
        }
        if !tb.first_same_as_last {
            combine(&mut to.q, &from.q, h, tb.b, &self.kq);
            combine(&mut to.v, &from.v, h, tb.b, &self.kv);
        }
        to.t = from.t + h;
        if tb.e.is_empty() || tolerance.rtol == 0.0 {
            return Ok(0.0);
        }
        // The stage buffers are free: the error of q and of v.
        combine(&mut self.q, &self.zero, h, tb.e, &self.kq);
        combine(&mut self.v, &self.zero, h, tb.e, &self.kv);
        let mut worst = 0.0_f64;
        let mut sum = 0.0;
        for i in 0..n {
            let rq = (self.q[i] / tolerance.q[i]).abs();
            let rv = (self.v[i] / tolerance.v[i]).abs();
            worst = worst.max(rq).max(rv);
            // max() drops NaN, a sum keeps it.
            sum += rq + rv;
        }
        if !sum.is_finite() {
            return Ok(f64::NAN);
        }
        Ok(worst / tolerance.rtol)
    }

    fn advance(&mut self) {
        if self.tableau.first_same_as_last {
            let last = (self.tableau.stages - 1) * self.n;
            self.kv.copy_within(last..last + self.n, 0);
            self.first_known = true;
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
            for (j, b) in b.into_iter().enumerate() {
                for i in 0..n {
                    q[i] += b * self.kq[j * n + i];
                    v[i] += b * self.kv[j * n + i];
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
        for i in 0..n {
            let (mut dq, mut dv) = (0.0, 0.0);
            for (j, &d) in DOPRI5_DENSE.iter().enumerate() {
                dq += d * self.kq[j * n + i];
                dv += d * self.kv[j * n + i];
            }
            q[i] += w * dq;
            v[i] += w * dv;
        }
    }
}
