//! How the gears and contacts of a scene are modelled.

use super::scene::ContactSpec;
use serde::Serialize;
use std::collections::BTreeMap;

/// A parameter value of a gear model.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A word.
    Text(String),
    /// Numbers, one per tooth or breakpoint.
    List(Vec<f64>),
    /// Yes or no.
    Flag(bool),
}

/// Parameters of a gear model by name, in SI units.
pub type Parameters = BTreeMap<String, Value>;

/// Which model a gear takes.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelSpec {
    /// Id in the table of models.
    pub id: String,
    /// Its parameters.
    pub parameters: Parameters,
}

/// How the gears and contacts of a scene are modelled.
#[derive(Clone, Debug)]
pub struct Modelling {
    /// One model per gear.
    pub gears: Vec<ModelSpec>,
    /// One contact per mesh.
    pub contacts: Vec<ContactSpec>,
}
