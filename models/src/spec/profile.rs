//! Functions of time: constant, ramp, table, harmonic, polynomial.
//!
//! A profile is piecewise linear in time, a constant with a harmonic on it, or a piece of a motion that a host sets. Its
//! breakpoints are reported, so that integrators land on them and a kink never lies inside a step.

use std::f64::consts::TAU;

/// A function of time: piecewise linear, or harmonic.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// A constant value.
    Constant(f64),
    /// A ramp: `from` until `start`, then linear to `to` at `end`, then constant.
    Ramp {
        /// Value before the ramp.
        from: f64,
        /// Value after the ramp.
        to: f64,
        /// Time at which the ramp starts [s].
        start: f64,
        /// Time at which the ramp ends [s].
        end: f64,
    },
    /// Values over time: constant before the first and after the last.
    Table(Table),
    /// A harmonic: `mean + amplitude cos(2 pi frequency t + phase)`.
    Harmonic {
        /// Mean value of the harmonic.
        mean: f64,
        /// Amplitude: half of peak to peak.
        amplitude: f64,
        /// Frequency of the harmonic [Hz], positive.
        frequency: f64,
        /// Phase at the time 0 [rad].
        phase: f64,
    },
    /// The derivative of `c0 + c1 s + c2 s^2 + c3 s^3`, `s = t - from`, at all times; its integral is that cubic. A
    /// host of a co-simulation sets such pieces.
    Polynomial {
        /// Time at which `s` is zero [s].
        from: f64,
        /// Coefficients `c0` to `c3` of the integral.
        integral: [f64; 4],
    },
}

/// Values over time, linear between them, with their integral at each of the times, so that no evaluation passes over
/// the whole table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Ascending times [s].
    time: Vec<f64>,
    value: Vec<f64>,
    /// Integral from the first time to each.
    integral: Vec<f64>,
}

impl Table {
    /// Creates a table from ascending times [s] and one value for each.
    pub fn new(time: Vec<f64>, value: Vec<f64>) -> Self {
        let mut sum = 0.0;
        let mut integral = Vec::with_capacity(time.len());
        integral.extend(time.first().map(|_| 0.0));
        for (t, x) in time.windows(2).zip(value.windows(2)) {
            sum += 0.5 * (x[0] + x[1]) * (t[1] - t[0]);
            integral.push(sum);
        }
        Table {
            time,
            value,
            integral,
        }
    }

    /// Returns the times [s].
    pub fn times(&self) -> &[f64] {
        &self.time
    }

    /// Returns the values at the times.
    pub fn values(&self) -> &[f64] {
        &self.value
    }

    fn problem(&self) -> Option<String> {
        let Table { time, value, .. } = self;
        if time.len() != value.len() || time.is_empty() {
            return Some(format!("{} times but {} values", time.len(), value.len()));
        }
        if !time.iter().chain(value).all(|x| x.is_finite()) {
            return Some("a table needs finite numbers".into());
        }
        time.windows(2)
            .find(|w| w[1] <= w[0])
            .map(|w| format!("times must ascend, but {} s follows {} s", w[1], w[0]))
    }

    /// Returns the number of times up to `t`.
    fn after(&self, t: f64) -> usize {
        self.time.partition_point(|&x| x <= t)
    }

    fn value(&self, t: f64) -> f64 {
        match self.after(t) {
            0 => self.value[0],
            // Also at infinity.
            i if i == self.time.len() => self.value[i - 1],
            i => self.value[i - 1] + self.slope_after(i) * (t - self.time[i - 1]),
        }
    }

    fn slope(&self, t: f64) -> f64 {
        match self.after(t) {
            0 => 0.0,
            i => self.slope_after(i),
        }
    }

    /// Returns the slope between the times `i - 1` and `i`; zero after the last.
    fn slope_after(&self, i: usize) -> f64 {
        match self.time.get(i) {
            Some(next) => (self.value[i] - self.value[i - 1]) / (next - self.time[i - 1]),
            None => 0.0,
        }
    }

    /// Returns the integral from the first time to `t`.
    fn integral(&self, t: f64) -> f64 {
        let (i, h) = match self.after(t) {
            0 => return self.value[0] * (t - self.time[0]),
            i => (i, t - self.time[i - 1]),
        };
        self.integral[i - 1] + h * (self.value[i - 1] + 0.5 * h * self.slope_after(i))
    }
}

impl Profile {
    /// Returns a table that is linear between ascending times [s].
    pub fn table(time: Vec<f64>, value: Vec<f64>) -> Self {
        Profile::Table(Table::new(time, value))
    }

    /// Returns the line through two values at two times.
    pub fn line([from, to]: [f64; 2], [start, end]: [f64; 2]) -> Self {
        let slope = (end - start) / (to - from);
        Profile::Polynomial {
            from,
            integral: [0.0, start, 0.5 * slope, 0.0],
        }
    }

    /// Returns the speed of the cubic motion through two positions with two speeds, `[position, speed]` at two times
    /// (Hermite).
    pub fn motion([from, to]: [f64; 2], start: [f64; 2], end: [f64; 2]) -> Self {
        let h = to - from;
        let mean = (end[0] - start[0]) / h;
        Profile::Polynomial {
            from,
            integral: [
                start[0],
                start[1],
                (3.0 * mean - 2.0 * start[1] - end[1]) / h,
                (start[1] + end[1] - 2.0 * mean) / (h * h),
            ],
        }
    }

    /// Returns true if the profile is piecewise linear in time.
    pub fn is_linear(&self) -> bool {
        match self {
            Profile::Harmonic { .. } => false,
            Profile::Polynomial { integral, .. } => integral[3] == 0.0,
            _ => true,
        }
    }

    /// Returns the problem of an invalid profile, if any.
    pub fn problem(&self) -> Option<String> {
        let finite = |x: &f64| x.is_finite();
        match self {
            Profile::Constant(x) => {
                (!x.is_finite()).then(|| format!("the value {x} is not a number"))
            }
            Profile::Ramp {
                from,
                to,
                start,
                end,
            } => {
                if ![from, to, start, end].into_iter().all(finite) {
                    Some("a ramp needs four finite numbers".into())
                } else {
                    (end <= start)
                        .then(|| format!("a ramp from {start} s to {end} s has no length"))
                }
            }
            Profile::Table(table) => table.problem(),
            Profile::Harmonic {
                mean,
                amplitude,
                frequency,
                phase,
            } => {
                if ![mean, amplitude, frequency, phase].into_iter().all(finite) {
                    Some("a harmonic needs finite numbers".into())
                } else {
                    (*frequency <= 0.0).then(|| {
                        format!("a harmonic has the frequency {frequency} Hz; expected more than 0")
                    })
                }
            }
            Profile::Polynomial { from, integral } => (!integral.iter().chain([from]).all(finite))
                .then(|| "a polynomial needs finite numbers".into()),
        }
    }

    /// Returns the value at time `t` [s].
    pub fn value(&self, t: f64) -> f64 {
        match self {
            Profile::Constant(x) => *x,
            Profile::Ramp {
                from,
                to,
                start,
                end,
            } => from + (to - from) * ((t - start) / (end - start)).clamp(0.0, 1.0),
            Profile::Table(table) => table.value(t),
            Profile::Harmonic {
                mean,
                amplitude,
                frequency,
                phase,
            } => mean + amplitude * (TAU * frequency * t + phase).cos(),
            Profile::Polynomial {
                from,
                integral: [_, a, b, c],
            } => {
                let s = t - from;
                a + s * (2.0 * b + s * 3.0 * c)
            }
        }
    }

    /// Returns the mean after the last breakpoint: the value of a constant, the end of a ramp or table, the mean of a
    /// harmonic, the start of a polynomial.
    pub fn settled(&self) -> f64 {
        match self {
            Profile::Harmonic { mean, .. } => *mean,
            Profile::Polynomial { integral, .. } => integral[1],
            linear => linear.value(f64::INFINITY),
        }
    }

    /// Returns the largest magnitude at any time; for a polynomial that at its start.
    pub fn greatest(&self) -> f64 {
        match self {
            Profile::Constant(x) => x.abs(),
            Profile::Ramp { from, to, .. } => from.abs().max(to.abs()),
            Profile::Table(table) => table.value.iter().fold(0.0, |m, x| x.abs().max(m)),
            Profile::Harmonic {
                mean, amplitude, ..
            } => mean.abs() + amplitude.abs(),
            Profile::Polynomial { integral, .. } => integral[1].abs(),
        }
    }

    /// Returns the profile multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        match &mut scaled {
            Profile::Constant(x) => *x *= factor,
            Profile::Ramp { from, to, .. } => {
                *from *= factor;
                *to *= factor;
            }
            Profile::Table(table) => {
                let all = table.value.iter_mut().chain(&mut table.integral);
                all.for_each(|x| *x *= factor);
            }
            Profile::Harmonic {
                mean, amplitude, ..
            } => {
                *mean *= factor;
                *amplitude *= factor;
            }
            Profile::Polynomial { integral, .. } => integral.iter_mut().for_each(|x| *x *= factor),
        }
        scaled
    }

    /// Returns true if the value is constant from `t` until the next breakpoint.
    pub fn is_steady(&self, t: f64) -> bool {
        match self {
            Profile::Harmonic { amplitude, .. } => *amplitude == 0.0,
            Profile::Polynomial { integral, .. } => integral[2..] == [0.0; 2],
            linear => linear.slope(t) == 0.0,
        }
    }

    /// Returns the integral from 0 to `t`, exact; for a polynomial its own integral.
    pub fn integral(&self, t: f64) -> f64 {
        if let Profile::Harmonic {
            mean,
            amplitude,
            frequency,
            phase,
        } = self
        {
            let omega = TAU * frequency;
            return mean * t + amplitude / omega * ((omega * t + phase).sin() - phase.sin());
        }
        if let Profile::Polynomial {
            from,
            integral: [a, b, c, d],
        } = self
        {
            let s = t - from;
            return a + s * (b + s * (c + s * d));
        }
        if let Profile::Table(table) = self {
            return table.integral(t) - table.integral(0.0);
        }
        // Breakpoints up to t, then the trapezoid rule, which is exact between breakpoints.
        let mut sum = 0.0;
        let mut a = 0.0_f64.min(t);
        let b = 0.0_f64.max(t);
        while a < b {
            let next = self.next_breakpoint(a).min(b);
            sum += 0.5 * (next - a) * (self.value(a) + self.value(next));
            a = next;
        }
        if t < 0.0 { -sum } else { sum }
    }

    /// Returns the slope just after `t`.
    pub fn slope(&self, t: f64) -> f64 {
        match self {
            Profile::Constant(_) => 0.0,
            Profile::Ramp {
                from,
                to,
                start,
                end,
            } if (*start..*end).contains(&t) => (to - from) / (end - start),
            Profile::Ramp { .. } => 0.0,
            Profile::Table(table) => table.slope(t),
            Profile::Harmonic {
                amplitude,
                frequency,
                phase,
                ..
            } => {
                let omega = TAU * frequency;
                -amplitude * omega * (omega * t + phase).sin()
            }
            Profile::Polynomial {
                from,
                integral: [_, _, c, d],
            } => 2.0 * c + 6.0 * d * (t - from),
        }
    }

    /// Returns the next breakpoint after `t` [s], or infinity.
    pub fn next_breakpoint(&self, t: f64) -> f64 {
        match self {
            Profile::Constant(_) | Profile::Harmonic { .. } | Profile::Polynomial { .. } => {
                f64::INFINITY
            }
            Profile::Ramp { start, end, .. } => [*start, *end]
                .into_iter()
                .find(|&k| k > t)
                .unwrap_or(f64::INFINITY),
            Profile::Table(table) => (table.time.get(table.after(t)))
                .copied()
                .unwrap_or(f64::INFINITY),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integral_is_exact_over_kinks() {
        let p = Profile::table(vec![1.0, 2.0, 4.0], vec![0.0, 3.0, -1.0]);
        // 0 until 1, triangle 1.5 to 2, then (3 - 1)/2 * 2 = 2 to 4, then -1 per second.
        assert!((p.integral(5.0) - (1.5 + 2.0 - 1.0)).abs() < 1e-14);
        assert_eq!(p.next_breakpoint(1.0), 2.0);
        assert_eq!(p.next_breakpoint(4.0), f64::INFINITY);
        assert_eq!((p.settled(), p.value(0.0), p.value(3.0)), (-1.0, 0.0, 1.0));
        // A table that begins before time 0 counts from there, and backwards with the other sign.
        let early = Profile::table(vec![-2.0, 2.0], vec![0.0, 4.0]);
        assert!((early.integral(1.0) - 2.5).abs() < 1e-14);
        assert!((early.integral(-1.0) + 1.5).abs() < 1e-14);
        let r = Profile::Ramp {
            from: 2.0,
            to: 4.0,
            start: 1.0,
            end: 3.0,
        };
        assert!((r.integral(3.0) - (2.0 + 6.0)).abs() < 1e-14);
        assert_eq!(r.value(2.0), 3.0);
    }

    #[test]
    fn a_harmonic_is_the_derivative_of_its_integral() {
        let p = Profile::Harmonic {
            mean: 2.0,
            amplitude: 3.0,
            frequency: 50.0,
            phase: 0.4,
        };
        let h = 1e-6;
        for t in [0.0, 1e-3, 0.0173, 2.0] {
            let rate = (p.integral(t + h) - p.integral(t - h)) / (2.0 * h);
            assert!((rate - p.value(t)).abs() < 1e-6, "{rate}");
            let slope = (p.value(t + h) - p.value(t - h)) / (2.0 * h);
            assert!((slope - p.slope(t)).abs() < 1e-4 * 942.0, "{slope}");
        }
        assert_eq!(
            (p.integral(0.0), p.settled(), p.greatest()),
            (0.0, 2.0, 5.0)
        );
        // Its slope is zero now and then; it is never steady.
        let still = Profile::Harmonic {
            mean: 1.0,
            amplitude: 1.0,
            frequency: 1.0,
            phase: 0.0,
        };
        assert!(still.slope(0.0) == 0.0 && !still.is_steady(0.0));
    }

    #[test]
    fn a_motion_goes_through_both_ends() {
        let (start, end) = ([0.3, -2.0], [0.1, 5.0]);
        let p = Profile::motion([0.5, 0.7], start, end);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        for (t, [place, speed]) in [(0.5, start), (0.7, end)] {
            near(p.integral(t), place);
            near(p.value(t), speed);
        }
        let h = 1e-6;
        // Rounding over the step, and the third derivative times its square.
        let speed = (p.integral(0.6 + h) - p.integral(0.6 - h)) / (2.0 * h);
        assert!((speed - p.value(0.6)).abs() < 1e-8);
        assert!(((p.value(0.6 + h) - p.value(0.6 - h)) / (2.0 * h) - p.slope(0.6)).abs() < 1e-6);
        assert!(!p.is_linear() && !p.is_steady(0.6));
        let line = Profile::line([0.5, 0.7], [4.0, -6.0]);
        near(line.value(0.5), 4.0);
        near(line.value(0.7), -6.0);
        near(line.slope(0.6), -50.0);
        assert!(line.is_linear() && !line.is_steady(0.5));
    }

    #[test]
    fn names_what_is_wrong() {
        let p = Profile::table(vec![0.0, 0.0], vec![1.0, 2.0]);
        assert!(p.problem().unwrap().contains("ascend"));
        assert!(Profile::Constant(f64::NAN).problem().is_some());
        assert!(Profile::Constant(1.0).problem().is_none());
    }
}
