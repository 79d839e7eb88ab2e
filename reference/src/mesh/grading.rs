//! Graded subdivisions of the unit interval.

/// Ends of `n` intervals of [0, 1], each `ratio` times as long as the one before; `refine` = 2 also gives
/// their middles.
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

/// Ratio with which `n` intervals that begin with `first` fill the length `total`, held within `bounds`.
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
    fn the_first_size_is_met() {
        let q = ratio_from_first(3, 1.0, 7.0, (0.5, 4.0));
        assert!((q - 2.0).abs() < 1e-12, "{q}");
        assert!((ratio_from_first(3, 1.0, 1e9, (0.5, 4.0)) - 4.0).abs() < 1e-12);
    }
}
