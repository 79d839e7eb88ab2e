//! Closed-form motion of an oscillator under a constant load.
//!
//! `q'' + 2 zeta omega q' + omega^2 q = g` with `delta = zeta omega`, `w = omega sqrt(1 - zeta^2)`:
//!
//! ```text
//! q(h) = e (c + delta s) q0 + e s v0 + (1 - e (c + delta s)) / omega^2 g,   e = exp(-delta h)
//! v(h) = -omega^2 e s q0 + e (c - delta s) v0 + e s g,                      c = cos(w h), s = sin(w h) / w
//! ```
//!
//! and `q0 + h v0 + h^2 g / 2` for `omega = 0`. From critical damping on, `w = omega sqrt(zeta^2 - 1)` and hyperbolic
//! functions take the place of the circular ones; `e c` and `e s` are then computed from `exp(-(delta - w) h)`, the
//! slower of the two decays, which neither overflows nor cancels.

use crate::archive::{Archive, ArchiveError};

/// Coefficients of the motion of an oscillator over a time: `q = qq q0 + qv v0 + qg g`, `v = vq q0 + vv v0 + qv g`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Derivative `dq/dq0`.
    pub qq: f64,
    /// Derivative `dq/dv0` [s], equal to `dv/dg`.
    pub qv: f64,
    /// Derivative `dv/dq0` [1/s].
    pub vq: f64,
    /// Derivative `dv/dv0`.
    pub vv: f64,
    /// Derivative `dq/dg` [s^2].
    pub qg: f64,
}

/// Phase [rad] up to which `qg` of a damped oscillator is computed as a power series, because the closed form suffers
/// cancellation there.
const SERIES: f64 = 0.5;

/// Computes the coefficients over a time `h` [s]; `zeta` is not negative.
#[inline]
pub fn coefficients(omega: f64, zeta: f64, h: f64) -> Coefficients {
    if omega == 0.0 {
        return Coefficients {
            qq: 1.0,
            qv: h,
            vq: 0.0,
            vv: 1.0,
            qg: 0.5 * h * h,
        };
    }
    let square = omega * omega;
    if zeta == 0.0 {
        let (sin, cos) = (omega * h).sin_cos();
        let qv = sin / omega;
        // 1 - cos without cancellation.
        let rest = if cos > 0.0 {
            sin * sin / (1.0 + cos)
        } else {
            1.0 - cos
        };
        return Coefficients {
            qq: cos,
            qv,
            vq: -omega * sin,
            vv: cos,
            qg: rest / square,
        };
    }
    let delta = zeta * omega;
    // e c and e s of the equations above.
    let (ec, qv) = decay(omega, zeta, h);
    let qq = ec + delta * qv;
    let qg = if omega.max(delta) * h.abs() < SERIES {
        load_series(square, delta, h)
    } else {
        (1.0 - qq) / square
    };
    Coefficients {
        qq,
        qv,
        vq: -square * qv,
        vv: ec - delta * qv,
        qg,
    }
}

/// Computes `exp(-delta h) cos(w h)` and `exp(-delta h) sin(w h) / w` of a damped oscillator, with hyperbolic functions
/// beyond critical damping.
fn decay(omega: f64, zeta: f64, h: f64) -> (f64, f64) {
    let delta = zeta * omega;
    let squared = (1.0 - zeta) * (1.0 + zeta);
    if squared > 0.0 {
        let w = omega * squared.sqrt();
        let e = (-delta * h).exp();
        let (sin, cos) = (w * h).sin_cos();
        return (e * cos, e * sin / w);
    }
    let w = omega * (-squared).sqrt();
    // (delta - w) (delta + w) = omega^2: the slower decay without cancellation.
    let slow = (-(omega * omega / (delta + w)) * h).exp();
    let x = -2.0 * w * h;
    let over_w = match w {
        0.0 => 2.0 * h,
        w => -x.exp_m1() / w,
    };
    (0.5 * slow * (1.0 + x.exp()), 0.5 * slow * over_w)
}

/// Returns the compliance per unit mass [s^2] by which the response of an oscillator to impulses of a constant
/// acceleration every `h` [s] falls short of `1/omega^2`: `1/omega^2 - f^2 h/(2 omega) cot(omega h/2)` with the filter
/// `f` for phases above `from`, and `h^2/12` for `omega = 0`.
pub(crate) fn quasi_static_of(omega: f64, h: f64, from: f64) -> f64 {
    let x = omega * h;
    if x < LAG_SERIES && x <= from {
        // (1 - (x/2) cot (x/2)) / x^2
        let y = x * x;
        return h * h * (1.0 / 12.0 + y * (1.0 / 720.0 + y * (1.0 / 30240.0 + y / 1_209_600.0)));
    }
    // f^2 (x/2) cot (x/2) with sin x = 2 sin (x/2) cos (x/2): no pole where the filter is zero.
    let given = if x > from {
        let (sin, cos) = (0.5 * x).sin_cos();
        2.0 * sin * cos.powi(3) / x
    } else {
        0.5 * x / (0.5 * x).tan()
    };
    ((1.0 - given) / (omega * omega)).max(0.0)
}

/// Phase up to which [`quasi_static_of`] is computed as a power series, because the closed form suffers cancellation
/// there.
const LAG_SERIES: f64 = 0.3;

/// Computes `qg` as a power series in `h`, from `y'' = 1 - 2 delta y' - omega^2 y` at rest.
fn load_series(square: f64, delta: f64, h: f64) -> f64 {
    // `term` is the k-th, `before` the one before it; the two right sides shift by one and two powers.
    let (mut before, mut term) = (0.0, 0.5 * h * h);
    let mut sum = term;
    for k in 3..20 {
        let k = f64::from(k);
        let next =
            -(2.0 * delta * h * (k - 1.0) * term + square * h * h * before) / (k * (k - 1.0));
        (before, term) = (term, next);
        sum += next;
    }
    sum
}

/// Coefficients of all oscillators for one step size, and the filter at that step. Of `qq` and `vv` the difference
/// from one is stored: a cosine near one would round the phase of slow oscillators by the same error in every step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drift {
    /// Step size [s].
    pub(crate) h: f64,
    dq: Vec<f64>,
    qv: Vec<f64>,
    vq: Vec<f64>,
    dv: Vec<f64>,
    qg: Vec<f64>,
    /// Filter factor of each coordinate; empty where all are one.
    pub(crate) filter: Vec<f64>,
    /// Velocity in the middle of impulses of unit acceleration at which an oscillator rests [s]; empty where all are zero.
    at_rest: Vec<f64>,
    /// Factor of the last half impulse on the velocity that the remainder sees: filter squared, less the velocity at rest;
    /// empty where all are one.
    pub(crate) ends: Vec<f64>,
}

impl Drift {
    /// Computes the table for a step `h` [s]; oscillators with `omega h` above `from` are filtered with `sin(omega h)
    /// / (omega h)`.
    pub(crate) fn fill(&mut self, omega: &[f64], zeta: &[f64], h: f64, from: f64) {
        let n = omega.len();
        self.h = h;
        for x in [
            &mut self.dq,
            &mut self.qv,
            &mut self.vq,
            &mut self.dv,
            &mut self.qg,
        ] {
            x.resize(n, 0.0);
        }
        for (i, (&w, &z)) in omega.iter().zip(zeta).enumerate() {
            let c = coefficients(w, z, h);
            self.dq[i] = -w * w * c.qg;
            self.qv[i] = c.qv;
            self.vq[i] = c.vq;
            self.dv[i] = self.dq[i] - 2.0 * z * w * c.qv;
            self.qg[i] = c.qg;
        }
        self.filter.clear();
        if omega.iter().any(|w| w * h > from) {
            let seen = |w: &f64| if w * h > from { sinc(w * h) } else { 1.0 };
            self.filter.extend(omega.iter().map(seen));
        }
        self.at_rest.clear();
        if zeta.iter().any(|z| *z > 0.0) {
            let at_rest = |(i, z): (usize, &f64)| match *z > 0.0 {
                true => self.rest_under_kicks(i)[1],
                false => 0.0,
            };
            let at_rest: Vec<f64> = zeta.iter().enumerate().map(at_rest).collect();
            self.at_rest = at_rest;
        }
        self.ends.clear();
        if !(self.filter.is_empty() && self.at_rest.is_empty()) {
            let filter = |i: usize| self.filter.get(i).copied().unwrap_or(1.0);
            let of = |i: usize| filter(i).powi(2) * (1.0 - 2.0 * self.at_rest(i) / h);
            self.ends = (0..n).map(of).collect();
        }
    }

    /// Returns the velocity in the middle of impulses of unit acceleration at which oscillator `i` rests [s].
    #[inline]
    pub(crate) fn at_rest(&self, i: usize) -> f64 {
        self.at_rest.get(i).copied().unwrap_or(0.0)
    }

    /// Moves `(q0, v0)` after the half impulse of an acceleration `k` under the load `g` to `(q, v)`.
    #[inline]
    pub(crate) fn apply(
        &self,
        q0: &[f64],
        v0: &[f64],
        k: &[f64],
        g: &[f64],
        (q, v): (&mut [f64], &mut [f64]),
    ) {
        let n = q.len();
        let kick = 0.5 * self.h;
        let (q0, v0, k, g, v) = (&q0[..n], &v0[..n], &k[..n], &g[..n], &mut v[..n]);
        let (dq, qv, vq) = (&self.dq[..n], &self.qv[..n], &self.vq[..n]);
        let (dv, qg) = (&self.dv[..n], &self.qg[..n]);
        if self.at_rest.is_empty() {
            for i in 0..n {
                let u = v0[i] + kick * k[i];
                q[i] = q0[i] + (dq[i] * q0[i] + qv[i] * u + qg[i] * g[i]);
                v[i] = u + (vq[i] * q0[i] + dv[i] * u + qv[i] * g[i]);
            }
            return;
        }
        let at_rest = &self.at_rest[..n];
        for i in 0..n {
            let u = v0[i] + (kick + at_rest[i]) * k[i];
            q[i] = q0[i] + (dq[i] * q0[i] + qv[i] * u + qg[i] * g[i]);
            v[i] = u + (vq[i] * q0[i] + dv[i] * u + qv[i] * g[i]);
        }
    }

    /// Adds the last half impulse of an acceleration `k` to velocities.
    #[inline]
    pub(crate) fn end(&self, k: &[f64], v: &mut [f64]) {
        let half = 0.5 * self.h;
        if self.at_rest.is_empty() {
            v.iter_mut().zip(k).for_each(|(v, k)| *v += half * k);
            return;
        }
        for ((v, k), at_rest) in v.iter_mut().zip(k).zip(&self.at_rest) {
            *v += (half - at_rest) * k;
        }
    }

    /// Returns displacement and velocity of oscillator `i` in its periodic state under impulses of unit acceleration,
    /// in the middle of an impulse. The velocity is zero without damping; a damped oscillator loses part of each half
    /// impulse within the step.
    pub(crate) fn rest_under_kicks(&self, i: usize) -> [f64; 2] {
        // The state returns, with u after the kick: q = qv u / (1 - qq), v - h/2 = vq q + vv u.
        let lost = 2.0 + self.dv[i] - self.vq[i] * self.qv[i] / self.dq[i];
        let v = 0.5 * self.h * lost / (2.0 - lost);
        [-self.qv[i] * (v + 0.5 * self.h) / self.dq[i], v]
    }

    /// Returns the compliance per unit mass [s^2] by which the response of oscillator `i` to impulses falls short of
    /// `1/omega^2`: see [`quasi_static_of`], and with damping from its displacement at rest.
    pub(crate) fn quasi_static(&self, i: usize, omega: f64, from: f64) -> f64 {
        if self.at_rest(i) == 0.0 || omega * self.h < LAG_SERIES {
            return quasi_static_of(omega, self.h, from);
        }
        let filter = self.filter.get(i).copied().unwrap_or(1.0);
        let at_rest = filter * filter * self.rest_under_kicks(i)[0];
        (1.0 / (omega * omega) - at_rest).max(0.0)
    }

    /// Adds the motion of [`Self::load`] to `(q, v)`.
    #[inline]
    pub(crate) fn load_onto(
        &self,
        q0: &[f64],
        v0: &[f64],
        g: impl Fn(usize) -> f64,
        (q, v): (&mut [f64], &mut [f64]),
    ) {
        for i in 0..q.len() {
            q[i] += q0[i] + (self.dq[i] * q0[i] + self.qv[i] * v0[i] + self.qg[i] * g(i));
            v[i] += v0[i] + (self.vq[i] * q0[i] + self.dv[i] * v0[i] + self.qv[i] * g(i));
        }
    }

    /// Moves `(q0, v0)` under a load to `(q, v)`.
    #[inline]
    pub(crate) fn load(
        &self,
        q0: &[f64],
        v0: &[f64],
        g: impl Fn(usize) -> f64,
        (q, v): (&mut [f64], &mut [f64]),
    ) {
        for i in 0..q.len() {
            q[i] = q0[i] + (self.dq[i] * q0[i] + self.qv[i] * v0[i] + self.qg[i] * g(i));
            v[i] = v0[i] + (self.vq[i] * q0[i] + self.dv[i] * v0[i] + self.qv[i] * g(i));
        }
    }
}

#[inline]
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// Number of stored tables, for the step, its halves, and steps shortened by breakpoints and events.
const KEPT: usize = 8;

/// Tables of the most recent step sizes. A step that differs from that of a table by the rounding of times uses this
/// table.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    kept: Vec<Drift>,
    used: Vec<u64>,
    clock: u64,
    last: usize,
}

impl Tables {
    pub(crate) fn clear(&mut self) {
        self.used.fill(0);
        for d in &mut self.kept {
            d.h = 0.0;
        }
        self.last = 0;
    }

    /// Returns the index of the table for a step that starts at `t`; see [`Drift::fill`].
    pub(crate) fn find(&mut self, omega: &[f64], zeta: &[f64], t: f64, h: f64, from: f64) -> usize {
        self.clock += 1;
        let slack = 4.0 * f64::EPSILON * (t.abs() + h);
        let same = |d: &Drift| (d.h - h).abs() <= slack && d.h > 0.0;
        let found = if self.kept.get(self.last).is_some_and(same) {
            Some(self.last)
        } else {
            self.kept.iter().position(same)
        };
        let i = found.unwrap_or_else(|| {
            let i = if self.kept.len() < KEPT {
                self.kept.push(Drift::default());
                self.used.push(0);
                self.kept.len() - 1
            } else {
                let oldest = (0..KEPT).min_by_key(|&i| self.used[i]);
                oldest.unwrap_or(0)
            };
            self.kept[i].fill(omega, zeta, h, from);
            i
        });
        self.used[i] = self.clock;
        self.last = i;
        i
    }

    /// Traverses the step sizes of the tables; their values follow from them.
    pub(crate) fn archive(
        &mut self,
        omega: &[f64],
        zeta: &[f64],
        from: f64,
        archive: &mut Archive<'_>,
    ) -> Result<(), ArchiveError> {
        let mut steps: Vec<f64> = self.kept.iter().map(|d| d.h).collect();
        archive.numbers(&mut steps)?;
        if steps.len() > KEPT {
            return Err(ArchiveError::Value("number of tables"));
        }
        self.used.resize(steps.len(), 0);
        for used in &mut self.used {
            archive.whole(used)?;
        }
        archive.whole(&mut self.clock)?;
        archive.count(&mut self.last, steps.len().saturating_sub(1))?;
        if archive.reads() {
            self.kept.resize(steps.len(), Drift::default());
            for (table, &h) in self.kept.iter_mut().zip(&steps) {
                table.fill(omega, zeta, h, from);
            }
        }
        Ok(())
    }

    /// Largest index of a table; 0 where there are none.
    pub(crate) fn last_index(&self) -> usize {
        self.kept.len().saturating_sub(1)
    }

    pub(crate) fn get(&self, i: usize) -> &Drift {
        &self.kept[i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, scale: f64, what: &str) {
        assert!((a - b).abs() <= 4e-15 * scale, "{what}: {a:e} {b:e}");
    }

    /// Two parts of a step equal the whole, from zero to many periods, below, at and beyond critical damping.
    #[test]
    fn times_add_up() {
        for omega in [0.0, 1e-9, 1e-3, 0.3, 1.0, 7.0, 400.0] {
            for zeta in [
                0.0,
                1e-8,
                0.02,
                0.5,
                0.999,
                1.0 - 1e-12,
                1.0,
                1.0 + 1e-12,
                1.5,
                40.0,
            ] {
                let (a, b) = (
                    coefficients(omega, zeta, 0.3),
                    coefficients(omega, zeta, 0.45),
                );
                let whole = coefficients(omega, zeta, 0.75);
                let x = omega.max(1.0);
                close(b.qq * a.qq + b.qv * a.vq, whole.qq, 10.0 * x, "qq");
                close(b.qq * a.qv + b.qv * a.vv, whole.qv, 10.0, "qv");
                close(b.vq * a.qq + b.vv * a.vq, whole.vq, 10.0 * x * x, "vq");
                close(b.vq * a.qv + b.vv * a.vv, whole.vv, 10.0 * x, "vv");
                close(b.qq * a.qg + b.qv * a.qv + b.qg, whole.qg, 10.0, "qg");
            }
        }
    }

    /// The series agrees with the closed form where it begins, and a slow oscillator agrees with free flight.
    #[test]
    fn loads_are_exact_without_cancellation() {
        for zeta in [1e-6, 0.1, 0.9] {
            let h = (SERIES - 1e-9) / 3.0;
            let c = coefficients(3.0, zeta, h);
            close(c.qg, (1.0 - c.qq) / 9.0, 1.0 / 9.0, "series");
        }
        for zeta in [0.0, 0.3] {
            let c = coefficients(1e-7, zeta, 0.1);
            let third = 2.0 * zeta * 1e-7 * 1e-3 / 6.0;
            close(c.qg, 0.005 - third, 0.005, "slow");
        }
    }

    /// The quasi-static correction agrees with its definition: filtered impulses of unit acceleration keep an
    /// oscillator in a periodic state, whose filtered displacement falls short of `1/omega^2`.
    #[test]
    fn lags_are_what_kicks_leave_out() {
        let (h, from) = (0.3, 0.64 * std::f64::consts::PI);
        assert_eq!(quasi_static_of(0.0, h, from), h * h / 12.0);
        // Either side of the end of the series and of the filter, at its zeros, and far beyond.
        for x in [
            0.299_999, 0.300_001, 0.5, 1.0, 2.0, 2.1, 3.0, 3.13, 3.15, 4.0, 6.2, 6.4, 50.0,
        ] {
            let omega = x / h;
            let c = coefficients(omega, 0.0, h);
            let held = 0.5 * h * c.qv / (omega * omega * c.qg);
            let seen = if x > from { sinc(x) } else { 1.0 };
            let quasi_static = 1.0 / (omega * omega) - seen * seen * held;
            let found = quasi_static_of(omega, h, from);
            let error = (found / quasi_static - 1.0).abs();
            assert!(error < 3e-11, "omega h = {x}: {found:e} {quasi_static:e}");
        }
        // Slow ones without cancellation.
        for x in [1e-9, 1e-4, 1e-2] {
            let y = x * x;
            let want = h * h / 12.0 * (1.0 + y / 60.0 + y * y / 2520.0);
            close(quasi_static_of(x / h, h, from), want, h * h, "slow");
        }
        // Filtered from the first on: 1 - 2 sin (x/2) cos^3 (x/2) / x = 5 x^2/12 - ...
        let x = 1e-2;
        let given = 5.0 / 12.0 - 17.0 / 240.0 * x * x;
        let error = (quasi_static_of(x / h, h, 0.0) / (h * h) / given - 1.0).abs();
        assert!(error < 1e-8, "all filtered: {error:e}");
        // An oscillator without influence is left out completely.
        let omega = std::f64::consts::PI / h;
        close(
            quasi_static_of(omega, h, from) * omega * omega,
            1.0,
            1.0,
            "zero of the filter",
        );
    }

    #[test]
    fn tables_survive_the_rounding_of_times() {
        let mut tables = Tables::default();
        let (omega, zeta) = ([1.0, 2.0], [0.0, 0.1]);
        let i = tables.find(&omega, &zeta, 0.7, 1e-3, 9.0);
        let h = (0.7 + 1e-3) - 0.7;
        assert_ne!(h, 1e-3);
        assert_eq!(tables.find(&omega, &zeta, 0.7, h, 9.0), i);
        for k in 1..20 {
            tables.find(&omega, &zeta, 0.7, 1e-4 * f64::from(k), 9.0);
        }
        assert_eq!(tables.kept.len(), KEPT);
    }
}
