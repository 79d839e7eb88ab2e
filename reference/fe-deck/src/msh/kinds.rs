//! Gmsh's types of elements, and the order of their nodes in decks.

use gearbench_solid_fe::mesh::ElementKind;

/// For each node of a deck its place in Gmsh's order.
const C3D10: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
const C3D15: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11];
const C3D20: &[usize] = &[
    0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15,
];
const SAME: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7];

/// Solid kind of one of Gmsh's types, with its order. Hexahedra get the kinds that bend well.
pub(super) fn solid(kind: u32) -> Option<(ElementKind, &'static [usize])> {
    Some(match kind {
        4 => (ElementKind::C3D4, SAME),
        5 => (ElementKind::C3D8I, SAME),
        6 => (ElementKind::C3D6, SAME),
        11 => (ElementKind::C3D10, C3D10),
        17 => (ElementKind::C3D20, C3D20),
        18 => (ElementKind::C3D15, C3D15),
        _ => return None,
    })
}

/// Name and number of nodes of a type that is no solid.
pub(super) fn other(kind: u32) -> Option<(&'static str, usize)> {
    Some(match kind {
        1 => ("lines", 2),
        2 => ("triangles", 3),
        3 => ("quadrilaterals", 4),
        8 => ("quadratic lines", 3),
        9 => ("quadratic triangles", 6),
        10 => ("quadrilaterals of 9 nodes", 9),
        15 => ("points", 1),
        16 => ("quadratic quadrilaterals", 8),
        _ => return None,
    })
}
