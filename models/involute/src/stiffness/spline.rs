//! Interpolated values along the path of contact, evaluated in constant time without allocation.
//!
//! Between knots the curve is a cubic, twice continuously differentiable, or a straight line; outside
//! its range it is held at the end values (slope zero), or continued periodically. The slopes `m_i` at
//! the knots of the cubic solve the usual tridiagonal system of the interpolating spline,
//!
//! ```text
//! m_(i-1)/h_(i-1) + 2 (1/h_(i-1) + 1/h_i) m_i + m_(i+1)/h_i = 3 (D_(i-1)/h_(i-1) + D_i/h_i)
//! ```
//!
//! with `D_i` the divided differences; the end slopes are those of the cubic through the four
//! outermost points. (C. de Boor, A Practical Guide to Splines, ch. IV.)

use super::error::StiffnessError;

/// Continuation outside the knots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ends {
    /// Constant continuation by the end values.
    #[default]
    Clamped,
    /// Periodic continuation with the period `s_last - s_first`; first and last value must agree.
    Periodic,
}

/// Interpolation between the knots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Cubic spline with continuous second derivative.
    #[default]
    Cubic,
    /// Straight lines; the slope jumps at every knot.
    Linear,
}

/// Values of any unit over the path coordinate `s` (m).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Spline {
    ends: Ends,
    range: [f64; 2],
    pieces: Vec<Piece>,
    last: f64,
    /// Index of the interval at the start of each of equally wide buckets; empty when the intervals are equal.
    buckets: Vec<u32>,
    buckets_per_metre: f64,
}

/// Cubic piece `k = c0 + u (c1 + u (c2 + u c3))`, `u = s - begin`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    begin: f64,
    end: f64,
    c: [f64; 4],
}

impl Spline {
    /// Returns a constant curve.
    pub(super) fn constant(value: f64) -> Spline {
        Spline {
            ends: Ends::Clamped,
            range: [0.0; 2],
            pieces: Vec::new(),
            last: value,
            buckets: Vec::new(),
            buckets_per_metre: 0.0,
        }
    }

    /// Interpolates `k` at the increasing path coordinates `s` (m).
    ///
    /// # Errors
    /// [`StiffnessError`] when lengths differ, fewer than two points are given, `s` does not increase,
    /// or a value is not finite.
    pub(super) fn interpolate(
        s: &[f64],
        k: &[f64],
        ends: Ends,
        interpolation: Interpolation,
    ) -> Result<Spline, StiffnessError> {
        check_points(s, k, ends)?;
        let n = s.len() - 1;
        let slopes = match interpolation {
            Interpolation::Cubic => spline_slopes(s, k, ends),
            Interpolation::Linear => Vec::new(),
        };
        let pieces: Vec<Piece> = (0..n)
            .map(|i| {
                let h = s[i + 1] - s[i];
                let d = (k[i + 1] - k[i]) / h;
                let c = if slopes.is_empty() {
                    [k[i], d, 0.0, 0.0]
                } else {
                    let (m0, m1) = (slopes[i], slopes[i + 1]);
                    let c2 = (3.0 * d - 2.0 * m0 - m1) / h;
                    [k[i], m0, c2, (m0 + m1 - 2.0 * d) / (h * h)]
                };
                Piece {
                    begin: s[i],
                    end: s[i + 1],
                    c,
                }
            })
            .collect();
        let length = s[n] - s[0];
        let step = length / n as f64;
        let equal = s
            .iter()
            .enumerate()
            .all(|(i, x)| (x - s[0] - i as f64 * step).abs() < 1e-12 * length);
        // Eight buckets per interval keep the walk from a bucket to its interval short for any usual
        // table; equal intervals need neither.
        let count = if equal { n } else { 8 * n };
        let buckets_per_metre = count as f64 / length;
        let mut interval = 0;
        let buckets = (0..if equal { 0 } else { count })
            .map(|b| {
                let begin = s[0] + b as f64 / buckets_per_metre;
                while interval + 1 < n && s[interval + 1] <= begin {
                    interval += 1;
                }
                interval as u32
            })
            .collect();
        Ok(Spline {
            ends,
            range: [s[0], s[n]],
            pieces,
            last: k[n],
            buckets,
            buckets_per_metre,
        })
    }

    /// Returns true if the value is constant.
    pub(super) fn is_constant(&self) -> bool {
        self.pieces.is_empty()
    }

    /// Returns the range of path coordinates (m) in which the curve varies; `None` for a constant one.
    pub(super) fn range(&self) -> Option<[f64; 2]> {
        (!self.is_constant()).then_some(self.range)
    }

    /// Returns value and slope per metre at `s` (m), in constant time without allocation.
    #[inline]
    pub(super) fn eval(&self, s: f64) -> (f64, f64) {
        let Some(first) = self.pieces.first() else {
            return (self.last, 0.0);
        };
        let [start, end] = self.range;
        let mut s = s;
        if s < start || s > end {
            match self.ends {
                Ends::Clamped if s < start => return (first.c[0], 0.0),
                Ends::Clamped => return (self.last, 0.0),
                Ends::Periodic => s = start + (s - start).rem_euclid(end - start),
            }
        }
        // The cast saturates, and turns NaN into 0: NaN then comes out of the polynomial.
        let bucket = ((s - start) * self.buckets_per_metre) as i32 as usize;
        let i = if self.buckets.is_empty() {
            // Equal intervals. Rounding may name a neighbour just beside a knot, where both agree.
            bucket.min(self.pieces.len() - 1)
        } else {
            let mut i = self.buckets[bucket.min(self.buckets.len() - 1)] as usize;
            while i + 1 < self.pieces.len() && s >= self.pieces[i].end {
                i += 1;
            }
            i
        };
        let Piece {
            begin,
            c: [c0, c1, c2, c3],
            ..
        } = &self.pieces[i];
        let u = s - begin;
        (
            c0 + u * (c1 + u * (c2 + u * c3)),
            c1 + u * (2.0 * c2 + u * 3.0 * c3),
        )
    }

    /// Returns the smallest value as (position in m, value).
    pub(super) fn minimum(&self) -> (f64, f64) {
        self.extreme(|a, b| a < b)
    }

    /// Returns the largest value as (position in m, value).
    pub(super) fn maximum(&self) -> (f64, f64) {
        self.extreme(|a, b| a > b)
    }

    /// Returns the extreme value over all knots and all stationary points of the cubics.
    fn extreme(&self, better: impl Fn(f64, f64) -> bool) -> (f64, f64) {
        let mut best = (self.range[1], self.last);
        for piece in &self.pieces {
            let [c0, c1, c2, c3] = piece.c;
            let h = piece.end - piece.begin;
            let root = (c2 * c2 - 3.0 * c1 * c3).max(0.0).sqrt();
            // Roots of c1 + 2 c2 u + 3 c3 u^2, both forms to stay clear of c3 = 0 and cancellation.
            let q = -(c2 + root.copysign(c2));
            for u in [0.0, q / (3.0 * c3), c1 / q] {
                if (0.0..=h).contains(&u) {
                    let k = c0 + u * (c1 + u * (c2 + u * c3));
                    if better(k, best.1) {
                        best = (piece.begin + u, k);
                    }
                }
            }
        }
        best
    }
}

fn check_points(s: &[f64], k: &[f64], ends: Ends) -> Result<(), StiffnessError> {
    let refuse = |reason: String| Err(StiffnessError::Table { reason });
    if s.len() != k.len() {
        return refuse(format!(
            "{} path coordinates but {} values; give one value per coordinate",
            s.len(),
            k.len()
        ));
    }
    if s.len() < 2 {
        return refuse(format!("{} points; give two or more", s.len()));
    }
    if let Some(i) = s.iter().position(|x| !x.is_finite()) {
        return refuse(format!("s[{i}] is {}; give finite coordinates", s[i]));
    }
    if let Some(i) = s.windows(2).position(|w| w[1] <= w[0]) {
        return refuse(format!(
            "s[{}] = {} does not exceed s[{i}] = {}; sort the points and drop doubles",
            i + 1,
            s[i + 1],
            s[i]
        ));
    }
    if let Some(i) = k.iter().position(|x| !x.is_finite()) {
        return refuse(format!("value {i} is {}; give finite values", k[i]));
    }
    let (first, last) = (k[0], k[k.len() - 1]);
    if ends == Ends::Periodic && (first - last).abs() > 1e-9 * first.abs() {
        return refuse(format!(
            "periodic, but the first value {first} and the last {last} differ"
        ));
    }
    Ok(())
}

/// Returns the slopes at the knots of the interpolating cubic spline.
fn spline_slopes(s: &[f64], k: &[f64], ends: Ends) -> Vec<f64> {
    let n = s.len() - 1;
    let h: Vec<f64> = s.windows(2).map(|w| w[1] - w[0]).collect();
    let d: Vec<f64> = (0..n).map(|i| (k[i + 1] - k[i]) / h[i]).collect();
    if n == 1 {
        return if ends == Ends::Periodic {
            vec![0.0; 2]
        } else {
            vec![d[0]; 2]
        };
    }
    if ends == Ends::Periodic {
        return periodic_slopes(&h, &d);
    }
    let mut m = vec![0.0; n + 1];
    let points = s.len().min(4);
    m[0] = end_slope(&s[..points], &k[..points], 0);
    m[n] = end_slope(&s[s.len() - points..], &k[s.len() - points..], points - 1);
    let interior = n - 1;
    let diagonal: Vec<f64> = (1..n)
        .map(|i| 2.0 * (1.0 / h[i - 1] + 1.0 / h[i]))
        .collect();
    let off: Vec<f64> = (1..n - 1).map(|i| 1.0 / h[i]).collect();
    let mut rhs: Vec<f64> = (1..n)
        .map(|i| 3.0 * (d[i - 1] / h[i - 1] + d[i] / h[i]))
        .collect();
    rhs[0] -= m[0] / h[0];
    rhs[interior - 1] -= m[n] / h[n - 1];
    solve_symmetric_tridiagonal(&diagonal, &off, &mut rhs);
    m[1..n].copy_from_slice(&rhs);
    m
}

/// Returns the slope at point `at` of the polynomial through all points (Lagrange).
fn end_slope(s: &[f64], k: &[f64], at: usize) -> f64 {
    let mut slope = 0.0;
    for j in 0..s.len() {
        if j == at {
            for i in (0..s.len()).filter(|&i| i != at) {
                slope += k[j] / (s[at] - s[i]);
            }
        } else {
            let mut term = k[j] / (s[j] - s[at]);
            for i in (0..s.len()).filter(|&i| i != j && i != at) {
                term *= (s[at] - s[i]) / (s[j] - s[i]);
            }
            slope += term;
        }
    }
    slope
}

/// Solves for the slopes of a periodic spline by Sherman-Morrison on the cyclic system; `n >= 2` intervals.
fn periodic_slopes(h: &[f64], d: &[f64]) -> Vec<f64> {
    let n = h.len();
    let before = |i: usize| (i + n - 1) % n;
    let mut diagonal: Vec<f64> = (0..n)
        .map(|i| 2.0 * (1.0 / h[before(i)] + 1.0 / h[i]))
        .collect();
    let mut rhs: Vec<f64> = (0..n)
        .map(|i| 3.0 * (d[before(i)] / h[before(i)] + d[i] / h[i]))
        .collect();
    let mut off: Vec<f64> = (0..n - 1).map(|i| 1.0 / h[i]).collect();
    let corner = 1.0 / h[n - 1];
    if n == 2 {
        // Both neighbours of a knot are the same one.
        off[0] += corner;
        solve_symmetric_tridiagonal(&diagonal, &off, &mut rhs);
    } else {
        diagonal[0] -= corner;
        diagonal[n - 1] -= corner;
        let mut ones = vec![0.0; n];
        ones[0] = 1.0;
        ones[n - 1] = 1.0;
        solve_symmetric_tridiagonal(&diagonal, &off, &mut rhs);
        solve_symmetric_tridiagonal(&diagonal, &off, &mut ones);
        let factor = corner * (rhs[0] + rhs[n - 1]) / (1.0 + corner * (ones[0] + ones[n - 1]));
        for i in 0..n {
            rhs[i] -= factor * ones[i];
        }
    }
    rhs.push(rhs[0]);
    rhs
}

/// Solves by the Thomas algorithm; the systems here are strictly diagonally dominant, so that no pivoting is needed.
fn solve_symmetric_tridiagonal(diagonal: &[f64], off: &[f64], rhs: &mut [f64]) {
    let n = diagonal.len();
    let mut pivots = diagonal.to_vec();
    for i in 1..n {
        let w = off[i - 1] / pivots[i - 1];
        pivots[i] -= w * off[i - 1];
        rhs[i] -= w * rhs[i - 1];
    }
    rhs[n - 1] /= pivots[n - 1];
    for i in (0..n - 1).rev() {
        rhs[i] = (rhs[i] - off[i] * rhs[i + 1]) / pivots[i];
    }
}

#[cfg(test)]
#[path = "spline_tests.rs"]
mod tests;
