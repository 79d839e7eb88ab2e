//! Meshes of solid elements: nodes, elements in blocks of one kind each, named sets.
//!
//! Nodes and elements are numbered from 0; labels of a deck are its own affair. Element nodes and faces follow Abaqus and
//! CalculiX ([`ElementKind`]); faces `S1` to `S6` are 0 to 5 here ([`Face`]).
//!
//! | part | owns |
//! |---|---|
//! | [`Mesh`], [`Block`], [`Face`] | nodes, elements, sets, surface |
//! | [`ElementKind`] | kinds of elements: nodes, faces, edges |
//! | [`brick`], [`tetrahedra`] | boxes, and hexahedra cut into tetrahedra |
//! | [`quality`] | quality of the elements, volume, moment of inertia |
//! | [`vtu`] | files for ParaView |

mod brick;
mod faces;
mod kind;
mod quality;
mod split;
pub mod vtu;

pub use brick::brick;
pub use faces::{FaceCorners, boundary};
pub use kind::{ElementKind, Shape};
pub use quality::{ElementCheck, ElementQuality, Quality, element_qualities, quality};
pub use split::tetrahedra;

use crate::Vec3;
use std::collections::BTreeMap;

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
