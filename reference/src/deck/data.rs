//! What a deck says, with dense numbers inside and the deck's labels beside them.

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
    /// Kind of all of them.
    pub kind: ElementKind,
    /// Set named by `ELSET=`.
    pub set: Option<String>,
    /// Number of the first element, counted through all blocks.
    pub first: u32,
    /// Nodes, [`ElementKind::nodes`] each.
    pub connectivity: Vec<u32>,
    /// The keyword line.
    pub place: Place,
}

/// A material; what the deck left out is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckMaterial {
    /// Young's modulus [Pa] and Poisson's ratio.
    pub elastic: Option<(f64, f64)>,
    /// Density [kg/m^3].
    pub density: Option<f64>,
    /// The keyword line.
    pub place: Place,
}

/// `*SOLID SECTION`.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Element set.
    pub set: String,
    /// Material.
    pub material: String,
    /// The keyword line.
    pub place: Place,
}

/// `*RIGID BODY`.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    /// Node set that moves rigidly.
    pub set: String,
    /// Reference node.
    pub reference: u32,
    /// Node whose displacements are the rotations.
    pub rotation: Option<u32>,
    /// The keyword line.
    pub place: Place,
}

/// A node or a node set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// One node.
    Node(u32),
    /// All nodes of a set.
    Set(String),
}

/// A line of `*BOUNDARY`.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Where.
    pub target: Target,
    /// First and last direction, from 1.
    pub directions: [u8; 2],
    /// Displacement [m] (of a rotation node [rad]).
    pub value: f64,
}

/// A line of `*INITIAL CONDITIONS, TYPE=VELOCITY`.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialVelocity {
    /// Where.
    pub target: Target,
    /// Direction, from 1.
    pub direction: u8,
    /// Velocity [m/s] (of a rotation node [rad/s]).
    pub value: f64,
}

/// `*SURFACE INTERACTION`.
#[derive(Clone, Debug, PartialEq)]
pub struct Interaction {
    /// Slope of a linear pressure over overclosure [Pa/m].
    pub stiffness: Option<f64>,
    /// The keyword line.
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
    /// Slave surface.
    pub slave: String,
    /// Master surface.
    pub master: String,
    /// Interaction.
    pub interaction: String,
    /// Discretisation.
    pub kind: ContactKind,
    /// The data line.
    pub place: Place,
}

/// What a step computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Procedure {
    /// `*STATIC`.
    Static {
        /// Fixed increments.
        direct: bool,
        /// First increment and period, if given.
        times: Option<[f64; 2]>,
    },
    /// `*DYNAMIC`.
    Dynamic {
        /// Fixed increments.
        direct: bool,
        /// Explicit method.
        explicit: bool,
        /// HHT parameter, if given.
        alpha: Option<f64>,
        /// First increment and period [s], if given.
        times: Option<[f64; 2]>,
    },
    /// `*FREQUENCY`.
    Frequency {
        /// Number of modes.
        modes: u32,
    },
}

/// `*STEP` to `*END STEP`.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Large displacements.
    pub nlgeom: bool,
    /// Greatest number of increments, if given.
    pub increments: Option<u32>,
    /// What is computed.
    pub procedure: Procedure,
    /// Boundary conditions of the step.
    pub boundaries: Vec<Boundary>,
    /// Output requests: recognised, and no part of the model.
    pub requests: Vec<String>,
    /// The keyword line.
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
    /// Elements, block by block.
    pub blocks: Vec<ElementBlock>,
    /// Labels of the elements, counted through all blocks.
    pub element_labels: Labels,
    /// Node sets, each node once, in the deck's order.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Element sets, each element once, in the deck's order.
    pub element_sets: BTreeMap<String, Vec<u32>>,
    /// Surfaces made of element faces.
    pub surfaces: BTreeMap<String, Vec<Face>>,
    /// Where node sets, element sets and surfaces were first defined, for messages.
    pub(crate) defined: BTreeMap<String, Place>,
    /// Materials.
    pub materials: BTreeMap<String, DeckMaterial>,
    /// Sections.
    pub sections: Vec<Section>,
    /// Rigid bodies.
    pub rigid_bodies: Vec<RigidBody>,
    /// Boundary conditions of the model.
    pub boundaries: Vec<Boundary>,
    /// Contact interactions.
    pub interactions: BTreeMap<String, Interaction>,
    /// Contact pairs.
    pub contact_pairs: Vec<ContactPair>,
    /// Initial velocities.
    pub initial_velocities: Vec<InitialVelocity>,
    /// Steps.
    pub steps: Vec<Step>,
}

impl Deck {
    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.element_labels.len()
    }

    /// Block of an element.
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
