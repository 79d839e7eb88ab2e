//! The table of gear models. A new model is one file and one line in [`MODELS`].

use super::model::GearModel;
use super::properties::Properties;
use super::{movable_teeth, rigid};
use crate::error::BuildError;

pub use super::parameters::ParameterInfo;
pub use super::row::{Build, GearContext, Model, properties_of};

fn build_rigid(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    Ok(Box::new(rigid::Rigid::new(
        context.hub.clone(),
        context.effective_radius,
    )))
}

/// All gear models of this crate.
pub static MODELS: &[Model] = &[
    Model::of::<rigid::RigidParameters>(
        "rigid gear; all compliance in the contact law",
        Properties {
            rigid: true,
            fit: Some(rigid::FIT),
            ..Properties::NONE
        },
        build_rigid,
    ),
    Model::of::<movable_teeth::MovableTeethParameters>(
        "one tangential coordinate per tooth (Ebrahimi, Eberhard 2006)",
        Properties {
            fit: Some(movable_teeth::FIT),
            ..Properties::NONE
        },
        movable_teeth::build,
    ),
];
