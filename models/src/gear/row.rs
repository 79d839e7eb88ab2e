//! A row of the table of gear models: the declaration of a model, and the data from which a gear is built.

use super::elastic::lines::Strips;
use super::model::GearModel;
use super::properties::Properties;
use crate::error::BuildError;
use crate::kinematics::{Hub, MeshView, Placement};
use crate::spec::{Body, Parameters};
use crate::stiffness::Material;

/// Data from which a gear is built.
#[derive(Clone, Copy, Debug)]
pub struct GearContext<'a> {
    /// Name of the gear.
    pub name: &'a str,
    /// Body with the toothing of the gear.
    pub body: &'a Body,
    /// Material of the body.
    pub material: Material,
    /// Its hub, with total inertia.
    pub hub: &'a Hub,
    /// Inertia of the hub beyond the body on it [kg m^2] ([kg] of a rack): added inertia, and the core of a solid gear
    /// within its seat.
    pub added_inertia: f64,
    /// Pose of the gear frame at the assembled position.
    pub placement: Placement,
    /// Base radius [m], or `cos(alpha)` for a rack: deflection on the line of action per unit of the hub coordinate.
    pub effective_radius: f64,
    /// Views of the gear from its meshes, in order.
    pub meshes: &'a [MeshView],
    /// True if a mesh of the gear has friction.
    pub slides: bool,
    /// Strips of the width for contact along lines on half-spaces; `None` for other contacts.
    pub lines: Option<Strips>,
    /// Initial speed of the hub [rad/s or m/s].
    pub speed: f64,
    /// Time for which no other teeth come into mesh than those at the start [s]
    /// ([`SceneSpec::time_of_first_teeth`](crate::spec::SceneSpec::time_of_first_teeth)).
    pub time_of_first_teeth: f64,
    /// Parameters from the scene.
    pub parameters: &'a Parameters,
}

/// A parameter of a model, with its description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterInfo {
    /// Key of the parameter, with its unit.
    pub key: &'static str,
    /// Description of the effect of the parameter.
    pub meaning: &'static str,
    /// True if the parameter must be given.
    pub required: bool,
}

impl ParameterInfo {
    /// Declares a parameter that must be given.
    #[must_use]
    pub const fn required(key: &'static str, meaning: &'static str) -> Self {
        ParameterInfo {
            key,
            meaning,
            required: true,
        }
    }
}

/// Constructor of a gear model.
pub type Build = fn(&GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError>;

/// A row of the table of gear models.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// Identifier in scenes and records.
    pub id: &'static str,
    /// One-line description for lists and help.
    pub title: &'static str,
    /// Parameters of the model; others are refused.
    pub parameters: &'static [ParameterInfo],
    /// Properties that determine the studies in which the model can be used.
    pub properties: Properties,
    /// Constructor of a gear.
    pub build: Build,
}

/// Returns the properties of the model with an identifier, or [`Properties::NONE`] for a model that is not in the
/// table, which is refused when it is built.
pub fn properties_of(models: &[Model], id: &str) -> Properties {
    let row = models.iter().find(|m| m.id == id);
    row.map_or(Properties::NONE, |m| m.properties)
}

impl Model {
    /// Builds a gear after checking that every parameter is known.
    pub fn build(&self, context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
        for key in context.parameters.keys() {
            if !self.parameters.iter().any(|p| p.key == key) {
                let known: Vec<&str> = self.parameters.iter().map(|p| p.key).collect();
                let way_out = if known.is_empty() {
                    "it has no parameters".to_string()
                } else {
                    format!("its parameters are {}", known.join(", "))
                };
                return Err(BuildError::parameter(
                    self.id,
                    key,
                    ("is not known", way_out),
                ));
            }
        }
        (self.build)(context)
    }
}
