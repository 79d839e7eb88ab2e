//! A row of the table of gear models: the declaration of a model, and the data from which a gear is built.

use super::elastic::lines::Strips;
use super::model::GearModel;
use super::parameters::{ModelParameters, ParameterInfo, Values};
use super::properties::Properties;
use crate::error::BuildError;
use crate::kinematics::{Hub, MeshView, Placement};
use crate::spec::{Body, ModelSpec};
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
    /// Its model, with the parameters from the scene.
    pub model: &'a ModelSpec,
}

impl GearContext<'_> {
    /// Returns the parameters of the gear.
    ///
    /// # Errors
    /// [`BuildError`] if they are those of another model.
    pub fn parameters<T: ModelParameters>(&self) -> Result<&T, BuildError> {
        T::of(self.model).ok_or_else(|| {
            let other = format!("has parameters of the model `{}`", self.model.id());
            BuildError::parameter(T::MODEL, "", other)
        })
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
    /// Reads the parameters of a gear from values by key.
    pub read: fn(Values) -> Result<ModelSpec, BuildError>,
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
    /// Declares a model by its parameters.
    #[must_use]
    pub const fn of<T: ModelParameters>(
        title: &'static str,
        properties: Properties,
        build: Build,
    ) -> Self {
        Model {
            id: T::MODEL,
            title,
            parameters: T::KEYS,
            properties,
            read: |values| T::by_key(values),
            build,
        }
    }

    /// Creates a gear of this model with parameters by their keys.
    ///
    /// # Errors
    /// The first key that is not known, or whose value is none that it takes.
    pub fn spec<K: Into<String>, V: Into<serde_json::Value>>(
        &self,
        values: impl IntoIterator<Item = (K, V)>,
    ) -> Result<ModelSpec, BuildError> {
        let values = values.into_iter().map(|(k, x)| (k.into(), x.into()));
        (self.read)(values.collect())
    }
}
