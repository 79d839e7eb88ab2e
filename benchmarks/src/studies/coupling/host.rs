//! The host: hubs under extrapolated forces and their own loads.

use super::frames::Frame;
use super::step_polynomial::Extrapolation;
use super::step_polynomial::StepPolynomial;

/// Parts of a communication step of a host at least: classical Runge-Kutta steps, whose error is far below that of any
/// extrapolation.
const PARTS: u32 = 8;
/// Values of a force that are kept.
const KEPT: usize = 3;

/// Hub of the host under the extrapolated force of its gear.
#[derive(Clone, Debug)]
pub struct Hub<'a> {
    frame: &'a Frame,
    /// Angle [rad] or displacement [m], and its rate.
    pub at: [f64; 2],
    /// Forces at the last communication points, the newest last.
    past: Vec<(f64, f64)>,
}

impl<'a> Hub<'a> {
    /// Creates a hub with a displacement and a velocity.
    pub fn new(frame: &'a Frame, at: [f64; 2]) -> Self {
        Hub {
            frame,
            at,
            past: Vec::with_capacity(KEPT + 1),
        }
    }

    /// Records the force on the hub at a communication point.
    pub fn record_force(&mut self, t: f64, force: f64) {
        self.past.push((t, force));
        if self.past.len() > KEPT {
            self.past.remove(0);
        }
    }

    /// Integrates the hub from one time to another and returns the work of the extrapolated force [J].
    pub fn advance(&mut self, [from, to]: [f64; 2], extrapolation: Extrapolation) -> f64 {
        let course = StepPolynomial::through(&self.past, extrapolation);
        let h = (to - from) / f64::from(PARTS);
        let rate = |t: f64, [_, v, _]: [f64; 3]| {
            let force = course.value(t);
            [
                v,
                (force + self.frame.load(t, v)) / self.frame.inertia,
                force * v,
            ]
        };
        let mut x = [self.at[0], self.at[1], 0.0];
        for i in 0..PARTS {
            let t = from + h * f64::from(i);
            let plus = |c: f64, d: [f64; 3]| [0, 1, 2].map(|k| x[k] + c * h * d[k]);
            let a = rate(t, x);
            let b = rate(t + 0.5 * h, plus(0.5, a));
            let c = rate(t + 0.5 * h, plus(0.5, b));
            let d = rate(t + h, plus(1.0, c));
            x = [0, 1, 2].map(|k| x[k] + h / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]));
        }
        self.at = [x[0], x[1]];
        x[2]
    }
}
