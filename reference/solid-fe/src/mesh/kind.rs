//! Kinds of solid elements: nodes, edges and faces, numbered as by Abaqus and CalculiX.
//!
//! | shape | corners | mid-side nodes of the quadratic kinds |
//! |---|---|---|
//! | hexahedron | 0-3 on the lower face, 4-7 above them | 8-11 below, 12-15 above, 16-19 between |
//! | wedge | 0-2 on the lower triangle, 3-5 above them | 6-8 below, 9-11 above, 12-14 between |
//! | tetrahedron | 0-2 on a triangle, counter-clockwise seen from 3 | 4-6 on that triangle, 7-9 towards 3 |
//!
//! Source: manuals of Abaqus (solid element library) and of CalculiX CrunchiX 2.20 (element types).

/// Kind of a solid element, by the name it has in decks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ElementKind {
    /// Hexahedron with 8 nodes, 2x2x2 integration.
    C3D8,
    /// Hexahedron with 8 nodes and statically condensed incompatible modes.
    C3D8I,
    /// Hexahedron with 20 nodes, 3x3x3 integration.
    C3D20,
    /// Hexahedron with 20 nodes, 2x2x2 integration.
    C3D20R,
    /// Tetrahedron with 4 nodes, 1 integration point.
    C3D4,
    /// Tetrahedron with 10 nodes, 4 integration points.
    C3D10,
    /// Wedge with 6 nodes, 2 integration points.
    C3D6,
    /// Wedge with 15 nodes, 3x3 integration points.
    C3D15,
}

/// Shape of an element, whatever its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Shape {
    /// Six quadrilateral faces.
    Hexahedron,
    /// Two triangles, three quadrilaterals.
    Wedge,
    /// Four triangular faces.
    Tetrahedron,
}

/// Ends of the edges of a hexahedron, in the order of the mid-side nodes.
const HEXAHEDRON_EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 0],
    [4, 5],
    [5, 6],
    [6, 7],
    [7, 4],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

const WEDGE_EDGES: [[usize; 2]; 9] = [
    [0, 1],
    [1, 2],
    [2, 0],
    [3, 4],
    [4, 5],
    [5, 3],
    [0, 3],
    [1, 4],
    [2, 5],
];

const TETRAHEDRON_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Corners of the faces S1 and on; the right-hand rule points inwards.
const HEXAHEDRON_FACES: [&[usize]; 6] = [
    &[0, 1, 2, 3],
    &[4, 7, 6, 5],
    &[0, 4, 5, 1],
    &[1, 5, 6, 2],
    &[2, 6, 7, 3],
    &[3, 7, 4, 0],
];

const WEDGE_FACES: [&[usize]; 5] = [
    &[0, 1, 2],
    &[3, 5, 4],
    &[0, 3, 4, 1],
    &[1, 4, 5, 2],
    &[2, 5, 3, 0],
];

const TETRAHEDRON_FACES: [&[usize]; 4] = [&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]];

impl ElementKind {
    /// All kinds of elements.
    pub const ALL: [Self; 8] = [
        Self::C3D8,
        Self::C3D8I,
        Self::C3D20,
        Self::C3D20R,
        Self::C3D4,
        Self::C3D10,
        Self::C3D6,
        Self::C3D15,
    ];

    /// Kinds that are hexahedra.
    pub const HEXAHEDRA: [Self; 4] = [Self::C3D8, Self::C3D8I, Self::C3D20, Self::C3D20R];

    /// Returns the name in decks.
    pub fn name(self) -> &'static str {
        match self {
            Self::C3D8 => "C3D8",
            Self::C3D8I => "C3D8I",
            Self::C3D20 => "C3D20",
            Self::C3D20R => "C3D20R",
            Self::C3D4 => "C3D4",
            Self::C3D10 => "C3D10",
            Self::C3D6 => "C3D6",
            Self::C3D15 => "C3D15",
        }
    }

    /// Finds a kind by its name, whatever the case.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|k| k.name().eq_ignore_ascii_case(name))
    }

    /// Shape of an element.
    pub fn shape(self) -> Shape {
        match self {
            Self::C3D8 | Self::C3D8I | Self::C3D20 | Self::C3D20R => Shape::Hexahedron,
            Self::C3D6 | Self::C3D15 => Shape::Wedge,
            Self::C3D4 | Self::C3D10 => Shape::Tetrahedron,
        }
    }

    /// Nodes of an element.
    pub fn nodes(self) -> usize {
        match self {
            Self::C3D8 | Self::C3D8I => 8,
            Self::C3D20 | Self::C3D20R => 20,
            Self::C3D4 => 4,
            Self::C3D10 => 10,
            Self::C3D6 => 6,
            Self::C3D15 => 15,
        }
    }

    /// Nodes at its corners; they come first.
    pub fn corners(self) -> usize {
        match self.shape() {
            Shape::Hexahedron => 8,
            Shape::Wedge => 6,
            Shape::Tetrahedron => 4,
        }
    }

    /// Returns true if the element has nodes at the middles of its edges.
    pub fn is_quadratic(self) -> bool {
        self.nodes() > self.corners()
    }

    /// Corners at the ends of its edges, in the order of the mid-side nodes.
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self.shape() {
            Shape::Hexahedron => &HEXAHEDRON_EDGES,
            Shape::Wedge => &WEDGE_EDGES,
            Shape::Tetrahedron => &TETRAHEDRON_EDGES,
        }
    }

    /// Corners of its faces `S1` and on, three or four each, around the face. The right-hand rule points into the
    /// element.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self.shape() {
            Shape::Hexahedron => &HEXAHEDRON_FACES,
            Shape::Wedge => &WEDGE_FACES,
            Shape::Tetrahedron => &TETRAHEDRON_FACES,
        }
    }

    /// The node in the middle of the edge between two corners, of a quadratic kind.
    pub fn middle(self, a: usize, b: usize) -> Option<usize> {
        let edge = (self.edges().iter()).position(|e| *e == [a, b] || *e == [b, a])?;
        self.is_quadratic().then_some(self.corners() + edge)
    }

    /// Nodes of a face: its corners around it, then, of a quadratic kind, the middles between each corner and the
    /// next.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn face_nodes(self, face: usize) -> impl Iterator<Item = usize> {
        let corners = self.faces()[face];
        let next = corners.iter().cycle().skip(1);
        let middles = corners.iter().zip(next);
        let middles = middles.filter_map(move |(&a, &b)| self.middle(a, b));
        corners.iter().copied().chain(middles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::element::natural;

    #[test]
    fn faces_close_each_element_and_look_inwards() {
        for kind in ElementKind::ALL {
            let at = |n: usize| Vec3::from(natural(kind, n));
            let centre = (0..kind.corners()).map(at).sum::<Vec3>() / kind.corners() as f64;
            // Of a closed surface the vector areas add up to nothing, and every edge is passed once each way.
            let mut area = Vec3::zeros();
            let mut edges = Vec::new();
            for face in kind.faces() {
                let around = face.iter().zip(face.iter().cycle().skip(1));
                edges.extend(around.map(|(&a, &b)| [a, b]));
                let own: Vec3 = (1..face.len() - 1)
                    .map(|i| (at(face[i]) - at(face[0])).cross(&(at(face[i + 1]) - at(face[0]))))
                    .sum();
                assert!(own.dot(&(centre - at(face[0]))) > 0.0, "{kind:?} {face:?}");
                area += own;
            }
            assert!(area.norm() < 1e-15);
            assert_eq!(edges.len(), 2 * kind.edges().len());
            for [a, b] in kind.edges() {
                assert!(edges.contains(&[*a, *b]) && edges.contains(&[*b, *a]));
            }
        }
    }

    #[test]
    fn mid_side_nodes_stand_in_the_middle() {
        for kind in ElementKind::ALL {
            let at = |n: usize| Vec3::from(natural(kind, n));
            for &[a, b] in kind.edges() {
                match kind.middle(b, a) {
                    Some(m) => assert_eq!(at(m), 0.5 * (at(a) + at(b))),
                    None => assert!(!kind.is_quadratic()),
                }
            }
            assert_eq!(kind.middle(0, 0), None);
        }
        let nodes = |kind: ElementKind, face| kind.face_nodes(face).collect::<Vec<_>>();
        assert_eq!(nodes(ElementKind::C3D10, 3), [2, 3, 0, 9, 7, 6]);
        assert_eq!(nodes(ElementKind::C3D15, 4), [2, 5, 3, 0, 14, 11, 12, 8]);
        assert_eq!(nodes(ElementKind::C3D20, 1), [4, 7, 6, 5, 15, 14, 13, 12]);
        assert_eq!(nodes(ElementKind::C3D6, 0), [0, 1, 2]);
    }
}
