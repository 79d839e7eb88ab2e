//! Hermite interpolants of a step.

use crate::system::State;

/// Values and slopes of the four cubic Hermite polynomials.
#[inline]
fn hermite_basis(s: f64) -> [f64; 4] {
    let r = 1.0 - s;
    [
        (1.0 + 2.0 * s) * r * r,
        s * r * r,
        s * s * (3.0 - 2.0 * s),
        -s * s * r,
    ]
}

/// Cubic Hermite interpolant of `q` from `(q, v)` at both ends; `v` is its derivative.
pub fn hermite(from: &State, to: &State, theta: f64, q: &mut [f64], v: &mut [f64]) {
    let h = to.t - from.t;
    let [h00, h10, h01, h11] = hermite_basis(theta);
    let (s, r) = (theta, 1.0 - theta);
    let inv_h = if h > 0.0 { 1.0 / h } else { 0.0 };
    for i in 0..q.len() {
        q[i] = h00 * from.q[i] + h10 * h * from.v[i] + h01 * to.q[i] + h11 * h * to.v[i];
        v[i] = 6.0 * s * r * (to.q[i] - from.q[i]) * inv_h
            + r * (1.0 - 3.0 * s) * from.v[i]
            + s * (3.0 * s - 2.0) * to.v[i];
    }
}

/// Hermite interpolants of `q` from `(q, v)` and of `v` from `(v, a)`, one order better in `v` than
/// [`hermite`].
pub fn hermite_with_acceleration(
    from: &State,
    to: &State,
    a: [&[f64]; 2],
    theta: f64,
    q: &mut [f64],
    v: &mut [f64],
) {
    let h = to.t - from.t;
    let [h00, h10, h01, h11] = hermite_basis(theta);
    for i in 0..q.len() {
        q[i] = h00 * from.q[i] + h10 * h * from.v[i] + h01 * to.q[i] + h11 * h * to.v[i];
        v[i] = h00 * from.v[i] + h10 * h * a[0][i] + h01 * to.v[i] + h11 * h * a[1][i];
    }
}
