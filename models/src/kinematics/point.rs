//! Teeth of a gear and points on them.

use crate::Vec3;

/// Tooth of a gear, counted on over turns: `index` counts counter-clockwise from tooth 0 and may exceed the number of
/// teeth, so that a tooth pair keeps its identity over turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tooth {
    /// Tooth index, counted on over turns.
    pub index: i64,
    /// Index of the mesh among those of the gear, 0 for its first mesh.
    pub mesh: u8,
}

/// Position of a candidate point on a gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Locus {
    /// A point of the smooth flank.
    Flank {
        /// Radius from the axis [m] (height over the reference line for a rack).
        radius: f64,
        /// Position over the face width in [-1, 1].
        zeta: f64,
    },
    /// A flank node of a mesh, by its number.
    Node(u32),
    /// A quadrature point of a flank face.
    Quadrature {
        /// Number of the face, counted as in [`Flanks`](crate::geometry::Flanks).
        face: u32,
        /// Parametric coordinates on the face.
        xi: [f64; 2],
    },
}

/// A point of a gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Tooth of the point.
    pub tooth: Tooth,
    /// Position on the tooth.
    pub locus: Locus,
    /// Position in space [m].
    pub x: Vec3,
}
