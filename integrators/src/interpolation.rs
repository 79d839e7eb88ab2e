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
    // Equal slice lengths let the compiler omit bounds checks.
    let n = q.len();
    let (v, q0, v0) = (&mut v[..n], &from.q[..n], &from.v[..n]);
    let (q1, v1) = (&to.q[..n], &to.v[..n]);
    for i in 0..n {
        q[i] = h00 * q0[i] + h10 * h * v0[i] + h01 * q1[i] + h11 * h * v1[i];
        v[i] = 6.0 * s * r * (q1[i] - q0[i]) * inv_h
            + r * (1.0 - 3.0 * s) * v0[i]
            + s * (3.0 * s - 2.0) * v1[i];
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
    let n = q.len();
    let (v, q0, v0, a0) = (&mut v[..n], &from.q[..n], &from.v[..n], &a[0][..n]);
    let (q1, v1, a1) = (&to.q[..n], &to.v[..n], &a[1][..n]);
    for i in 0..n {
        q[i] = h00 * q0[i] + h10 * h * v0[i] + h01 * q1[i] + h11 * h * v1[i];
        v[i] = h00 * v0[i] + h10 * h * a0[i] + h01 * v1[i] + h11 * h * a1[i];
    }
}
