//! Where a gear's own frame stands in space.
//!
//! The own frame is that of [`crate::geometry`]: the axis z through the origin and the centreline of tooth 0 on
//! +x; a rack has its reference line on y and its teeth pointing to -x. A gear turns about its centre by
//! phase + displacement. A rack travels along its slide, which is its own y.

use super::hub::Hub;
use crate::Vec3;

/// The assembled position of a gear's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Centre of the hub at zero displacement [m].
    pub centre: Vec3,
    /// Angle [rad] (displacement [m] of a rack) of tooth 0 at the assembled position.
    pub phase: f64,
    /// Unit direction of displacement of a rack.
    pub slide: Option<Vec3>,
}

impl Placement {
    /// The placement of a gear on its hub.
    #[must_use]
    pub fn new(hub: &Hub, phase: f64) -> Self {
        Placement {
            centre: hub.centre,
            phase,
            slide: hub.slide,
        }
    }

    /// The frame after a displacement [rad] (rack: [m]) from the assembled position.
    #[inline]
    pub fn pose(&self, displacement: f64) -> Pose {
        match self.slide {
            None => {
                let (sin, cos) = (self.phase + displacement).sin_cos();
                Pose {
                    cos,
                    sin,
                    origin: self.centre,
                }
            }
            Some(slide) => Pose {
                cos: slide.y,
                sin: -slide.x,
                origin: self.centre + (self.phase + displacement) * slide,
            },
        }
    }
}

/// A turn about z and a shift, from a gear's own frame to space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Cosine of the angle.
    pub cos: f64,
    /// Sine of the angle.
    pub sin: f64,
    /// Where the own origin stands [m].
    pub origin: Vec3,
}

impl Pose {
    /// The own frame itself.
    pub const STILL: Pose = Pose {
        cos: 1.0,
        sin: 0.0,
        origin: Vec3::new(0.0, 0.0, 0.0),
    };

    /// Turns a direction of the own frame into space.
    #[inline]
    pub fn turn(&self, x: &Vec3) -> Vec3 {
        Vec3::new(
            self.cos * x.x - self.sin * x.y,
            self.sin * x.x + self.cos * x.y,
            x.z,
        )
    }

    /// Turns a direction in space into the own frame.
    #[inline]
    pub fn turn_back(&self, x: &Vec3) -> Vec3 {
        Vec3::new(
            self.cos * x.x + self.sin * x.y,
            self.cos * x.y - self.sin * x.x,
            x.z,
        )
    }

    /// Position in space [m] of a point of the own frame.
    #[inline]
    pub fn point(&self, x: &Vec3) -> Vec3 {
        self.origin + self.turn(x)
    }

    /// Position in the own frame [m] of a point in space.
    #[inline]
    pub fn point_back(&self, x: &Vec3) -> Vec3 {
        self.turn_back(&(x - self.origin))
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
