//! Pose of a gear frame in space.
//!
//! The own frame is that of [`crate::geometry`]: the axis z through the origin and the centreline of tooth 0 on
//! +x; a rack has its reference line on y and its teeth pointing to -x. A gear turns about its centre by
//! phase + displacement. A rack travels along its slide, which is its own y.

use super::{Hub, HubFrame};
use crate::Vec3;

/// Assembled position of a gear frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Axes and centre of the hub at the assembled position.
    pub hub: HubFrame,
    /// Angle [rad] (displacement [m] of a rack) of tooth 0 at the assembled position.
    pub phase: f64,
    /// True if the body translates along the first axis of the hub.
    pub slides: bool,
}

impl Placement {
    /// Returns the placement of a gear on its hub.
    #[must_use]
    pub fn new(hub: &Hub, phase: f64) -> Self {
        Placement {
            hub: HubFrame {
                axes: hub.axes,
                origin: hub.centre,
            },
            phase,
            slides: hub.slide.is_some(),
        }
    }

    /// Returns the frame after a displacement [rad] (rack: [m]) from the assembled position, for a hub without
    /// out-of-plane freedom.
    #[inline]
    pub fn pose(&self, displacement: f64) -> Pose {
        self.on(&self.hub, displacement)
    }

    /// Returns the frame on a hub that may move in all directions, at the coordinates `q` of its gear.
    #[inline]
    pub fn pose_at(&self, hub: &Hub, t: f64, q: &[f64], displacement: f64) -> Pose {
        if hub.lateral.is_none() {
            return self.pose(displacement);
        }
        let frame = hub.frame(t, q);
        // The frame of a hub that slides has moved along already.
        let along = if self.slides {
            hub.displacement(t, q)
        } else {
            0.0
        };
        self.on(&frame, displacement - along)
    }

    #[inline]
    fn on(&self, frame: &HubFrame, displacement: f64) -> Pose {
        let [x, y, z] = frame.axes;
        if self.slides {
            return Pose {
                axes: [-y, x, z],
                origin: frame.origin + (self.phase + displacement) * x,
            };
        }
        let (sin, cos) = (self.phase + displacement).sin_cos();
        Pose {
            axes: [cos * x + sin * y, cos * y - sin * x, z],
            origin: frame.origin,
        }
    }
}

/// Rotation and translation from a gear frame to space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Axes of the gear frame in space.
    pub axes: [Vec3; 3],
    /// Origin of the gear frame in space [m].
    pub origin: Vec3,
}

impl Pose {
    /// Identity pose: the gear frame itself.
    pub const STILL: Pose = Pose {
        axes: [
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(0.0, 0.0, 1.0),
        ],
        origin: Vec3::new(0.0, 0.0, 0.0),
    };

    /// Rotates a direction from the gear frame to space.
    #[inline]
    pub fn turn(&self, x: &Vec3) -> Vec3 {
        let [a, b, c] = &self.axes;
        x.x * a + x.y * b + x.z * c
    }

    /// Rotates a direction from space to the gear frame.
    #[inline]
    pub fn turn_back(&self, x: &Vec3) -> Vec3 {
        let [a, b, c] = &self.axes;
        Vec3::new(a.dot(x), b.dot(x), c.dot(x))
    }

    /// Transforms a point of the gear frame to space [m].
    #[inline]
    pub fn point(&self, x: &Vec3) -> Vec3 {
        self.origin + self.turn(x)
    }

    /// Transforms a point in space to the gear frame [m].
    #[inline]
    pub fn point_back(&self, x: &Vec3) -> Vec3 {
        self.turn_back(&(x - self.origin))
    }

    /// Returns the height of a point in space over the plane z = 0 of the gear frame [m].
    #[inline]
    pub fn height(&self, x: &Vec3) -> f64 {
        self.axes[2].dot(&(x - self.origin))
    }

    /// Returns the vector from the gear axis to a point in space [m].
    #[inline]
    pub fn off_axis(&self, x: &Vec3) -> Vec3 {
        let (r, axis) = (x - self.origin, &self.axes[2]);
        r - axis.dot(&r) * axis
    }

    /// Returns this frame in the coordinates of another.
    pub fn seen_from(&self, other: &Pose) -> Pose {
        Pose {
            axes: self.axes.map(|axis| other.turn_back(&axis)),
            origin: other.point_back(&self.origin),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::Mount;

    fn hub(slide: Option<Vec3>) -> Hub {
        Hub::new(Mount::Fixed, Vec3::new(0.1, 0.2, 0.0), slide, 1.0)
    }

    #[test]
    fn there_and_back() {
        let x = Vec3::new(0.03, -0.01, 0.005);
        for slide in [None, Some(Vec3::new(0.6, 0.8, 0.0))] {
            let pose = Placement::new(&hub(slide), 0.4).pose(0.3);
            assert!((pose.point_back(&pose.point(&x)) - x).norm() < 1e-16);
        }
    }

    #[test]
    fn a_gear_turns_and_a_rack_slides_along_its_own_y() {
        let gear = Placement::new(&hub(None), 0.25).pose(0.5);
        let tip = gear.point(&Vec3::x()) - Vec3::new(0.1, 0.2, 0.0);
        assert!((tip.y.atan2(tip.x) - 0.75).abs() < 1e-15);
        // The own teeth point to -x: a slide along -x is a quarter turn, and they point to -y.
        let slide = -Vec3::x();
        let rack = Placement::new(&hub(Some(slide)), 0.01).pose(0.02);
        assert!((rack.turn(&Vec3::y()) - slide).norm() < 1e-15);
        assert!((rack.turn(&-Vec3::x()) + Vec3::y()).norm() < 1e-15);
        assert!((rack.origin - Vec3::new(0.07, 0.2, 0.0)).norm() < 1e-15);
    }
}
