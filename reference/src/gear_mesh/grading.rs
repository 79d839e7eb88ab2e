//! Graded subdivisions of the unit interval.

/// Returns the ends of `n` intervals of [0, 1], each `ratio` times as long as the previous one; `refine` = 2 also
/// gives their middles.
pub(super) fn geometric(n: usize, ratio: f64, refine: usize) -> Vec<f64> {
    let mut ends = Vec::with_capacity(n + 1);
    let (mut sum, mut size) = (0.0, 1.0);
    ends.push(0.0);
    for _ in 0..n {
        sum += size;
        size *= ratio;
        ends.push(sum);
    }
    for e in &mut ends {
        *e /= sum;
    }
    refined(&ends, refine)
}

/// Ends of `n` intervals of [0, 1] that are of equal length within `reach` of `place`, and beyond in proportion to the
/// distance: equal steps of the inverse hyperbolic sine of it.
pub(super) fn focused(n: usize, place: f64, reach: f64, refine: usize) -> Vec<f64> {
    let at = |x: f64| ((x - place) / reach).asinh();
    let (low, high) = (at(0.0), at(1.0));
    let ends: Vec<f64> = (0..=n)
        .map(|i| match i {
            0 => 0.0,
            i if i == n => 1.0,
            i => place + reach * (low + (high - low) * i as f64 / n as f64).sinh(),
        })
        .collect();
    refined(&ends, refine)
}

/// Inserts the middles when `refine` is 2.
pub(super) fn refined(ends: &[f64], refine: usize) -> Vec<f64> {
    if refine == 1 {
        return ends.to_vec();
    }
    let mut all = Vec::with_capacity(2 * ends.len() - 1);
    for pair in ends.windows(2) {
        all.push(pair[0]);
        all.push(0.5 * (pair[0] + pair[1]));
    }
    all.push(ends[ends.len() - 1]);
    all
}

/// Returns the ratio with which `n` intervals that begin with `first` fill the length `total`, limited to `bounds`.
pub(super) fn ratio_from_first(n: usize, first: f64, total: f64, bounds: (f64, f64)) -> f64 {
    let (mut lo, mut hi) = bounds;
    let sum = |q: f64| (0..n).fold((0.0, first), |(s, h), _| (s + h, h * q)).0;
    for _ in 0..60 {
        let mid = 0.5 * (lo + hi);
        if sum(mid) < total {
            lo = mid;
        } else {
            hi = mid;
        }
    }
    0.5 * (lo + hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_grow_by_the_ratio() {
        let g = geometric(3, 2.0, 1);
        assert_eq!(g, [0.0, 1.0 / 7.0, 3.0 / 7.0, 1.0]);
        let g = geometric(2, 3.0, 2);
        assert_eq!(g, [0.0, 0.125, 0.25, 0.625, 1.0]);
    }

    #[test]
    fn the_shortest_lie_about_the_place() {
        let g = focused(40, 0.6, 0.02, 1);
        assert!(g.is_sorted_by(|a, b| a < b) && (g[0], g[40]) == (0.0, 1.0));
        let lengths: Vec<f64> = g.windows(2).map(|w| w[1] - w[0]).collect();
        let shortest = (0..40).min_by(|a, b| lengths[*a].total_cmp(&lengths[*b]));
        let i = shortest.unwrap();
        assert!((0.5 * (g[i] + g[i + 1]) - 0.6).abs() < lengths[i]);
        // asinh(20) + asinh(30) in 40 steps.
        assert!((lengths[i] / (0.02 * 7.784 / 40.0) - 1.0).abs() < 0.01);
    }

    #[test]
    fn the_first_size_is_met() {
        let q = ratio_from_first(3, 1.0, 7.0, (0.5, 4.0));
        assert!((q - 2.0).abs() < 1e-12, "{q}");
        assert!((ratio_from_first(3, 1.0, 1e9, (0.5, 4.0)) - 4.0).abs() < 1e-12);
    }
}
