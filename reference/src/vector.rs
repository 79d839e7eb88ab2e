//! Sums and turns of vectors that several modules need.

use gearbench_models::Vec3;

/// Returns the scalar product `a . b`.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// A vector turned about z; no turn leaves every bit.
pub(crate) fn turned(x: Vec3, angle: f64) -> Vec3 {
    if angle == 0.0 {
        return x;
    }
    let (s, c) = angle.sin_cos();
    Vec3::new(c * x.x - s * x.y, s * x.x + c * x.y, x.z)
}

/// A value that differs from 0 only by the digits that decks print of positions of this size counts as 0.
pub(crate) fn snapped(value: f64, size: f64) -> f64 {
    if value.abs() <= 1e-10 * size {
        0.0
    } else {
        value
    }
}
