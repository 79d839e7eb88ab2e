//! Candidate contact points between two gears.

use crate::Vec3;

/// Tooth of a gear, unwrapped: `index` counts teeth counter-clockwise from tooth 0 and may exceed the
/// number of teeth, so that a tooth pair keeps its name over turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tooth {
    /// Unwrapped index.
    pub index: i64,
    /// Which of the gear's meshes asks (the gear's own count, 0 for its first mesh).
    pub mesh: u8,
}

/// Where on a gear a candidate point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Locus {
    /// A point of the smooth flank.
    Flank {
        /// Radius from the axis [m] (height over the reference line for a rack).
        radius: f64,
        /// Position over the face width in [-1, 1].
        zeta: f64,
    },
    /// A flank node of a mesh.
    Node(u32),
    /// A quadrature point of a flank face.
    Quadrature {
        /// Face of the flank.
        face: u32,
        /// Parametric coordinates on the face.
        xi: [f64; 2],
    },
}

/// A point of a gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Its tooth.
    pub tooth: Tooth,
    /// Where on the tooth.
    pub locus: Locus,
    /// Position in space [m].
    pub x: Vec3,
}

/// A pair of points that may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Slot of the mesh that holds this contact's mode and impact speed; a mark of its own for a search
    /// without slots.
    pub slot: usize,
    /// Points on the first and second gear of the mesh.
    pub points: [Point; 2],
    /// Unit normal from the first gear to the second.
    pub normal: Vec3,
    /// `dg = -scale_a d(x_a . n) + scale_b d(x_b . n)`: 1 on the unmodified flank, 1 minus the slope of the
    /// flank's deviation otherwise.
    pub scale: [f64; 2],
    /// Gap before local compliance [m], positive when open.
    pub gap: f64,
    /// Part of the gap rate that is prescribed [m/s].
    pub gap_t: f64,
    /// Stiffness of the law at this point, [N/m] for a linear law.
    pub stiffness: f64,
    /// Derivative of the stiffness by the path coordinate of the first gear [N/m^2].
    pub stiffness_s: f64,
    /// Path coordinate on the line of action from the first gear's tangent point [m].
    pub s: f64,
    /// What the law's constant damper is multiplied by: 1 for tooth pairs, the area [m^2] of a flank point,
    /// whose law has a damper per area.
    pub share: f64,
}
