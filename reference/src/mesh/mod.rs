//! Hexahedral meshes: nodes, elements, named sets, and what makes a mesh a gear.
//!
//! Conventions, stated once:
//!
//! - Nodes and elements are numbered from 0 inside the program; labels of a deck are its own affair.
//! - Element nodes and faces follow Abaqus and CalculiX: nodes 0-3 on the lower face, 4-7 above them, then the
//!   mid-side nodes; faces `S1` to `S6` are 0 to 5 here ([`Face`]).
//! - A [`GearMesh`] stands in its own frame: axis z through the origin, tooth 0 centred on +x, tooth `k` follows
//!   counter-clockwise. A rack as in [`gearbench_models::geometry`]: reference line on y, teeth pointing to -x,
//!   tooth 0 centred on y = 0, tooth `k` follows towards +y, `Left` is the side that meets left flanks of gears.
//!   Sets are named from 1, as the decks have them: `flank_1l` is the left flank of tooth 0.

mod assembly;
#[cfg(test)]
mod body_tests;
mod build;
mod checks;
mod error;
mod grading;
mod params;
mod profile;
mod quality;
mod section;
#[cfg(test)]
mod tests;
pub mod vtu;
mod width;

pub use build::{gear, rack, sector};
pub use error::{MeshError, Part};
pub use params::{FineTeeth, Focus, GearMeshParams, Tooth, Web};
pub use quality::{ElementQuality, Quality, element_qualities, quality};

use gearbench_models::Vec3;
use gearbench_models::geometry::{FlankGrid, Side};
use std::collections::BTreeMap;

/// Kind of a hexahedral element, by the name it has in decks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ElementKind {
    /// 8 nodes, 2x2x2 integration.
    C3D8,
    /// 8 nodes with statically condensed incompatible modes.
    C3D8I,
    /// 20 nodes, 3x3x3 integration.
    C3D20,
    /// 20 nodes, 2x2x2 integration of the stiffness.
    C3D20R,
}

impl ElementKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::C3D8, Self::C3D8I, Self::C3D20, Self::C3D20R];

    /// Name in decks.
    pub fn name(self) -> &'static str {
        match self {
            Self::C3D8 => "C3D8",
            Self::C3D8I => "C3D8I",
            Self::C3D20 => "C3D20",
            Self::C3D20R => "C3D20R",
        }
    }

    /// Finds a kind by its name, whatever the case.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|k| k.name().eq_ignore_ascii_case(name))
    }

    /// Nodes of an element.
    pub fn nodes(self) -> usize {
        match self {
            Self::C3D8 | Self::C3D8I => 8,
            Self::C3D20 | Self::C3D20R => 20,
        }
    }
}

/// Corner nodes of the faces S1 to S6, outward normal by the right-hand rule reversed as in the manuals
/// (S1 looks inwards): use the geometry, not the order, for a direction.
pub const FACE_CORNERS: [[usize; 4]; 6] = [
    [0, 1, 2, 3],
    [4, 7, 6, 5],
    [0, 4, 5, 1],
    [1, 5, 6, 2],
    [2, 6, 7, 3],
    [3, 7, 4, 0],
];

/// Corner nodes of the twelve edges, in the order of the mid-side nodes 8 to 19.
pub const EDGES: [[usize; 2]; 12] = [
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

/// Name of the node set of a flank; with an `s` in front, of its set of faces.
pub(crate) fn flank_set(tooth: u32, side: Side) -> String {
    format!("flank_{}{}", tooth + 1, letter(side))
}

/// Letter of a side in the names of sets.
pub(crate) fn letter(side: Side) -> char {
    match side {
        Side::Left => 'l',
        Side::Right => 'r',
    }
}

/// A face of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Face {
    /// Element.
    pub element: u32,
    /// Face 0 to 5, `S1` to `S6` in decks.
    pub face: u8,
}

/// A mesh of one kind of element.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Positions [m].
    pub nodes: Vec<Vec3>,
    /// Kind of all elements.
    pub kind: ElementKind,
    /// Nodes of the elements, [`ElementKind::nodes`] each.
    pub connectivity: Vec<u32>,
    /// Named node sets.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Named sets of faces.
    pub face_sets: BTreeMap<String, Vec<Face>>,
}

impl Mesh {
    /// A mesh without sets.
    pub fn new(kind: ElementKind, nodes: Vec<Vec3>, connectivity: Vec<u32>) -> Self {
        Mesh {
            nodes,
            kind,
            connectivity,
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
        }
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.connectivity.len() / self.kind.nodes()
    }

    /// Nodes of an element.
    pub fn element(&self, element: usize) -> &[u32] {
        let n = self.kind.nodes();
        &self.connectivity[element * n..][..n]
    }

    /// All elements in order.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.connectivity.chunks_exact(self.kind.nodes())
    }

    /// Corner nodes of a face.
    pub fn face_corners(&self, face: Face) -> [u32; 4] {
        let nodes = self.element(face.element as usize);
        FACE_CORNERS[face.face as usize].map(|i| nodes[i])
    }
}

/// A toothed body as finite elements, in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct GearMesh {
    /// Nodes and elements.
    pub mesh: Mesh,
    /// Number of teeth of the whole gear (of a rack: all its teeth).
    pub teeth: u32,
    /// Nodes that the hub holds rigidly: the bore, or the back of a rack.
    pub bore: Vec<u32>,
    /// Flanks as structured grids; a foreign mesh may have fewer than two per tooth.
    pub flanks: Vec<FlankGrid>,
}

impl GearMesh {
    /// Moves the nodes of the flanks by the deviations of their teeth; those within follow the forces only.
    pub fn deviate(&mut self, gear: &gearbench_models::geometry::Gear) {
        for grid in &mut self.flanks {
            grid.deviate(gear);
            for (node, x) in grid.nodes.iter().zip(&grid.positions) {
                self.mesh.nodes[*node as usize] = *x;
            }
        }
    }
}
