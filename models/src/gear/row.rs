//! A row of the table of gear models: what a model declares, what it is built from.

use super::elastic::lines::Strips;
use super::model::GearModel;
use super::properties::Properties;
use crate::error::BuildError;
use crate::kinematics::{Hub, MeshView, Placement};
use crate::spec::{Body, Parameters};
use crate::stiffness::Material;

/// What a model is built from.
#[derive(Clone, Copy, Debug)]
pub struct GearContext<'a> {
    /// Name of the gear.
    pub name: &'a str,
    /// Its toothing.
    pub body: &'a Body,
    /// Material of the body.
    pub material: Material,
    /// Its hub, with total inertia.
    pub hub: &'a Hub,
    /// What the hub's inertia holds beyond the body that stands on it [kg m^2] ([kg] of a rack): what is added, and the
    /// core of a solid gear within its seat.
    pub added_inertia: f64,
    /// Where its own frame stands at the assembled position.
    pub placement: Placement,
    /// Base radius [m], or `cos(alpha)` for a rack: deflection on the line of action over hub coordinate.
    pub effective_radius: f64,
    /// How the gear's meshes see it, in order.
    pub meshes: &'a [MeshView],
    /// A mesh of it has friction.
    pub slides: bool,
    /// Its flanks touch along lines, over these strips, where half-spaces give way.
    pub lines: Option<Strips>,
    /// Speed of its hub at the start [rad/s] or [m/s].
    pub speed: f64,
    /// Parameters from the scene.
    pub parameters: &'a Parameters,
}

/// A parameter of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterInfo {
    /// Key with its unit.
    pub key: &'static str,
    /// What it does.
    pub meaning: &'static str,
    /// Must be given.
    pub required: bool,
}

impl ParameterInfo {
    /// A parameter that must be given.
    #[must_use]
    pub const fn required(key: &'static str, meaning: &'static str) -> Self {
        ParameterInfo {
            key,
            meaning,
            required: true,
        }
    }
}

/// Builds a gear model.
pub type Build = fn(&GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError>;

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// Id in scenes and records.
    pub id: &'static str,
    /// One line for lists and help.
    pub title: &'static str,
    /// Parameters it takes; others are refused.
    pub parameters: &'static [ParameterInfo],
    /// What studies may do with it.
    pub properties: Properties,
    /// Builds it.
    pub build: Build,
}

/// What a table says of the model with an id: nothing of one that it does not have, which is refused when it is built.
pub fn properties_of(models: &[Model], id: &str) -> Properties {
    let row = models.iter().find(|m| m.id == id);
    row.map_or(Properties::NONE, |m| m.properties)
}

impl Model {
    /// Builds the model after checking that every parameter is known.
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
