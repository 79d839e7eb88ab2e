//! Closed-form motion of a system under steady loads, without contact.
//!
//! Coordinates are sums of independent *oscillators* under constant loads:
//!
//! ```text
//! q_i(t) = sum_j w_ij x_j(t - t0),    x'' + 2 zeta omega x' + omega^2 x = g
//! ```
//!
//! with the solution of [`propagator`](crate::modal::propagator); `omega = 0` is the quadratic motion of a body. A
//! system that knows its motion so fills a [`FlightPath`] ([`SecondOrderSystem::flight_path`]), and the loop of any
//! method goes along it in one step ([`Integrator::free_flight`](crate::Integrator::free_flight)). It is exact up to
//! rounding, at both ends and inside.

use crate::archive::{Archive, ArchiveError};
use crate::method::Dense;
use crate::modal::propagator::coefficients;
use crate::system::{SecondOrderSystem, State};

/// Largest number of steps for which the query for a free flight is skipped after unsuccessful queries.
const MOST_SKIPPED: u32 = 8;

/// One oscillator under a constant load, and the coordinates that it moves.
#[derive(Clone, Copy, Debug)]
struct Oscillator {
    omega: f64,
    zeta: f64,
    /// Displacement and velocity at the start.
    start: [f64; 2],
    load: f64,
    /// End of the terms of this oscillator in [`FlightPath::terms`].
    terms: usize,
}

impl Oscillator {
    /// Returns displacement and velocity after a time [s].
    #[inline]
    fn at(&self, t: f64) -> [f64; 2] {
        let [x, v] = self.start;
        // At rest about the deflection of its load: a cosine would only round.
        if self.omega > 0.0 && v == 0.0 && x == self.load / (self.omega * self.omega) {
            return self.start;
        }
        let c = coefficients(self.omega, self.zeta, t);
        [
            c.qq * x + c.qv * v + c.qg * self.load,
            c.vq * x + c.vv * v + c.qv * self.load,
        ]
    }
}

/// A motion in closed form from a start time on. Buffers are reused from one path to the next.
#[derive(Clone, Debug, Default)]
pub struct FlightPath {
    start: f64,
    oscillators: Vec<Oscillator>,
    /// Coordinate index and weight of each contribution of an oscillator.
    terms: Vec<(u32, f64)>,
}

impl FlightPath {
    /// Clears the path and sets its start time [s].
    pub fn begin(&mut self, t: f64) {
        self.start = t;
        self.oscillators.clear();
        self.terms.clear();
    }

    /// Adds an oscillator `x'' + 2 zeta omega x' + omega^2 x = load` with the initial values `start = [x, x']`; `zeta`
    /// is not negative. [`Self::moves`] sets the coordinates that it contributes to.
    pub fn oscillator(&mut self, omega: f64, zeta: f64, start: [f64; 2], load: f64) {
        self.oscillators.push(Oscillator {
            omega,
            zeta,
            start,
            load,
            terms: self.terms.len(),
        });
    }

    /// Adds the oscillator that was added last to a coordinate, with a weight.
    pub fn moves(&mut self, coordinate: usize, weight: f64) {
        self.terms.push((coordinate as u32, weight));
        if let Some(oscillator) = self.oscillators.last_mut() {
            oscillator.terms = self.terms.len();
        }
    }

    /// Computes coordinates and velocities at a time [s].
    pub fn at(&self, t: f64, q: &mut [f64], v: &mut [f64]) {
        q.fill(0.0);
        v.fill(0.0);
        let mut first = 0;
        for oscillator in &self.oscillators {
            let [x, u] = oscillator.at(t - self.start);
            for &(i, weight) in &self.terms[first..oscillator.terms] {
                q[i as usize] += weight * x;
                v[i as usize] += weight * u;
            }
            first = oscillator.terms;
        }
    }
}

/// Dense output of a step along a closed-form path.
pub(crate) struct FlightDense<'a> {
    pub(crate) path: &'a FlightPath,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

impl Dense for FlightDense<'_> {
    fn eval(&self, theta: f64, q: &mut [f64], v: &mut [f64]) {
        self.path
            .at(self.from + theta * (self.to - self.from), q, v);
    }
}

/// Interval between queries for a closed-form path: none after a restart, else growing with each unsuccessful query,
/// so that contact phases cost few queries.
#[derive(Clone, Debug, Default)]
pub(crate) struct QueryInterval {
    skip: u32,
    next: u32,
}

impl QueryInterval {
    /// Resets the interval, so that the next step makes a query.
    pub(crate) fn end(&mut self) {
        (self.skip, self.next) = (0, 1);
    }

    /// Counts one step and returns true if it makes a query.
    pub(crate) fn over(&mut self) -> bool {
        let over = self.skip == 0;
        self.skip = self.skip.saturating_sub(1);
        over
    }

    /// Traverses the interval.
    pub(crate) fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        for x in [&mut self.skip, &mut self.next] {
            let mut word = u64::from(*x);
            archive.whole(&mut word)?;
            *x = u32::try_from(word)
                .ok()
                .filter(|x| *x <= MOST_SKIPPED)
                .ok_or(ArchiveError::Value("interval"))?;
        }
        Ok(())
    }

    /// Lengthens the interval after an unsuccessful query and resets it after a successful one.
    pub(crate) fn learn(&mut self, vain: bool) {
        if vain {
            self.skip = self.next;
            self.next = (2 * self.next).clamp(1, MOST_SKIPPED);
        } else {
            self.end();
        }
    }
}

/// State of the queries for free flights.
#[derive(Clone, Debug, Default)]
pub(crate) struct FlightProbe {
    /// True if free flights are used; false by default.
    pub(crate) on: bool,
    pub(crate) path: FlightPath,
    pub(crate) query_interval: QueryInterval,
}

impl FlightProbe {
    /// Returns the end time of a free flight from `s` on, which is then in [`Self::path`], or `s.t` if there is none
    /// that lasts beyond `later`.
    pub(crate) fn end(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, later: f64) -> f64 {
        if !self.on || !self.query_interval.over() {
            return s.t;
        }
        let until = sys.flight_path(s, later, &mut self.path);
        self.query_interval.learn(until <= later);
        if until > later { until } else { s.t }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two masses on a spring under a pull: the centre of mass accelerates uniformly and the elongation oscillates
    /// about its static value.
    #[test]
    fn oscillators_add_up_to_the_motion_of_coupled_masses() {
        let (m, k, pull) = ([2.0, 3.0], 7.0, 1.5);
        let total: f64 = m[0] + m[1];
        let reduced = m[0] * m[1] / total;
        let (q0, v0) = ([0.1, 0.4], [1.0, -0.5]);
        let mut path = FlightPath::default();
        path.begin(2.0);
        let centre = |x: [f64; 2]| (m[0] * x[0] + m[1] * x[1]) / total;
        path.oscillator(0.0, 0.0, [centre(q0), centre(v0)], pull / total);
        path.moves(0, 1.0);
        path.moves(1, 1.0);
        let start = [q0[1] - q0[0], v0[1] - v0[0]];
        path.oscillator((k / reduced).sqrt(), 0.0, start, -pull / m[0]);
        path.moves(0, -m[1] / total);
        path.moves(1, m[0] / total);
        let at = |t: f64| {
            let (mut q, mut v) = ([0.0; 2], [0.0; 2]);
            path.at(2.0 + t, &mut q, &mut v);
            (q, v)
        };
        let (q, v) = at(0.0);
        for i in 0..2 {
            assert!((q[i] - q0[i]).abs() < 1e-15 && (v[i] - v0[i]).abs() < 1e-15);
        }
        // Differences of the closed form satisfy Newton's law.
        let h = 1e-4;
        for t in [0.3, 1.7, 20.0] {
            let (q, _) = at(t);
            let (ahead, behind) = (at(t + h).1, at(t - h).1);
            for (i, load) in [pull, 0.0].into_iter().enumerate() {
                let a = (ahead[i] - behind[i]) / (2.0 * h);
                let spring = k * (q[1] - q[0]) * [1.0, -1.0][i];
                assert!((m[i] * a - spring - load).abs() < 1e-6, "{t} {i}");
            }
        }
    }

    #[test]
    fn what_rests_under_its_load_stays_to_the_last_bit() {
        let mut path = FlightPath::default();
        path.begin(0.0);
        let (omega, load) = (3e5_f64, 17.0);
        let q0 = load / (omega * omega);
        path.oscillator(omega, 0.01, [q0, 0.0], load);
        path.moves(0, 1.0);
        let (mut q, mut v) = ([0.0], [0.0]);
        path.at(1.2345, &mut q, &mut v);
        assert_eq!((q[0], v[0]), (q0, 0.0));
    }
}
