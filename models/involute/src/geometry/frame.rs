//! Right-handed axes and their origin in space.

use crate::Vec3;

/// Axes of a hub and its origin in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Unit axes; the third is that of the gear.
    pub axes: [Vec3; 3],
    /// Position of the origin [m].
    pub origin: Vec3,
}

impl Frame {
    /// Transforms a point in space to these axes [m].
    #[inline]
    pub fn point_back(&self, x: &Vec3) -> Vec3 {
        self.turn_back(&(x - self.origin))
    }

    /// Transforms a direction in space to these axes.
    #[inline]
    pub fn turn_back(&self, x: &Vec3) -> Vec3 {
        Vec3::new(
            self.axes[0].dot(x),
            self.axes[1].dot(x),
            self.axes[2].dot(x),
        )
    }

    /// Transforms a direction in these axes to space.
    #[inline]
    pub fn turn(&self, x: &Vec3) -> Vec3 {
        self.axes[0] * x.x + self.axes[1] * x.y + self.axes[2] * x.z
    }

    /// Transforms a point in these axes to space [m].
    #[inline]
    pub fn point(&self, x: &Vec3) -> Vec3 {
        self.origin + self.turn(x)
    }
}
