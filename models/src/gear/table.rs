//! The table of gear models. A new model is one file and one line in [`MODELS`].

use super::model::GearModel;
use super::properties::Properties;
use super::{movable_teeth, rigid};
use crate::error::BuildError;

pub use super::row::{Build, GearContext, Model, ParameterInfo, properties_of};

fn build_rigid(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    Ok(Box::new(rigid::Rigid::new(
        context.hub.clone(),
        context.effective_radius,
    )))
}

/// All gear models of this crate.
pub static MODELS: &[Model] = &[
    Model {
        id: rigid::MODEL,
        title: "rigid gear; all compliance in the contact law",
        parameters: &[],
        properties: Properties {
            rigid: true,
            fit: Some(rigid::FIT),
            ..Properties::NONE
        },
        build: build_rigid,
    },
    Model {
        id: "movable-teeth",
        title: "one tangential coordinate per tooth (Ebrahimi, Eberhard 2006)",
        parameters: movable_teeth::PARAMETERS,
        properties: Properties {
            fit: Some(movable_teeth::FIT),
            ..Properties::NONE
        },
        build: movable_teeth::build,
    },
];
