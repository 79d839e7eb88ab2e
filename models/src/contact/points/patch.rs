//! Faces of a flank in its own frame as polynomials, for searches with many evaluations per face.
//!
//! What [`Face::eval`](super::surface::Face::eval) adds up of chords and bulges is
//!
//! ```text
//! X(a, b) = sum_{i<=3} a^i (p_i + b q_i) + b^2 (r_2 + a s_2) + b^3 (r_3 + a s_3)
//! ```

use super::surface::{Shape, SurfacePoint};
use crate::Vec3;
use crate::kinematics::Pose;

/// A face of an undeformed flank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    p: [Vec3; 4],
    q: [Vec3; 4],
    /// Coefficients of `b^2` and `b^3`.
    r: [Vec3; 2],
    s: [Vec3; 2],
}

impl Patch {
    /// Returns all faces of a shape, row by row.
    pub fn all(shape: &Shape) -> Vec<Patch> {
        let columns = 0..shape.columns - 1;
        let faces = (0..shape.rows - 1).flat_map(|row| columns.clone().map(move |c| (row, c)));
        faces.map(|(row, c)| Patch::of(shape, row, c)).collect()
    }

    fn of(shape: &Shape, row: usize, column: usize) -> Self {
        let face = shape.face(&shape.positions, &Pose::STILL, row, column);
        let at = |a: f64, b: f64| face.eval(shape, a, b);
        let corners = [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 0.0), at(1.0, 1.0)];
        // A cubic by value, slope and second slope at its beginning, and the second slope at its end.
        let cubic = |x: Vec3, slope: Vec3, bends: [Vec3; 2]| {
            [x, slope, 0.5 * bends[0], (bends[1] - bends[0]) / 6.0]
        };
        let along = |k: usize| {
            let (near, far) = (&corners[k], &corners[2 + k]);
            cubic(near.x, near.along, [near.bend[0], far.bend[0]])
        };
        let across = |k: usize| {
            let (near, far) = (&corners[2 * k], &corners[2 * k + 1]);
            cubic(near.x, near.across, [near.bend[2], far.bend[2]])
        };
        let (p, beside) = (along(0), along(1));
        let (below, above) = (across(0), across(1));
        let r = [below[2], below[3]];
        let s = [above[2] - r[0], above[3] - r[1]];
        let mut q: [Vec3; 4] = std::array::from_fn(|i| beside[i] - p[i]);
        // The contributions of the edges at both ends are already included.
        q[0] -= r[0] + r[1];
        q[1] -= s[0] + s[1];
        Patch { p, q, r, s }
    }

    /// Computes position, tangents and second derivatives.
    #[inline]
    pub fn eval(&self, a: f64, b: f64) -> SurfacePoint {
        let Patch { p, q, r, s } = self;
        let t = [
            p[0] + b * q[0],
            p[1] + b * q[1],
            p[2] + b * q[2],
            p[3] + b * q[3],
        ];
        let (r2, r3) = (r[0] + a * s[0], r[1] + a * s[1]);
        let square = b * b;
        SurfacePoint {
            x: t[0] + a * (t[1] + a * (t[2] + a * t[3])) + square * (r2 + b * r3),
            along: t[1] + a * (2.0 * t[2] + (3.0 * a) * t[3]) + square * (s[0] + b * s[1]),
            across: q[0] + a * (q[1] + a * (q[2] + a * q[3])) + b * (2.0 * r2 + (3.0 * b) * r3),
            bend: [
                2.0 * t[2] + (6.0 * a) * t[3],
                q[1] + a * (2.0 * q[2] + (3.0 * a) * q[3]) + b * (2.0 * s[0] + (3.0 * b) * s[1]),
                2.0 * r2 + (6.0 * b) * r3,
            ],
        }
    }

    /// Computes the position.
    #[inline]
    pub fn position(&self, a: f64, b: f64) -> Vec3 {
        let Patch { p, q, r, s } = self;
        let t = [
            p[0] + b * q[0],
            p[1] + b * q[1],
            p[2] + b * q[2],
            p[3] + b * q[3],
        ];
        let (r2, r3) = (r[0] + a * s[0], r[1] + a * s[1]);
        t[0] + a * (t[1] + a * (t[2] + a * t[3])) + b * b * (r2 + b * r3)
    }
}
