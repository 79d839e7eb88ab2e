//! Deviation of a flank from the involute along its path, for gaps and their slopes.

/// Deviation of one gear's flank over its own path coordinate, sampled once.
#[derive(Clone, Debug)]
pub struct Deviation {
    start: f64,
    step: f64,
    value: Vec<f64>,
}

impl Deviation {
    /// Samples `e(s)` [m] on `[start, end]`.
    pub fn sample(range: [f64; 2], samples: usize, e: impl Fn(f64) -> f64) -> Self {
        let step = (range[1] - range[0]) / (samples - 1) as f64;
        let value = (0..samples)
            .map(|i| e(range[0] + i as f64 * step))
            .collect();
        Deviation {
            start: range[0],
            step,
            value,
        }
    }

    /// A value that the deviation does not fall below, on its path and a tenth of it beyond both ends.
    pub fn lowest(&self) -> f64 {
        let n = self.value.len();
        let span = self.step * (n - 1) as f64;
        let beyond = [-0.1, 1.1].map(|x| self.eval(self.start + x * span).0);
        let all = || self.value.iter().chain(&beyond).copied();
        let (low, high) = (
            all().fold(f64::INFINITY, f64::min),
            all().fold(0.0, f64::max),
        );
        // What a cubic swings below its samples is a part of the largest step between them.
        let step = (self.value.windows(2).map(|w| (w[1] - w[0]).abs())).fold(0.0, f64::max);
        (low - 0.5 * step).max(low - (high - low))
    }

    /// Value and slope at `s`; cubic between samples (Catmull-Rom) and straight on outside, so the slope is
    /// continuous: a flank that is short of the other's tip by the gap reaches a little beyond its path.
    #[inline]
    pub fn eval(&self, s: f64) -> (f64, f64) {
        let n = self.value.len();
        let last = (n - 1) as f64;
        let x = (s - self.start) / self.step;
        let line = |i: usize, from: f64| {
            let rise = self.value[i + 1] - self.value[i];
            (self.value[i] + (x - from) * rise, rise / self.step)
        };
        if x <= 0.0 {
            return line(0, 0.0);
        }
        if x >= last {
            return line(n - 2, last - 1.0);
        }
        let i = x as usize;
        let u = x - i as f64;
        let (p1, p2) = (self.value[i], self.value[i + 1]);
        let p0 = if i > 0 {
            self.value[i - 1]
        } else {
            2.0 * p1 - p2
        };
        let p3 = if i + 2 < n {
            self.value[i + 2]
        } else {
            2.0 * p2 - p1
        };
        let (m1, m2) = (0.5 * (p2 - p0), 0.5 * (p3 - p1));
        let (d, r) = (p2 - p1, 1.0 - u);
        let value = p1 + u * d + u * r * (r * (m1 - d) - u * (m2 - d));
        let slope = d + r * (1.0 - 3.0 * u) * (m1 - d) + u * (2.0 - 3.0 * u) * (d - m2);
        (value, slope / self.step)
    }
}
