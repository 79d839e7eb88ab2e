//! Candidate contact points between two gears.

use crate::Vec3;
use crate::kinematics::Point;

/// A candidate contact point: two points on facing flanks, with normal, gap, stiffness and derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Slot of the mesh with the mode and impact speed of this contact. Searches without slots store a mark of the
    /// flank side.
    pub slot: usize,
    /// Points on the first and second gear of the mesh.
    pub points: [Point; 2],
    /// Unit normal from the first gear to the second. At a point in the tip taper it includes the taper factor of the
    /// gap.
    pub normal: Vec3,
    /// Taper factor of a flank point that leaves contact over a tip; the normal and the gap include it where the gap
    /// is closed.
    pub taper: f64,
    /// Change of the taper factor with the motion of either gear's point, to be added to the normal. The hub of the
    /// other gear receives the reaction at that point.
    pub aside: [Vec3; 2],
    /// Derivative of the path coordinate of flanks in space: force and moment at the point, to be multiplied by the
    /// motion of gear b relative to gear a. `None` where the rows of the gears determine it.
    pub along: Option<[Vec3; 2]>,
    /// Scale of the contact row of each gear, `dg = -scale_a d(x_a . n) + scale_b d(x_b . n)`: 1 on the plain
    /// involute, 1 minus the slope of the flank's separation otherwise.
    pub scale: [f64; 2],
    /// Derivative of the scale by `-x_a . n` and by `x_b . n` [1/m]: curvature of the separations.
    pub curvature: [f64; 2],
    /// Gap [m], positive when open.
    pub gap: f64,
    /// Stiffness of the contact law at this point, in [N/m] for a linear law.
    pub stiffness: f64,
    /// Derivative of the stiffness by `x . n` [N/m^2], one half for each gear.
    pub stiffness_s: f64,
    /// Path coordinate on the line of action from the tangent point of the first gear [m]; the mean of the values of
    /// both gears where flanks overlap.
    pub s: f64,
    /// Factor of the constant damper of the law: the share of a slice in the face width, or the area [m^2] of a flank
    /// point, whose law has a damper per area.
    pub share: f64,
}

impl Candidate {
    /// Returns the direction of the contact force on the second gear per unit normal force: the normal, plus the
    /// gradient of the taper factor at a point that leaves contact over a tip.
    #[inline]
    pub fn direction(&self) -> Vec3 {
        self.normal + self.aside[0] + self.aside[1]
    }
}
