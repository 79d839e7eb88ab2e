//! The floating frame of a full-order gear: it stands on the hub.
//!
//! A node is at `x = c + R(theta) (X + u)` when the hub turns, and at `x = c + X + s e + u` when it slides along
//! `e`; at `x = c + s + R (X + u)` when it moves in several directions. `X` is the undeformed position, already turned into
//! the assembled position, `u` the elastic displacement, zero at the nodes that the hub holds.

use gearbench_models::Vec3;
use nalgebra::Matrix3;

/// Pose of the floating frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frame {
    /// Turned about z; cosine and sine of the angle.
    Turned {
        /// Cosine of the angle.
        cos: f64,
        /// Sine of the angle.
        sin: f64,
    },
    /// Moved along the slide.
    Moved(Vec3),
    /// Turned about any axis and shifted.
    Posed {
        /// Rotation from the assembled position.
        turn: Matrix3<f64>,
        /// Position of the origin [m].
        shift: Vec3,
    },
}

impl Frame {
    /// The frame of a hub that turns (`slide` is `None`) or slides, at an angle or displacement.
    #[inline]
    pub fn at(displacement: f64, slide: Option<&Vec3>) -> Self {
        match slide {
            None => {
                let (sin, cos) = displacement.sin_cos();
                Frame::Turned { cos, sin }
            }
            Some(e) => Frame::Moved(displacement * e),
        }
    }

    /// A direction of the frame in space.
    #[inline]
    pub fn to_space(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Frame::Turned { cos, sin } => [cos * x - sin * y, sin * x + cos * y, z],
            Frame::Moved(_) => [x, y, z],
            Frame::Posed { turn, .. } => (turn * Vec3::new(x, y, z)).into(),
        }
    }

    /// A direction of space in the frame.
    #[inline]
    pub fn to_frame(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Frame::Turned { cos, sin } => [cos * x + sin * y, cos * y - sin * x, z],
            Frame::Moved(_) => [x, y, z],
            Frame::Posed { turn, .. } => turn.tr_mul(&Vec3::new(x, y, z)).into(),
        }
    }

    /// Turns the directions of all nodes from the frame into space.
    pub fn all_to_space(self, x: &mut [f64]) {
        if !matches!(self, Frame::Moved(_)) {
            for v in x.chunks_exact_mut(3) {
                v.copy_from_slice(&self.to_space([v[0], v[1], v[2]]));
            }
        }
    }

    /// Turns the directions of all nodes from space into the frame.
    pub fn all_to_frame(self, x: &mut [f64]) {
        if !matches!(self, Frame::Moved(_)) {
            for v in x.chunks_exact_mut(3) {
                v.copy_from_slice(&self.to_frame([v[0], v[1], v[2]]));
            }
        }
    }

    /// Elastic displacement, in the frame, of a node whose place in space is `X + d`.
    #[inline]
    pub fn elastic(self, position: &Vec3, d: &[f64]) -> [f64; 3] {
        match self {
            Frame::Turned { cos, sin } => {
                // R^T (X + d) - X with R^T - I written out: no cancellation of X for small turns.
                let versine = versine(cos, sin);
                [
                    cos * d[0] + sin * d[1] + sin * position.y - versine * position.x,
                    cos * d[1] - sin * d[0] - sin * position.x - versine * position.y,
                    d[2],
                ]
            }
            Frame::Moved(s) => [d[0] - s.x, d[1] - s.y, d[2] - s.z],
            Frame::Posed { turn, shift } => {
                let d = Vec3::new(d[0], d[1], d[2]) - shift;
                let back = (turn - Matrix3::identity()).tr_mul(position);
                (turn.tr_mul(&d) + back).into()
            }
        }
    }

    /// Returns the displacement in space of a node tied to the hub.
    #[inline]
    pub fn carried(self, position: &Vec3) -> [f64; 3] {
        match self {
            Frame::Turned { cos, sin } => {
                let versine = versine(cos, sin);
                [
                    -versine * position.x - sin * position.y,
                    sin * position.x - versine * position.y,
                    0.0,
                ]
            }
            Frame::Moved(s) => [s.x, s.y, s.z],
            Frame::Posed { turn, shift } => {
                (shift + (turn - Matrix3::identity()) * position).into()
            }
        }
    }
}

/// `1 - cos` without cancellation at small angles.
#[inline]
fn versine(cos: f64, sin: f64) -> f64 {
    if cos > 0.0 {
        sin * sin / (1.0 + cos)
    } else {
        1.0 - cos
    }
}

/// Velocity of a point of the frame, in the frame, for a hub that moves at unit speed.
#[inline]
pub fn unit_motion(x: &[f64; 3], slide: Option<&Vec3>) -> [f64; 3] {
    match slide {
        None => [-x[1], x[0], 0.0],
        Some(e) => [e.x, e.y, e.z],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn carried_nodes_have_no_elastic_displacement() {
        let position = Vec3::new(0.03, -0.02, 0.004);
        for displacement in [-3.0, -0.4, 1e-7, 0.9, 2.5, 40.0] {
            for slide in [None, Some(Vec3::new(0.6, -0.8, 0.0))] {
                let frame = Frame::at(displacement, slide.as_ref());
                let d = frame.carried(&position);
                for u in frame.elastic(&position, &d) {
                    assert!(u.abs() < 2e-17, "{displacement} {u:e}");
                }
                let v = [1.0, 2.0, 3.0];
                let back = frame.to_frame(frame.to_space(v));
                assert!(v.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-15));
            }
        }
    }
}
