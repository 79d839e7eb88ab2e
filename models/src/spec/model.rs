//! Models of the gears and contacts of a scene.

use super::scene::ContactSpec;
use serde::Serialize;
use std::collections::BTreeMap;

/// A parameter value of a gear model.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number in SI units.
    Number(f64),
    /// A word, such as the name of a variant.
    Text(String),
    /// Numbers, one per tooth or breakpoint.
    List(Vec<f64>),
    /// A truth value.
    Flag(bool),
}

/// Parameters of a gear model by name, in SI units.
pub type Parameters = BTreeMap<String, Value>;

/// Model of a gear, with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelSpec {
    /// Identifier in the table of models.
    pub id: String,
    /// Parameters of the model.
    pub parameters: Parameters,
}

/// Models of the gears and contacts of a scene.
#[derive(Clone, Debug)]
pub struct Modelling {
    /// Model of each gear.
    pub gears: Vec<ModelSpec>,
    /// Contact of each mesh.
    pub contacts: Vec<ContactSpec>,
}
