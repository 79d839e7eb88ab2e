//! Polynomials over a communication step: forces extrapolated through their last values, displacements interpolated
//! between two.

use clap::ValueEnum;
use std::fmt;

/// Extrapolation of the forces on the hubs over a communication step, by the host.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Extrapolation {
    /// The last value is constant over the step
    Constant,
    /// The line through the last two values
    Linear,
    /// The parabola through the last three values
    #[default]
    Quadratic,
}

impl Extrapolation {
    /// All extrapolations, the lowest degree first.
    pub const ALL: [Self; 3] = [Self::Constant, Self::Linear, Self::Quadratic];

    /// Returns the word of the extrapolation.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Linear => "linear",
            Self::Quadratic => "quadratic",
        }
    }
}

impl fmt::Display for Extrapolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Interpolation of the hubs' motion between two communication points, by the gears.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Motion {
    /// The straight line between both positions
    #[default]
    Linear,
    /// The cubic through both positions with both velocities
    Cubic,
}

impl Motion {
    /// All interpolations.
    #[cfg(test)]
    pub const ALL: [Self; 2] = [Self::Linear, Self::Cubic];

    /// Returns the word of the interpolation.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Cubic => "cubic",
        }
    }
}

impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Polynomial `c0 + c1 s + c2 s^2 + c3 s^3` of `s = t - from`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepPolynomial {
    /// Time at which `s` is zero [s].
    pub from: f64,
    /// Coefficients of the cubic in `s`, constant term first.
    pub c: [f64; 4],
}

impl StepPolynomial {
    /// Returns the value of the polynomial at time `t` [s].
    pub fn value(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.c;
        let s = t - self.from;
        a + s * (b + s * (c + s * d))
    }

    /// Returns the second derivative of the polynomial at time `t` [s].
    pub fn acceleration(&self, t: f64) -> f64 {
        2.0 * self.c[2] + 6.0 * self.c[3] * (t - self.from)
    }

    /// Returns the polynomial through the last values `(t, value)`, the newest last; its degree is that of the
    /// extrapolation, or less with fewer values.
    pub fn through(past: &[(f64, f64)], extrapolation: Extrapolation) -> StepPolynomial {
        let terms = match extrapolation {
            Extrapolation::Constant => 1,
            Extrapolation::Linear => 2,
            Extrapolation::Quadratic => 3,
        };
        let last = &past[past.len().saturating_sub(terms)..];
        let slope = |a: &(f64, f64), b: &(f64, f64)| (b.1 - a.1) / (b.0 - a.0);
        // Newton's form from the newest value on.
        let (from, c) = match last {
            [] => (0.0, [0.0; 4]),
            [a] => (a.0, [a.1, 0.0, 0.0, 0.0]),
            [a, b] => (b.0, [b.1, slope(a, b), 0.0, 0.0]),
            [.., a, b, c] => {
                let second = (slope(b, c) - slope(a, b)) / (c.0 - a.0);
                (c.0, [c.1, slope(b, c) + (c.0 - b.0) * second, second, 0.0])
            }
        };
        StepPolynomial { from, c }
    }

    /// Returns the polynomial from one `[place, speed]` to another over a time `h` [s].
    pub fn between(from: f64, h: f64, [a, b]: [[f64; 2]; 2], motion: Motion) -> StepPolynomial {
        let mean = (b[0] - a[0]) / h;
        let c = match motion {
            Motion::Linear => [a[0], mean, 0.0, 0.0],
            Motion::Cubic => [
                a[0],
                a[1],
                (3.0 * mean - 2.0 * a[1] - b[1]) / h,
                (a[1] + b[1] - 2.0 * mean) / (h * h),
            ],
        };
        StepPolynomial { from, c }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_met_exactly_at_uneven_times() {
        let f = |t: f64| 2.0 - 3.0 * t + 0.5 * t * t;
        let past: Vec<(f64, f64)> = [0.0, 0.4, 1.0, 1.3].map(|t| (t, f(t))).to_vec();
        let course = StepPolynomial::through(&past, Extrapolation::Quadratic);
        let line = StepPolynomial::through(&past, Extrapolation::Linear);
        let held = StepPolynomial::through(&past, Extrapolation::Constant);
        for t in [1.3, 1.7, 2.5] {
            assert!((course.value(t) - f(t)).abs() < 1e-13);
            let secant = f(1.3) + (t - 1.3) * (f(1.3) - f(1.0)) / 0.3;
            assert!((line.value(t) - secant).abs() < 1e-13);
            assert_eq!(held.value(t), f(1.3));
        }
        // With fewer values than the order needs, the order is reduced.
        assert_eq!(
            StepPolynomial::through(&past[..1], Extrapolation::Quadratic).c,
            [2.0, 0.0, 0.0, 0.0]
        );
        assert_eq!(
            StepPolynomial::through(&[], Extrapolation::Linear).value(1.0),
            0.0
        );
    }

    #[test]
    fn motions_end_where_they_should() {
        let (from, h, ends) = (0.2, 0.3, [[1.0, -2.0], [1.5, 4.0]]);
        for motion in Motion::ALL {
            let course = StepPolynomial::between(from, h, ends, motion);
            assert!((course.value(from) - 1.0).abs() < 1e-14);
            assert!((course.value(from + h) - 1.5).abs() < 1e-14);
        }
        let cubic = StepPolynomial::between(from, h, ends, Motion::Cubic);
        let d = 1e-5;
        let speed = |t: f64| (cubic.value(t + d) - cubic.value(t - d)) / (2.0 * d);
        assert!((speed(from) + 2.0).abs() < 1e-7 && (speed(from + h) - 4.0).abs() < 1e-7);
        let second =
            (cubic.value(0.3 + d) - 2.0 * cubic.value(0.3) + cubic.value(0.3 - d)) / (d * d);
        assert!((second - cubic.acceleration(0.3)).abs() < 1e-4);
    }
}
