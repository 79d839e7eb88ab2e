//! Teeth of a gear and points on them.

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
