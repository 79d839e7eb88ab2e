//! A force history as metrics take it: peak, impulse, duration, and the shift at which it fits another best.

use crate::series::TimeSeries;

/// The finite, well-formed part of a force history.
pub(super) struct Force<'a> {
    pub t: &'a [f64],
    pub y: &'a [f64],
}

impl<'a> Force<'a> {
    pub fn of(series: &'a TimeSeries) -> Self {
        let (t, y) = (&series.time_s, &series.contact_force_n);
        let n = (t.iter().zip(y))
            .position(|(t, y)| !(t.is_finite() && y.is_finite()))
            .unwrap_or(t.len().min(y.len()));
        Self {
            t: &t[..n],
            y: &y[..n],
        }
    }

    /// The samples up to a time \[s\].
    pub fn until(self, end: f64) -> Self {
        let n = self.t.partition_point(|&t| t <= end);
        Self {
            t: &self.t[..n],
            y: &self.y[..n],
        }
    }

    pub fn peak(&self) -> (f64, usize) {
        let mut best = (0.0, 0);
        for (i, &y) in self.y.iter().enumerate() {
            if y > best.0 {
                best = (y, i);
            }
        }
        best
    }

    fn segments(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        (self.t.windows(2).zip(self.y.windows(2))).map(|(t, y)| (t[1] - t[0], y[0], y[1]))
    }

    pub fn impulse(&self) -> f64 {
        self.segments().map(|(h, a, b)| 0.5 * h * (a + b)).sum()
    }

    /// Centroid of the force in time.
    fn centroid(&self) -> f64 {
        let moment: f64 = (self.t.windows(2).zip(self.segments()))
            .map(|(t, (h, a, b))| h * (t[0] * (2.0 * a + b) + t[1] * (a + 2.0 * b)) / 6.0)
            .sum();
        moment / self.impulse()
    }

    /// Time in which the piecewise linear force exceeds `level`.
    pub fn time_above(&self, level: f64) -> f64 {
        self.segments()
            .map(|(h, a, b)| match (a > level, b > level) {
                (true, true) => h,
                (true, false) => h * (a - level) / (a - b),
                (false, true) => h * (b - level) / (b - a),
                (false, false) => 0.0,
            })
            .sum()
    }

    /// Width of the highest peak at half its height.
    fn half_width(&self) -> f64 {
        let (peak, at) = self.peak();
        let below = |&i: &usize| self.y[i] < 0.5 * peak;
        let left = (0..at).rev().find(below).unwrap_or(0);
        let right = (at..self.t.len())
            .find(below)
            .unwrap_or(self.t.len().saturating_sub(1));
        self.t[right] - self.t[left]
    }
}

/// Coarse scan about each guess (no shift, equal centroids, equal peaks), then golden section.
pub(super) fn best_shift(
    run: &Force<'_>,
    target: &Force<'_>,
    error: &mut dyn FnMut(f64) -> f64,
) -> (f64, f64) {
    const SCAN: i32 = 32;
    let width = target.half_width();
    let step = 2.0 * width / f64::from(SCAN);
    let mut best = (0.0, error(0.0));
    if !(step.is_finite() && step > 0.0) {
        return best;
    }
    let peaks = target.t[target.peak().1] - run.t[run.peak().1];
    for guess in [0.0, target.centroid() - run.centroid(), peaks] {
        if !guess.is_finite() {
            continue;
        }
        for k in -SCAN..=SCAN {
            let shift = guess + f64::from(k) * step;
            let e = error(shift);
            if e < best.1 {
                best = (shift, e);
            }
        }
    }
    let refined = golden_section(best.0 - step, best.0 + step, error);
    if refined.1 < best.1 { refined } else { best }
}

fn golden_section(mut a: f64, mut b: f64, f: &mut dyn FnMut(f64) -> f64) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_8;
    let (mut c, mut d) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    for _ in 0..60 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - RATIO * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + RATIO * (b - a);
            fd = f(d);
        }
    }
    if fc < fd { (c, fc) } else { (d, fd) }
}

pub(super) fn trapezoid_weights(t: &[f64]) -> Vec<f64> {
    let mut weights = vec![0.0; t.len()];
    for i in 1..t.len() {
        let half = 0.5 * (t[i] - t[i - 1]);
        weights[i - 1] += half;
        weights[i] += half;
    }
    weights
}

pub(super) fn last_finite(values: &[f64]) -> Option<f64> {
    values.iter().rev().copied().find(|x| x.is_finite())
}
