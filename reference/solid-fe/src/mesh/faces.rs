//! Faces of elements by their corner nodes, and the surface of a mesh.

use super::{Block, ElementKind, Face};
use std::collections::HashMap;
use std::ops::Deref;

/// Corner nodes of a face, around it: three or four.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FaceCorners {
    nodes: [u32; 4],
    count: u8,
}

impl FaceCorners {
    /// Of a face of an element with these nodes.
    ///
    /// # Panics
    /// If there is no such face, or too few nodes.
    pub fn of(kind: ElementKind, face: usize, nodes: &[u32]) -> Self {
        let corners = kind.faces()[face];
        let mut found = [u32::MAX; 4];
        for (f, &c) in found.iter_mut().zip(corners) {
            *f = nodes[c];
        }
        FaceCorners {
            nodes: found,
            count: corners.len() as u8,
        }
    }

    /// Returns a key that both sides of a face between elements share: its corners in ascending order; a triangle has
    /// `u32::MAX` for the fourth.
    pub fn key(self) -> [u32; 4] {
        let mut key = self.nodes;
        key.sort_unstable();
        key
    }
}

impl Deref for FaceCorners {
    type Target = [u32];

    fn deref(&self) -> &[u32] {
        &self.nodes[..usize::from(self.count)]
    }
}

/// Returns the faces that belong to one element only, in the order of the elements, which are counted through the
/// blocks.
///
/// Faces of neighbours have to have the same corners: a quadrilateral against two triangles is surface on both
/// sides.
pub fn boundary(blocks: &[Block]) -> Vec<Face> {
    let faces = || {
        let elements = blocks
            .iter()
            .flat_map(|b| b.elements().map(move |nodes| (b.kind, nodes)));
        elements.enumerate().flat_map(|(e, (kind, nodes))| {
            (0..kind.faces().len()).map(move |face| {
                let at = Face {
                    element: e as u32,
                    face: face as u8,
                };
                (at, FaceCorners::of(kind, face, nodes).key())
            })
        })
    };
    let mut seen: HashMap<[u32; 4], u32> = HashMap::new();
    for (_, key) in faces() {
        *seen.entry(key).or_default() += 1;
    }
    let single = faces().filter(|(_, key)| seen[key] == 1);
    single.map(|(face, _)| face).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::mesh::{Mesh, push};

    /// The surface of a cube, a wedge on its side and a tetrahedron on the wedge lacks the quadrilateral and the
    /// triangle between them.
    #[test]
    fn the_surface_of_mixed_kinds_leaves_out_what_is_between() {
        let mut mesh = Mesh::new(
            ElementKind::C3D8,
            vec![Vec3::zeros(); 11],
            vec![0, 1, 2, 3, 4, 5, 6, 7],
        );
        push(&mut mesh.blocks, ElementKind::C3D6, [1, 8, 2, 5, 9, 6]);
        push(&mut mesh.blocks, ElementKind::C3D4, [5, 9, 6, 10]);
        assert_eq!(mesh.blocks.len(), 3);
        assert_eq!((mesh.element_count(), mesh.kind()), (3, None));
        assert_eq!(mesh.kind_names(), "C3D8, C3D6, C3D4");
        assert_eq!(mesh.element_of(2), (ElementKind::C3D4, &[5, 9, 6, 10][..]));
        let surface = mesh.boundary();
        assert_eq!(surface.len(), 5 + 3 + 3);
        let has = |element, face| surface.contains(&Face { element, face });
        assert!(!has(0, 3) && !has(1, 4) && !has(1, 1) && !has(2, 0));
        assert_eq!(
            *mesh.face_corners(Face {
                element: 1,
                face: 1
            }),
            [5, 6, 9]
        );
        assert_eq!(
            mesh.face_corners(Face {
                element: 2,
                face: 0
            })
            .len(),
            3
        );
    }

    #[test]
    fn a_quadratic_mesh_has_the_surface_of_its_corners() {
        let quadratic = Mesh::new(ElementKind::C3D10, vec![], (0..10).collect());
        assert_eq!(quadratic.boundary().len(), 4);
    }
}
