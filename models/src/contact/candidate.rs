//! Candidate contact points between two gears.

use crate::Vec3;
use crate::kinematics::Point;

/// A pair of points that may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Slot of the mesh that holds this contact's mode and impact speed; a mark of its own for a search
    /// without slots.
    pub slot: usize,
    /// Points on the first and second gear of the mesh.
    pub points: [Point; 2],
    /// Unit normal from the first gear to the second; with the factor of the gap of a flank point that leaves over a tip.
    pub normal: Vec3,
    /// That factor; the normal and the gap have it where the gap is closed.
    pub fade: f64,
    /// What is added to the normal for the motion of either gear's point: how the factor of the gap changes. The hub of the
    /// other gear feels the reaction, at that point.
    pub aside: [Vec3; 2],
    /// How the contact moves along the normal when neither gear tells by its part of the row: force and moment at the point
    /// that the motion of gear b over gear a is multiplied by, of flanks in space.
    pub along: Option<[Vec3; 2]>,
    /// `dg = -scale_a d(x_a . n) + scale_b d(x_b . n)`: 1 on the plain involute, 1 minus the slope of the
    /// flank's separation otherwise.
    pub scale: [f64; 2],
    /// How the scale falls with `x_a . n`, or rises with `x_b . n` [1/m]: curvature of the separations.
    pub curvature: [f64; 2],
    /// Gap [m], positive when open.
    pub gap: f64,
    /// Stiffness of the law at this point, [N/m] for a linear law.
    pub stiffness: f64,
    /// Derivative of the stiffness by `x . n`, by half for either gear [N/m^2].
    pub stiffness_s: f64,
    /// Path coordinate on the line of action from the first gear's tangent point [m], in the middle of what both gears
    /// say where flanks overlap.
    pub s: f64,
    /// What the law's constant damper is multiplied by: the share of a slice in the face width, the area [m^2] of a flank
    /// point, whose law has a damper per area.
    pub share: f64,
}

impl Candidate {
    /// Direction of the contact force on the second gear, per normal force: the normal, and at a point that leaves over a
    /// tip the part of the force by which the factor of the gap changes.
    #[inline]
    pub fn direction(&self) -> Vec3 {
        self.normal + self.aside[0] + self.aside[1]
    }
}
