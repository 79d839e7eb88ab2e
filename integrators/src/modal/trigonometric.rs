//! The trigonometric method: kick, exact drift, kick.
//!
//! ```text
//! u = v0 + (h/2 + d) r0,   (q1, u) <- oscillators and steady loads over h, in closed form,   v1 = u + (h/2 - d) r1
//! ```
//!
//! with `r` the remainder of the acceleration without the steady loads ([`ModalSplit`]): one evaluation per step. It is
//! exact where the remainder is zero, symplectic without damping and symmetric; a remainder that depends on velocity is
//! evaluated at the predicted `u + h/2 r0`, or, where the system can, implicitly at `v1`
//! ([`remainder_after`](ModalSplit::remainder_after)), as contacts do with dashpots; both keep order two. P. Deuflhard, *Z. angew. Math. Phys.* 30 (1979)
//! 177; as the impulse method H. Grubmueller et al., *Mol. Simul.* 6 (1991) 121, M. Tuckerman et al., *J. Chem.
//! Phys.* 97 (1992) 1990.
//!
//! **The step** is bound by the remainder alone: `omega_c h < 2` with the frequency of the contact, whatever dashpots
//! that are taken implicitly (the kicks at both sides of an instant are then the implicit midpoint rule, a contraction),
//! and away from the
//! resonances `omega h = pi, 2 pi, ...` of oscillators that it excites ([`resonance`](super::resonance)).
//!
//! **Damped oscillators** lose part of each half impulse within the step, so that one that rests under a steady force has
//! the velocity `d r` in the middle of its impulses. The velocities of the method are those without it, which vanish at
//! rest: forces that depend on velocity, outputs and losses see these. `d` is of second order in the step, and zero
//! without damping.
//!
//! **Quasi-static correction.** Impulses of a sustained force move an oscillator by `h/(2 omega) cot(omega h/2)` per
//! unit instead of `1/omega^2`: too little by `h^2/12` for slow ones, by a third at the safe limit. At fixed steps the
//! system receives the difference ([`ModalSplit::prepare`]) and may add it as local compliance. The scheme stays
//! symplectic: such a compliance subtracts `h^2/24 |grad V|^2` from the potential `V` of the remainder, which is the
//! correction that raises kick-drift-kick to order four up to a change of coordinates (M. Takahashi, M. Imada, *J.
//! Phys. Soc. Jpn.* 53 (1984) 3765).
//!
//! **Loaded starts.** A system that starts in static equilibrium ([`ModalSplit::starts_balanced`]) would vibrate about
//! the rest position under impulses. At fixed steps the start is moved there: forces are those of the static
//! equilibrium, oscillators are deflected as impulses of these forces deflect them.
//!
//! **Flight.** Where the system guarantees that no contact closes until some time, one closed-form step goes there,
//! however long, without an evaluation. The step or tolerance of a plan applies to the rest: contact and its
//! neighbourhood. Fixed steps stay on their grid. Inside such a step the dense output is exact.
//!
//! **Under a tolerance** the step is a power of two times a second, so that tables of cosines serve again, and at most
//! `0.64 pi / omega` of the fastest oscillator. The estimate is the difference of the two kicks,
//! `h/2 |r1 - r0|`: of second order like the error where a contact opens or closes within the step, and larger than
//! the error, which is of third order, elsewhere. The global error then follows the tolerance with slope one.

use super::propagator::{Drift, Tables, coefficients};
use super::resonance::{Filter, safe_step};
use crate::archive::{Archive, ArchiveError};
use crate::equilibrium::shift;
use crate::error::StepError;
use crate::free_flight::QueryInterval;
use crate::method::{MethodInfo, OneStep, Parameter, Resolution, Stepping, Tolerance, Work};
use crate::system::{Coeffs, HalfStepImpulse, ModalSplit, SecondOrderSystem, State, StateView};
use std::cell::RefCell;

/// Declared properties of the trigonometric method.
pub static INFO: MethodInfo = MethodInfo {
    id: "trigonometric",
    name: "trigonometric",
    order: 2,
    implicit: false,
    stepping: Stepping::Both,
    tolerance_slope: 1.0,
    dissipative: false,
    linear_part: true,
    dense_matrices: false,
    parameters: &[Parameter {
        name: "filter",
        default: 1.0,
        range: (0.0, 2.0),
        meaning: "0: none; 1: oscillators beyond 0.64 pi/h act on contact, and contact on them, by their mean over the step, which takes out resonances; 2: all oscillators do",
    }],
    citation: "Deuflhard, Z. angew. Math. Phys. 30 (1979) 177; Garcia-Archilla, Sanz-Serna, Skeel, SIAM J. Sci. Comput. 20 (1998) 930",
};

/// Acceleration of the remainder at one end of a step, from which the half impulse follows.
#[derive(Clone, Debug, Default)]
struct EndAcceleration {
    /// Acceleration without oscillators and steady loads, filtered.
    a: Vec<f64>,
    /// True if other forces than the steady loads act.
    acts: bool,
    /// Step [s] of the filter that was applied; 0 without a filter.
    filter: f64,
}

/// Largest number of Newton iterations for the rest position under impulses.
const MOST_ITERATIONS: u32 = 40;
/// Corrections of a rest position in typical deflections. Below the first the search ends; between the two it ends if
/// rounding prevents a further decrease.
const AT_REST: f64 = 1e-11;
const ROUNDING: f64 = 1e-7;

/// The trigonometric method with its tables and buffers.
#[derive(Clone, Debug, Default)]
pub struct Trigonometric {
    /// Phase `omega h` [rad] above which oscillators are filtered.
    filter_from: f64,
    omega: Vec<f64>,
    zeta: Vec<f64>,
    longest: f64,
    tables: Tables,
    /// Tables for points inside steps.
    inside: RefCell<Tables>,
    /// Index of the table of the last step.
    table: usize,
    ends: [EndAcceleration; 2],
    /// Acceleration from steady loads, and the time until which they are steady.
    steady: Vec<f64>,
    steady_until: f64,
    /// Time until which no contact can close.
    free_until: f64,
    query_interval: QueryInterval,
    /// Velocities at the end of a step before its last half impulse.
    predicted: Vec<f64>,
    /// Filtered coordinates and velocities for the evaluation of the remainder.
    q: Vec<f64>,
    v: Vec<f64>,
    before: Vec<f64>,
}

impl Trigonometric {
    /// Builds the method with a filter.
    pub fn new(filter: Filter) -> Self {
        Trigonometric {
            filter_from: filter.from(),
            longest: f64::INFINITY,
            ..Trigonometric::default()
        }
    }

    /// Evaluates the remainder at `at` into end `end`, with or without the filter of a table. At the end of a step the
    /// velocities before the half impulse and its duration are given.
    fn evaluate(
        &mut self,
        split: &mut dyn ModalSplit,
        at: StateView<'_>,
        end: usize,
        table: Option<usize>,
        kicked: Option<(&[f64], f64)>,
        work: &mut Work,
    ) {
        let kick = &mut self.ends[end];
        let n = kick.a.len();
        work.force_evaluations += 1;
        let drift = table.map(|table| self.tables.get(table));
        let ends: &[f64] = drift.map_or(&[], |d| &d.ends);
        let drift = drift.filter(|d| !d.filter.is_empty());
        let filtered = |x: &[f64], into: &mut Vec<f64>| {
            let Some(d) = drift else { return };
            into.clear();
            into.extend(x.iter().zip(&d.filter[..n]).map(|(x, f)| f * x));
        };
        filtered(at.q, &mut self.q);
        filtered(at.v, &mut self.v);
        let seen = match drift {
            Some(_) => StateView {
                q: &self.q,
                v: &self.v,
                ..at
            },
            None => at,
        };
        match kicked {
            Some((before, time)) => {
                filtered(before, &mut self.before);
                let half = HalfStepImpulse {
                    time,
                    before: drift.map_or(before, |_| &self.before),
                    steady: &self.steady,
                    filter: ends,
                };
                split.remainder_after(seen, &half, &mut kick.a);
            }
            None => split.remainder(seen, &mut kick.a),
        }
        kick.acts = subtract(&mut kick.a, &self.steady);
        kick.filter = drift.map_or(0.0, |d| d.h);
        if let Some(d) = drift.filter(|_| kick.acts) {
            for (a, f) in kick.a.iter_mut().zip(&d.filter) {
                *a *= f;
            }
        }
    }
}

/// Subtracts the steady acceleration, `a -= g`, and returns true when the rest is not negligible.
#[inline]
fn subtract(a: &mut [f64], g: &[f64]) -> bool {
    let mut largest = 0.0_f64;
    let mut all = 0.0;
    for (a, g) in a.iter_mut().zip(g) {
        *a -= g;
        largest = largest.max(a.abs());
        all += *a;
    }
    // max() drops NaN, a sum keeps it.
    largest > 0.0 || all.is_nan()
}

const NO_SPLIT: StepError = StepError::Unsupported {
    method: INFO.id,
    what: "a system that is not linear oscillators and a remainder; take another method there, for example velocity-verlet or dopri5",
};

impl OneStep for Trigonometric {
    fn info(&self) -> &'static MethodInfo {
        &INFO
    }

    fn begin(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        resolution: Resolution,
    ) -> Result<(), StepError> {
        let n = sys.layout().n;
        let split = sys.modal().ok_or(NO_SPLIT)?;
        for x in [
            &mut self.omega,
            &mut self.zeta,
            &mut self.steady,
            &mut self.predicted,
            &mut self.q,
            &mut self.v,
        ] {
            x.clear();
            x.resize(n, 0.0);
        }
        for end in &mut self.ends {
            end.a.clear();
            end.a.resize(n, 0.0);
        }
        split.oscillators(&mut self.omega, &mut self.zeta);
        let good = |(w, z): (&f64, &f64)| *w >= 0.0 && w.is_finite() && *z >= 0.0 && z.is_finite();
        if !self.omega.iter().zip(&self.zeta).all(good) {
            return Err(StepError::Unsupported {
                method: INFO.id,
                what: "an oscillator whose damping ratio is negative, or whose frequency or damping ratio is no number",
            });
        }
        // Of changing steps the shortest matter, at the edges of contact: they lag behind by nothing.
        if let Resolution::Step(h) = resolution {
            let mut drift = Drift::default();
            drift.fill(&self.omega, &self.zeta, h, self.filter_from);
            for (i, &w) in self.omega.iter().enumerate() {
                self.predicted[i] = drift.quasi_static(i, w, self.filter_from);
            }
            split.prepare(&self.predicted);
        }
        self.longest = safe_step(&self.omega);
        self.tables.clear();
        self.inside.get_mut().clear();
        Ok(())
    }

    /// Solves for the rest position under impulses by Newton's method on the remainder. The remainder of an oscillator
    /// has to agree with the rest position that it causes, that of a rigid-body motion with the static equilibrium.
    /// The tangent of the system serves as Jacobian, since its difference from the exact one is small or given as
    /// local compliance.
    fn balance(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        resolution: Resolution,
        work: &mut Work,
    ) {
        let (Resolution::Step(h), Some(split)) = (resolution, sys.modal()) else {
            return;
        };
        if !split.starts_balanced(s) {
            return;
        }
        let n = s.q.len();
        let (mut r, mut x) = (vec![0.0; n], vec![0.0; n]);
        if split.steady(s.at(), &mut self.steady) <= s.t {
            self.steady.fill(0.0);
        }
        split.prepare(&x);
        split.remainder(s.at(), &mut r);
        split.prepare(&self.predicted);
        let at_start = r.clone();
        let table = (self.tables).find(&self.omega, &self.zeta, s.t, h, self.filter_from);
        let drift = self.tables.get(table);
        let swings: Vec<usize> = (0..n).filter(|i| self.omega[*i] > 0.0).collect();
        let filter = |i: usize| drift.filter.get(i).copied().unwrap_or(1.0);
        let (omega, steady) = (&self.omega, &self.steady);
        let rest = |i: usize, r: f64| {
            let kick = filter(i) * (r - steady[i]);
            steady[i] / omega[i].powi(2) + kick * drift.rest_under_kicks(i)[0]
        };
        // The state that the remainder depends on.
        let mut seen = s.clone();
        for &i in &swings {
            seen.q[i] = filter(i) * rest(i, r[i]);
        }
        let scales = Tolerance::of(sys, 0.0).q;
        // A free train has a rigid motion: a little mass is added to the stiffness.
        let mut mass = 0.0;
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            let Some(split) = sys.modal() else { return };
            split.remainder(seen.at(), &mut r);
            work.force_evaluations += 1;
            let mut lack = r.clone();
            lack.iter_mut().zip(&at_start).for_each(|(r, is)| *r -= is);
            for &i in &swings {
                lack[i] = omega[i].powi(2) * (filter(i) * rest(i, r[i]) - seen.q[i]);
            }
            sys.apply_mass(seen.at(), &lack, &mut x);
            if mass == 0.0 {
                let Ok(shift) = shift(sys, &seen, &x) else {
                    return;
                };
                mass = shift;
            }
            let c = Coeffs {
                m: mass,
                d: 0.0,
                k: 1.0,
            };
            if work.correct(sys, seen.at(), c, &mut x).is_err() {
                return;
            }
            let sizes = x.iter().zip(&scales).map(|(x, scale)| (x / scale).abs());
            // `max` ignores NaN, a sum propagates it.
            let size: f64 = sizes.sum();
            if size.is_nan() || size >= smallest.max(1.0) {
                return;
            }
            seen.q.iter_mut().zip(&x).for_each(|(q, x)| *q += x);
            if size <= AT_REST || (size <= ROUNDING && size > 0.5 * smallest) {
                s.q.copy_from_slice(&seen.q);
                for &i in &swings {
                    s.q[i] = rest(i, r[i]);
                }
                return;
            }
            smallest = smallest.min(size);
        }
    }

    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        for end in &mut self.ends {
            archive.numbers(&mut end.a)?;
            archive.flag(&mut end.acts)?;
            archive.number(&mut end.filter)?;
        }
        for x in [
            &mut self.steady,
            &mut self.predicted,
            &mut self.q,
            &mut self.v,
            &mut self.before,
        ] {
            archive.numbers(x)?;
        }
        for x in [
            &mut self.longest,
            &mut self.steady_until,
            &mut self.free_until,
        ] {
            archive.number(x)?;
        }
        self.query_interval.archive(archive)?;
        let (omega, zeta, from) = (&self.omega, &self.zeta, self.filter_from);
        (self.tables).archive(omega, zeta, from, archive)?;
        (self.inside.get_mut()).archive(omega, zeta, from, archive)?;
        archive.count(&mut self.table, self.tables.last_index())
    }

    fn restart(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, work: &mut Work) {
        self.query_interval.end();
        self.free_until = s.t;
        let Some(split) = sys.modal() else { return };
        self.steady_until = split.steady(s.at(), &mut self.steady);
        if self.steady_until <= s.t {
            self.steady.fill(0.0);
        }
        // A filter belongs to a step, which is not known yet.
        self.evaluate(split, s.at(), 0, None, None, work);
    }

    fn free_flight_end(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, h: f64) -> f64 {
        if self.ends[0].acts || !self.query_interval.over() || self.steady_until <= s.t + h {
            return s.t;
        }
        let Some(split) = sys.modal() else { return s.t };
        self.free_until = split.free_until(s);
        let end = self.free_until.min(self.steady_until);
        self.query_interval.learn(end <= s.t + h);
        end
    }

    fn preferred_step(&self, h: f64) -> f64 {
        let h = h.min(self.longest);
        // The largest power of two that is not larger: the exponent without the digits.
        if h.is_normal() {
            f64::from_bits(h.to_bits() & 0x7ff0_0000_0000_0000)
        } else {
            h
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
        let split = sys.modal().ok_or(NO_SPLIT)?;
        let table = self
            .tables
            .find(&self.omega, &self.zeta, from.t, h, self.filter_from);
        self.table = table;
        to.t = from.t + h;
        let flies = !self.ends[0].acts && to.t <= self.free_until;
        let drift = self.tables.get(table);
        // Half of the step of the table, which is the same number in all steps of one grid.
        let half = 0.5 * drift.h;
        let filter = if drift.filter.is_empty() {
            0.0
        } else {
            drift.h
        };
        if !flies && self.ends[0].filter != filter {
            self.evaluate(split, from.at(), 0, Some(table), None, work);
        }
        let n = self.omega.len();
        self.tables.get(table).apply(
            &from.q,
            &from.v,
            &self.ends[0].a,
            &self.steady,
            (&mut to.q[..n], &mut to.v[..n]),
        );
        if flies {
            let end = &mut self.ends[1];
            end.a.fill(0.0);
            end.acts = false;
            end.filter = filter;
            return Ok(0.0);
        }
        let mut predicted = std::mem::take(&mut self.predicted);
        predicted.copy_from_slice(&to.v);
        if self.ends[0].acts {
            self.tables.get(table).end(&self.ends[0].a, &mut predicted);
        }
        let at = StateView {
            t: to.t,
            q: &to.q,
            v: &predicted,
            discrete: &from.discrete,
        };
        self.evaluate(split, at, 1, Some(table), Some((&to.v, half)), work);
        self.predicted = predicted;
        let [start, end] = &self.ends;
        if !end.acts && !start.acts {
            return Ok(0.0);
        }
        let (a0, a1) = (&start.a[..n], &end.a[..n]);
        self.tables.get(table).end(a1, &mut to.v[..n]);
        if tolerance.rtol == 0.0 {
            return Ok(0.0);
        }
        let (mut worst, mut all) = (0.0_f64, 0.0);
        for (i, scale) in tolerance.v[..n].iter().enumerate() {
            let e = ((a1[i] - a0[i]) / scale).abs();
            worst = worst.max(e);
            all += e;
        }
        Ok(if all.is_finite() {
            half * worst / tolerance.rtol
        } else {
            f64::NAN
        })
    }

    fn advance(&mut self) {
        self.ends.swap(0, 1);
        if self.ends[0].acts {
            self.query_interval.end();
        }
    }

    /// Interpolates by the closed form with oscillators, steady loads and the initial half impulse as a constant load;
    /// a cubic adds the difference at the end.
    fn interpolate(&self, from: &State, to: &State, theta: f64, q: &mut [f64], v: &mut [f64]) {
        let n = self.omega.len();
        let h = to.t - from.t;
        let t = theta * h;
        let [start, end] = &self.ends;
        let kicked = start.acts || end.acts;
        let load = |i: usize| self.steady[i] + if start.acts { start.a[i] } else { 0.0 };
        let (s, r) = (theta, 1.0 - theta);
        let whole = self.tables.get(self.table);
        if kicked {
            // The constant load over the whole step leaves the difference (dq, dv).
            whole.load(&from.q, &from.v, load, (&mut *q, &mut *v));
            let (sq, svq) = (s * s * (3.0 - 2.0 * s), -h * s * s * r);
            let (vq, vv) = (6.0 * s * r / h, s * (3.0 * s - 2.0));
            for i in 0..n {
                let (dq, dv) = (to.q[i] - q[i], to.v[i] - v[i]);
                q[i] = sq * dq + svq * dv;
                v[i] = vq * dq + vv * dv;
            }
        } else {
            q.fill(0.0);
            v.fill(0.0);
        }
        if kicked {
            // Observers look at the same places of step after step.
            let mut inside = self.inside.borrow_mut();
            let table = inside.find(&self.omega, &self.zeta, from.t, t, f64::INFINITY);
            let drift = inside.get(table);
            drift.load_onto(&from.q, &from.v, load, (q, v));
            return;
        }
        for i in 0..n {
            let c = coefficients(self.omega[i], self.zeta[i], t);
            let g = load(i);
            q[i] += c.qq * from.q[i] + c.qv * from.v[i] + c.qg * g;
            v[i] += c.vq * from.q[i] + c.vv * from.v[i] + c.qv * g;
        }
    }
}
