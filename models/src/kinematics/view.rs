//! View of a gear from one of its meshes.

use crate::geometry::Side;

/// Data of a gear for one of its meshes, from which the path coordinate and contact radius of a tooth follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshView {
    /// Base radius [m], negative for an internal gear; `None` for a rack.
    pub base_radius: Option<f64>,
    /// Direction from this gear's centre to the pitch point [rad]: to its partner, or away from an internal one.
    pub direction: f64,
    /// Transverse working pressure angle [rad].
    pub working_pressure_angle: f64,
    /// Angle between the centreline of a tooth and its flank's origin on the base circle [rad], negative for an
    /// internal gear; for a rack half the tooth thickness on the pitch line [m]. The values of left and right flanks
    /// differ on conical gears.
    pub half_angle_base: [f64; 2],
    /// Range of the path coordinate (from the gear's own tangent point) over the path of contact [m].
    pub path: [f64; 2],
    /// Range of the path coordinate including contact of both tip edges before and behind the path of contact [m].
    pub touching: [f64; 2],
    /// Angle [rad] (or displacement [m]) between teeth.
    pub pitch: f64,
    /// Angle (or displacement) of tooth 0 at the assembled position.
    pub assembled: f64,
}

impl MeshView {
    /// Returns the half angle on the base circle of a flank [rad]; for a rack half the tooth thickness [m].
    #[inline]
    pub fn half_angle_of(&self, side: Side) -> f64 {
        self.half_angle_base[usize::from(side == Side::Right)]
    }

    /// Returns the derivative of a left flank's path coordinate by the tooth's angle [m] (by the displacement [-] of a
    /// rack).
    pub fn path_per_displacement(&self) -> f64 {
        self.base_radius
            .unwrap_or_else(|| -self.working_pressure_angle.cos())
    }

    /// Returns the path coordinate of a flank from the gear's own tangent point [m], for a tooth at `angle` (for a
    /// rack at a displacement, where it is the flank's distance from the pitch point along the line of action).
    #[inline]
    pub fn path_coordinate(&self, side: Side, angle: f64) -> f64 {
        let sign = side.sign();
        let half_angle = self.half_angle_of(side);
        match self.base_radius {
            Some(rb) => {
                rb * (sign * (angle - self.direction) + self.working_pressure_angle + half_angle)
            }
            None => {
                // The lower side of a rack tooth meets the left flanks of a gear at its left.
                -(sign * angle - half_angle) * self.working_pressure_angle.cos()
            }
        }
    }
}
