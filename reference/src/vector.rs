//! Sums and rotations of vectors that several modules need.

pub(crate) use gearbench_solid_fe::vector::turned;

/// Returns the scalar product `a . b`.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// A value that differs from 0 only by the digits that decks print of positions of this size counts as 0.
pub(crate) fn snapped(value: f64, size: f64) -> f64 {
    if value.abs() <= 1e-10 * size {
        0.0
    } else {
        value
    }
}
