//! Content of a deck, with internal numbers and the labels of the deck.

#![expect(
    missing_docs,
    reason = "fields are called as keywords and options of decks; `place` is the line that says them"
)]

use super::error::Place;
use super::reader::NonSolidElements;
use super::units::Units;
use gearbench_solid_fe::Material;
use gearbench_solid_fe::Vec3;
use gearbench_solid_fe::mesh::{ElementKind, Face, Mesh};
use std::collections::BTreeMap;

/// Label of a node or an element. Instances of an assembly count their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Label {
    /// Instance, its place in [`Deck::instances`] from 1; 0 outside instances.
    pub instance: u32,
    pub number: u32,
}

impl From<u32> for Label {
    fn from(number: u32) -> Self {
        Label {
            instance: 0,
            number,
        }
    }
}

/// Labels of a deck; their place is their dense number.
pub type Labels = indexmap::IndexSet<Label>;

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

/// Property of a material beyond isotropic linear elasticity.
#[derive(Clone, Debug, PartialEq)]
pub struct NonlinearProperty {
    /// Keyword line of the property.
    pub keyword: String,
    /// Why it changes the body.
    pub reason: String,
    pub place: Place,
}

/// A material; `None` marks values that the deck does not give.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckMaterial {
    /// Young's modulus [Pa] and Poisson's ratio.
    pub elastic: Option<(f64, f64)>,
    /// Density of the material [kg/m^3].
    pub density: Option<f64>,
    /// Property beyond linear elasticity; a body of such a material is declined.
    pub beyond: Option<NonlinearProperty>,
    pub place: Place,
}

/// Section from a `*SOLID SECTION` keyword.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub set: String,
    pub material: String,
    pub place: Place,
}

/// Rigid body from a `*RIGID BODY` keyword.
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
    /// Some of the nodes have axes of their own (`*TRANSFORM`), which the directions count in.
    pub own_axes: bool,
}

/// A line of `*INITIAL CONDITIONS, TYPE=VELOCITY`.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialVelocity {
    pub target: Target,
    pub direction: u8,
    /// Velocity [m/s] (of a rotation node [rad/s]).
    pub value: f64,
}

/// Contact property from a `*SURFACE INTERACTION` keyword.
#[derive(Clone, Debug, PartialEq)]
pub struct Interaction {
    /// Slope of a linear pressure over overclosure [Pa/m].
    pub stiffness: Option<f64>,
    /// Further keywords, such as friction, which are ignored because they do not change a body.
    pub more: Vec<String>,
    pub place: Place,
}

/// How a contact pair is discretised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactKind {
    /// Points within the slave faces.
    SurfaceToSurface,
    /// Nodes of the slave surface.
    NodeToSurface,
    /// Another formulation, or one for which programs have different defaults.
    Other,
}

/// Contact pair from a `*CONTACT PAIR` keyword.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPair {
    pub slave: String,
    pub master: String,
    pub interaction: String,
    pub kind: ContactKind,
    pub place: Place,
}

/// Procedure of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Procedure {
    /// Static step, `*STATIC`.
    Static {
        direct: bool,
        /// First increment and period, if given.
        times: Option<[f64; 2]>,
    },
    /// Dynamic step, `*DYNAMIC`.
    Dynamic {
        direct: bool,
        explicit: bool,
        /// HHT parameter, if given.
        alpha: Option<f64>,
        /// First increment and period [s], if given.
        times: Option<[f64; 2]>,
    },
    /// Frequency step, `*FREQUENCY`.
    Frequency { modes: u32 },
    /// Another procedure, or none.
    Other,
}

impl Procedure {
    pub(super) fn scale_times(&mut self, by: f64) {
        if let Procedure::Static { times, .. } | Procedure::Dynamic { times, .. } = self {
            *times = times.map(|t| t.map(|t| t * by));
        }
    }
}

/// `*STEP` to `*END STEP`.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub nlgeom: bool,
    /// True for a perturbation about the state at the end of the previous steps.
    pub perturbation: bool,
    /// Greatest number of increments, if given.
    pub increments: Option<u32>,
    pub procedure: Procedure,
    pub boundaries: Vec<Boundary>,
    /// Conditions of the steps before end here.
    pub boundaries_anew: bool,
    /// Output requests: recognised, and no part of the model.
    pub requests: Vec<String>,
    pub place: Place,
}

/// A deck that was read. Names are in lower case, because decks are not case-sensitive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deck {
    /// File, as it was named.
    pub name: String,
    /// Text of `*HEADING`.
    pub heading: Vec<String>,
    /// Units of the deck; everything here is in SI units.
    pub units: Units,
    /// Description of how the units were determined.
    pub units_from: String,
    /// Names of the instances of its assembly.
    pub instances: Vec<String>,
    /// Keywords that change no body and were passed over, with how often they occur.
    pub passed_over: BTreeMap<String, u32>,
    /// Further notes on the reading for the user.
    pub notes: Vec<String>,
    /// Elements that are no solids, by their labels: while the deck is read, see `reader/others.rs`.
    pub(crate) others: NonSolidElements,
    /// Positions of the nodes [m].
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
    /// Lines of the first definition of node sets, element sets and surfaces, for messages.
    pub defined: BTreeMap<String, Place>,
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
    /// Returns notes on the reading of the deck for the user, one per line: units, ignored keywords, and replaced
    /// element types.
    pub fn told(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if !self.units_from.is_empty() {
            lines.push(format!("units {}: {}", self.units.name, self.units_from));
        }
        if !self.passed_over.is_empty() {
            let each = self.passed_over.iter().map(|(k, n)| match n {
                1 => k.clone(),
                n => format!("{n} {k}"),
            });
            lines.push(format!(
                "ignored keywords without influence on the bodies: {}",
                each.collect::<Vec<_>>().join(", ")
            ));
        }
        lines.extend(self.notes.iter().cloned());
        lines
    }

    /// A label as the deck writes it: of an instance with its name in front.
    fn written(&self, label: Label) -> String {
        match (label.instance as usize)
            .checked_sub(1)
            .and_then(|i| self.instances.get(i))
        {
            Some(instance) => format!("{instance}.{}", label.number),
            None => label.number.to_string(),
        }
    }

    /// Label of a node, as the deck writes it.
    pub fn node_name(&self, node: u32) -> String {
        self.written(self.node_labels[node as usize])
    }

    /// Label of an element, as the deck writes it.
    pub fn element_name(&self, element: u32) -> String {
        self.written(self.element_labels[element as usize])
    }

    /// Returns the whole deck as one mesh, with its node sets and the surfaces as sets of faces.
    pub fn mesh(&self) -> Mesh {
        let mut mesh = Mesh {
            nodes: self.nodes.clone(),
            blocks: Vec::new(),
            node_sets: self.node_sets.clone(),
            face_sets: self.surfaces.clone(),
        };
        for block in &self.blocks {
            let nodes = block.connectivity.iter().copied();
            gearbench_solid_fe::mesh::push(&mut mesh.blocks, block.kind, nodes);
        }
        mesh
    }

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
