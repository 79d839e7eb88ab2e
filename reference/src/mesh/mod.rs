//! Meshes of solid elements: nodes, elements, named sets, and the additional data of a gear mesh.
//!
//! Conventions, stated once:
//!
//! - Nodes and elements are numbered from 0 inside the program; labels of a deck are its own affair.
//! - Element nodes and faces follow Abaqus and CalculiX ([`ElementKind`]); faces `S1` to `S6` are 0 to 5 here
//!   ([`Face`]).
//! - A [`GearMesh`] stands in its own frame: axis z through the origin, tooth 0 centred on +x, tooth `k` follows
//!   counter-clockwise. A rack as in [`gearbench_models::geometry`]: reference line on y, teeth pointing to -x,
//!   tooth 0 centred on y = 0, tooth `k` follows towards +y, `Left` is the side that meets left flanks of gears.
//!   Sets are named from 1, as the decks have them: `flank_1l` is the left flank of tooth 0.

mod assembly;
#[cfg(test)]
mod body_tests;
mod build;
mod checks;
mod conical;
#[cfg(test)]
mod conical_tests;
mod error;
mod faces;
mod grading;
mod kind;
mod params;
mod profile;
mod quality;
#[cfg(test)]
mod ring_tests;
mod section;
mod split;
#[cfg(test)]
mod tests;
pub mod vtu;
mod width;

pub use build::{gear, rack, sector};
pub use error::{MeshError, Part};
pub use faces::{FaceCorners, boundary};
pub use kind::{ElementKind, Shape};
pub use params::{FineTeeth, Focus, GearMeshParams, Tooth, Web};
pub use quality::{ElementQuality, Quality, element_qualities, quality};
pub use split::tetrahedra;

use gearbench_models::Vec3;
use gearbench_models::geometry::{FlankGrid, Side};
use std::collections::BTreeMap;

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
    /// Element number.
    pub element: u32,
    /// Face from 0, `S1` and on in decks; see [`ElementKind::face`].
    pub face: u8,
}

/// Elements of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Kind of the elements.
    pub kind: ElementKind,
    /// Their nodes, [`ElementKind::nodes`] each.
    pub connectivity: Vec<u32>,
}

impl Block {
    /// Returns the number of elements.
    pub fn element_count(&self) -> usize {
        self.connectivity.len() / self.kind.nodes()
    }

    /// The elements in order.
    pub fn elements(&self) -> std::slice::ChunksExact<'_, u32> {
        self.connectivity.chunks_exact(self.kind.nodes())
    }
}

/// Adds elements at the end: to the last block if that is of their kind.
pub fn push(blocks: &mut Vec<Block>, kind: ElementKind, nodes: impl IntoIterator<Item = u32>) {
    match blocks.last_mut() {
        Some(block) if block.kind == kind => block.connectivity.extend(nodes),
        _ => blocks.push(Block {
            kind,
            connectivity: nodes.into_iter().collect(),
        }),
    }
}

/// A mesh of solid elements, in blocks of one kind each. Elements are counted through the blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Positions of the nodes [m].
    pub nodes: Vec<Vec3>,
    /// Blocks of elements.
    pub blocks: Vec<Block>,
    /// Node sets by name.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Named sets of faces.
    pub face_sets: BTreeMap<String, Vec<Face>>,
}

impl Mesh {
    /// Creates a mesh of one kind of element without sets.
    pub fn new(kind: ElementKind, nodes: Vec<Vec3>, connectivity: Vec<u32>) -> Self {
        Mesh {
            nodes,
            blocks: vec![Block { kind, connectivity }],
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
        }
    }

    /// Returns the number of elements.
    pub fn element_count(&self) -> usize {
        self.blocks.iter().map(Block::element_count).sum()
    }

    /// Kind and nodes of an element.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn element_of(&self, element: usize) -> (ElementKind, &[u32]) {
        let mut at = element;
        for block in &self.blocks {
            let count = block.element_count();
            if at < count {
                let n = block.kind.nodes();
                return (block.kind, &block.connectivity[at * n..][..n]);
            }
            at -= count;
        }
        panic!("element {element} of a mesh with {}", self.element_count())
    }

    /// Nodes of an element.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn element(&self, element: usize) -> &[u32] {
        self.element_of(element).1
    }

    /// All elements in order.
    pub fn elements(&self) -> impl Iterator<Item = &[u32]> {
        self.blocks.iter().flat_map(Block::elements)
    }

    /// Iterates over the nodes of all elements, one element after the other.
    pub fn connectivity(&self) -> impl Iterator<Item = u32> + '_ {
        let blocks = self.blocks.iter();
        blocks.flat_map(|b| b.connectivity.iter().copied())
    }

    /// Returns the kind of all elements, or `None` for a mesh of several kinds.
    pub fn kind(&self) -> Option<ElementKind> {
        let (first, others) = self.blocks.split_first()?;
        let same = others.iter().all(|b| b.kind == first.kind);
        same.then_some(first.kind)
    }

    /// Names of the kinds of elements, each once, as `C3D8, C3D6`.
    pub fn kind_names(&self) -> String {
        let mut names: Vec<&str> = Vec::new();
        for block in &self.blocks {
            if !names.contains(&block.kind.name()) {
                names.push(block.kind.name());
            }
        }
        names.join(", ")
    }

    /// Corner nodes of a face.
    pub fn face_corners(&self, face: Face) -> FaceCorners {
        let (kind, nodes) = self.element_of(face.element as usize);
        FaceCorners::of(kind, face.face as usize, nodes)
    }

    /// Returns the surface: the faces that belong to one element only, in the order of the elements.
    pub fn boundary(&self) -> Vec<Face> {
        faces::boundary(&self.blocks)
    }
}

/// A toothed body as finite elements, in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct GearMesh {
    /// Nodes and elements of the gear.
    pub mesh: Mesh,
    /// Number of teeth of the whole gear (of a rack: all its teeth).
    pub teeth: u32,
    /// Nodes that are rigidly tied to the hub: the bore, or the back of a rack.
    pub bore: Vec<u32>,
    /// Flanks as structured grids; a foreign mesh may have fewer than two per tooth. Numbers from that of the nodes on
    /// are those of tied points.
    pub flanks: Vec<FlankGrid>,
    /// Points of flanks that are no nodes, where the mesh of the flanks is no grid.
    pub tied: Vec<TiedPoint>,
}

/// A flank point tied to the nodes of its face: nodes with their weights, which add up to 1. Its displacement is the
/// weighted sum of theirs, and a force on it is distributed to them by the same weights.
#[derive(Clone, Debug, PartialEq)]
pub struct TiedPoint(pub Vec<(u32, f64)>);

impl GearMesh {
    /// Returns the nodes to which a flank point is tied, with their weights; a node is tied to itself.
    pub fn follows(&self, point: u32) -> Vec<(u32, f64)> {
        match (point as usize).checked_sub(self.mesh.nodes.len()) {
            None => vec![(point, 1.0)],
            Some(tied) => self.tied.get(tied).map_or(Vec::new(), |t| t.0.clone()),
        }
    }

    /// Moves the nodes of the flanks by the deviations of their teeth; those within follow the forces only.
    pub fn deviate(&mut self, gear: &gearbench_models::geometry::Gear) {
        for grid in &mut self.flanks {
            grid.deviate(gear);
            for (node, x) in grid.nodes.iter().zip(&grid.positions) {
                // Tied points move by themselves: the nodes within follow the forces only.
                if let Some(node) = self.mesh.nodes.get_mut(*node as usize) {
                    *node = *x;
                }
            }
        }
    }
}
