//! The involute function `inv a = tan a - a` and its inverse.
//!
//! Both are odd and keep full relative accuracy near zero, where the difference cancels.
//! ISO 21771-1, involute function; Litvin and Fuentes (2004), section 10.3.

/// Tangent below which the series of `t - atan t` replaces the difference.
const SERIES_BELOW: f64 = 0.1;

/// Computes `t - atan t` for `t >= 0`: the involute function of the angle whose tangent is `t`.
pub(super) fn inv_of_tangent(t: f64) -> f64 {
    if t.abs() >= SERIES_BELOW {
        return t - t.atan();
    }
    // t^3/3 - t^5/5 + t^7/7 - ...: at t = 0.1 the first dropped term is 1e-17 of the first.
    let t2 = t * t;
    let mut sum = 0.0;
    for k in (1..=8).rev() {
        sum = 1.0 / f64::from(2 * k + 1) - t2 * sum;
    }
    t * t2 * sum
}

/// Computes the involute function `tan(alpha) - alpha`; `alpha` in rad, |alpha| < pi/2.
pub fn inv(alpha: f64) -> f64 {
    inv_of_tangent(alpha.tan())
}

/// Returns the angle (rad) in (-pi/2, pi/2) whose involute function is `x`; NaN for NaN.
pub fn inv_inverse(x: f64) -> f64 {
    if x.is_nan() || x == 0.0 {
        return x;
    }
    let target = x.abs();
    if !target.is_finite() {
        return std::f64::consts::FRAC_PI_2.copysign(x);
    }
    // t - atan t is convex and increasing for t > 0, so Newton's method descends monotonically
    // once it stands right of the root; (3x)^(1/3) is left of it by little, x + pi/2 right of it.
    let mut t = if target < 1.0 {
        (3.0 * target).cbrt()
    } else {
        target + std::f64::consts::FRAC_PI_2
    };
    for _ in 0..60 {
        let slope = t * t / (1.0 + t * t);
        let step = (inv_of_tangent(t) - target) / slope;
        t -= step;
        if step.abs() <= 2.0 * f64::EPSILON * t {
            break;
        }
    }
    t.atan().copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_degrees_as_tabulated() {
        // inv 20 deg = 0.014904383867...: every gear handbook.
        assert!((inv(20f64.to_radians()) - 0.014_904_383_867_336_446).abs() < 1e-16);
    }

    #[test]
    fn inverse_returns_the_angle() {
        for k in 1..1560 {
            let a = f64::from(k) * 1e-3;
            assert!((inv_inverse(inv(a)) - a).abs() < 1e-14, "{a}");
            assert!((inv_inverse(-inv(a)) + a).abs() < 1e-14, "{a}");
        }
        for a in [1e-8, 1e-6, 1e-4, 1e-2] {
            assert!((inv_inverse(inv(a)) / a - 1.0).abs() < 1e-13, "{a}");
        }
    }

    #[test]
    fn series_and_difference_join() {
        let t = SERIES_BELOW;
        let below = inv_of_tangent(t * (1.0 - 1e-15));
        assert!((below / (t - t.atan()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn ends_of_the_range() {
        assert_eq!(inv_inverse(0.0), 0.0);
        assert!(inv_inverse(f64::NAN).is_nan());
        assert_eq!(inv_inverse(f64::INFINITY), std::f64::consts::FRAC_PI_2);
        assert!(inv_inverse(1e12) < std::f64::consts::FRAC_PI_2 + 1e-15);
        assert!(inv_inverse(1e-300) > 0.0);
    }
}
