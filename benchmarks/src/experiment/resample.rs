//! Interpolation of histories at other abscissae, linear or cubic.

/// Interpolates linearly between samples at ascending abscissae.
pub fn resample(x: &[f64], y: &[f64], at: &[f64]) -> Vec<f64> {
    let mut i = 0;
    at.iter()
        .map(|&a| {
            while i + 2 < x.len() && x[i + 1] < a {
                i += 1;
            }
            let w = (a - x[i]) / (x[i + 1] - x[i]);
            y[i] + w * (y[i + 1] - y[i])
        })
        .collect()
}

/// Interpolates by the cubic through the four samples around each abscissa; for histories without jumps.
pub fn resample_smooth(x: &[f64], y: &[f64], at: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n < 4 {
        return resample(x, y, at);
    }
    let mut i = 0;
    at.iter()
        .map(|&a| {
            while i + 4 < n && x[i + 2] < a {
                i += 1;
            }
            // Differences from one sample: what they have in common would cost digits.
            let (x, y) = (&x[i..i + 4], &y[i..i + 4]);
            let term = |k: usize| {
                let others = (0..4).filter(|j| *j != k);
                others.fold(y[k] - y[1], |p, j| p * (a - x[j]) / (x[k] - x[j]))
            };
            y[1] + term(0) + term(2) + term(3)
        })
        .collect()
}
