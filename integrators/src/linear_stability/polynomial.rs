//! Stability polynomials: `|R(z)|` and the step at which a ray `h lambda` first leaves `|R| <= 1`.

/// Value of `|R| - 1` that counts as growth: above rounding, and below the growth over one part in ten thousand of the
/// step where growth is slowest, beyond the limit of Dormand-Prince on the imaginary axis.
const GROWTH: f64 = 1e-9;
/// Distance of samples along the ray in `|z|`.
const LOOK: f64 = 0.01;

/// Computes `|R(z)|` for coefficients from order zero on, `z = [re, im]`.
#[must_use]
pub fn modulus(coefficients: &[f64], [re, im]: [f64; 2]) -> f64 {
    let (mut x, mut y) = (0.0, 0.0);
    for c in coefficients.iter().rev() {
        (x, y) = (x * re - y * im + c, x * im + y * re);
    }
    f64::hypot(x, y)
}

/// Returns the largest `h` such that `|R(s lambda)| <= 1` for all `s` up to `h`, or infinity for `lambda = 0`. A
/// positive real part of `lambda`, a growth of the system itself, is left out.
#[must_use]
pub fn first_exit(coefficients: &[f64], [re, im]: [f64; 2]) -> f64 {
    let size = f64::hypot(re, im);
    if size == 0.0 {
        return f64::INFINITY;
    }
    let unit = [re.min(0.0) / size, im / size];
    let grows = |x: f64| modulus(coefficients, unit.map(|u| u * x)) > 1.0 + GROWTH;
    // No explicit method of s stages is stable beyond 2 s^2 (Hairer, Wanner, IV.2).
    let stages = coefficients.len() as f64;
    let last = (2.0 * stages * stages / LOOK) as u64;
    for i in 1..=last {
        let mut high = i as f64 * LOOK;
        if grows(high) {
            let mut low = high - LOOK;
            while high - low > 1e-12 * high {
                let middle = 0.5 * (low + high);
                if grows(middle) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            return low / size;
        }
    }
    f64::INFINITY
}
