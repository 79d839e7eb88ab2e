//! What a deck says, with dense numbers inside and the deck's labels beside them.

#![expect(
    missing_docs,
    reason = "fields are called as keywords and options of decks; `place` is the line that says them"
)]

use super::error::Place;
use crate::mesh::{ElementKind, Face};
use gearbench_models::Vec3;
use gearbench_models::stiffness::Material;
use std::collections::BTreeMap;

/// Labels of a deck; their place is their dense number.
pub type Labels = indexmap::IndexSet<u32>;

/// Elements of one `*ELEMENT` block.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementBlock {
    pub kind: ElementKind,
    /// Set named by `ELSET=`.
    pub set: Option<String>,
    /// Number of the first element, counted through all blocks.
    pub first: u32,
    /// Nodes, [`ElementKind::nodes`] each.
    pub connectivity: Vec<u32>,
    pub place: Place,
}

/// A material; what the deck left out is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckMaterial {
    /// Young's modulus [Pa] and Poisson's ratio.
    pub elastic: Option<(f64, f64)>,
    /// Density [kg/m^3].
    pub density: Option<f64>,
    pub place: Place,
}

/// `*SOLID SECTION`.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub set: String,
    pub material: String,
    pub place: Place,
}

/// `*RIGID BODY`.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    pub set: String,
    pub reference: u32,
    /// Node whose displacements are the rotations.
    pub rotation: Option<u32>,
    pub place: Place,
}

/// A node or a node set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    Node(u32),
    Set(String),
}

/// A line of `*BOUNDARY`.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    pub target: Target,
    /// First and last direction, from 1.
    pub directions: [u8; 2],
    /// Displacement [m] (of a rotation node [rad]).
    pub value: f64,
}

/// A line of `*INITIAL CONDITIONS, TYPE=VELOCITY`.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialVelocity {
    pub target: Target,
    pub direction: u8,
    /// Velocity [m/s] (of a rotation node [rad/s]).
    pub value: f64,
}

/// `*SURFACE INTERACTION`.
#[derive(Clone, Debug, PartialEq)]
pub struct Interaction {
    /// Slope of a linear pressure over overclosure [Pa/m].
    pub stiffness: Option<f64>,
    pub place: Place,
}

/// How a contact pair is discretised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactKind {
    /// Points within the slave faces.
    SurfaceToSurface,
    /// Nodes of the slave surface.
    NodeToSurface,
}

/// `*CONTACT PAIR`.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPair {
    pub slave: String,
    pub master: String,
    pub interaction: String,
    pub kind: ContactKind,
    pub place: Place,
}

/// What a step computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Procedure {
    /// `*STATIC`.
    Static {
        direct: bool,
        /// First increment and period, if given.
        times: Option<[f64; 2]>,
    },
    /// `*DYNAMIC`.
    Dynamic {
        direct: bool,
        explicit: bool,
        /// HHT parameter, if given.
        alpha: Option<f64>,
        /// First increment and period [s], if given.
        times: Option<[f64; 2]>,
    },
    /// `*FREQUENCY`.
    Frequency { modes: u32 },
}

/// `*STEP` to `*END STEP`.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub nlgeom: bool,
    /// Greatest number of increments, if given.
    pub increments: Option<u32>,
    pub procedure: Procedure,
    pub boundaries: Vec<Boundary>,
    /// Output requests: recognised, and no part of the model.
    pub requests: Vec<String>,
    pub place: Place,
}

/// A deck that was read. Names are in lower case, for decks do not tell cases apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deck {
    /// File, as it was named.
    pub name: String,
    /// Text of `*HEADING`.
    pub heading: Vec<String>,
    /// Positions [m].
    pub nodes: Vec<Vec3>,
    /// Labels of the nodes.
    pub node_labels: Labels,
    pub blocks: Vec<ElementBlock>,
    /// Labels of the elements, counted through all blocks.
    pub element_labels: Labels,
    /// Node sets, each node once, in the deck's order.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Element sets, each element once, in the deck's order.
    pub element_sets: BTreeMap<String, Vec<u32>>,
    pub surfaces: BTreeMap<String, Vec<Face>>,
    /// Where node sets, element sets and surfaces were first defined, for messages.
    pub(crate) defined: BTreeMap<String, Place>,
    pub materials: BTreeMap<String, DeckMaterial>,
    pub sections: Vec<Section>,
    pub rigid_bodies: Vec<RigidBody>,
    pub boundaries: Vec<Boundary>,
    pub interactions: BTreeMap<String, Interaction>,
    pub contact_pairs: Vec<ContactPair>,
    pub initial_velocities: Vec<InitialVelocity>,
    pub steps: Vec<Step>,
}

impl Deck {
    pub fn element_count(&self) -> usize {
        self.element_labels.len()
    }

    pub fn block(&self, element: u32) -> &ElementBlock {
        let i = self.blocks.partition_point(|b| b.first <= element);
        &self.blocks[i - 1]
    }

    /// Nodes of an element, counted through all blocks.
    pub fn element(&self, element: u32) -> &[u32] {
        let block = self.block(element);
        let n = block.kind.nodes();
        &block.connectivity[(element - block.first) as usize * n..][..n]
    }

    /// Nodes of a target.
    pub fn target<'a>(&'a self, target: &'a Target) -> &'a [u32] {
        match target {
            Target::Node(node) => std::slice::from_ref(node),
            Target::Set(set) => self.node_sets.get(set).map_or(&[], Vec::as_slice),
        }
    }

    /// Name of the material of each element: that of the last section whose set has it.
    pub fn section_materials(&self) -> Vec<Option<&str>> {
        let mut material = vec![None; self.element_count()];
        for section in &self.sections {
            for &e in self.element_sets.get(&section.set).into_iter().flatten() {
                material[e as usize] = Some(section.material.as_str());
            }
        }
        material
    }

    /// A material with all its values.
    pub fn material(&self, name: &str) -> Option<Material> {
        let m = self.materials.get(name)?;
        let (young, poisson) = m.elastic?;
        Some(Material {
            young,
            poisson,
            density: m.density?,
        })
    }
}
