//! Corners of the faces of twisted flanks, with the displacements of their nodes.

use super::surface::Shape;
use crate::contact::nodal::{GearNodes, NodalGearState, UNUSED};
use crate::geometry::Flanks;

/// Corners of a face as nodes of its gear, with their displacements.
#[derive(Clone, Copy)]
pub(super) struct Corners {
    pub face: (usize, usize),
    pub slots: [u32; 4],
    pub displacements: [f64; 4],
}

impl Corners {
    /// Registers the corners of a face; they are empty without a field.
    #[inline]
    pub fn of(side: &mut NodalGearState<'_>, shape: &Shape, row: usize, column: usize) -> Self {
        let Some(field) = side.field else {
            return Corners {
                face: (row, column),
                slots: [UNUSED; 4],
                displacements: [0.0; 4],
            };
        };
        let nodes = shape.corners(row, column);
        let slots = side.nodes.meet(field, side.gear_state.at, &nodes);
        Corners {
            face: (row, column),
            slots,
            displacements: GearNodes::at(&side.nodes.displacement, &slots),
        }
    }

    #[inline]
    pub fn highest(&self) -> f64 {
        let [a, b, c, d] = self.displacements;
        a.max(b).max(c.max(d))
    }

    #[inline]
    pub fn at(&self, w: &[f64; 4]) -> f64 {
        let a = &self.displacements;
        w[0] * a[0] + w[1] * a[1] + w[2] * a[2] + w[3] * a[3]
    }
}

/// Returns the bilinear weights of the corners of a face.
#[inline]
pub(super) fn weights(a: f64, b: f64) -> [f64; 4] {
    Flanks::weights([2.0 * a - 1.0, 2.0 * b - 1.0])
}
