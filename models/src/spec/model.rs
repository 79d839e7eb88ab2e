//! Models of the gears and contacts of a scene.

use super::scene::ContactSpec;
use crate::error::BuildError;
use crate::gear::parameters::{AnyParameters, Values};
use serde_json::Value;
use std::fmt;

/// Model of a gear: the parameters of that model, a struct that implements
/// [`ModelParameters`](crate::gear::parameters::ModelParameters).
pub struct ModelSpec {
    pub(crate) parameters: Box<dyn AnyParameters>,
}

impl ModelSpec {
    /// Identifier in the table of models.
    pub fn id(&self) -> &'static str {
        self.parameters.model()
    }

    /// The given parameters by their keys, in SI units.
    pub fn values(&self) -> Values {
        self.parameters.values()
    }

    /// Gives a parameter by its key.
    ///
    /// # Errors
    /// A key that the model does not have, or a value that it does not take.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) -> Result<(), BuildError> {
        let mut values = self.values();
        values.insert(key.to_owned(), value.into());
        self.parameters = self.parameters.read_again(values)?;
        Ok(())
    }

    /// Takes a parameter away: it has its default, or is missing.
    ///
    /// # Errors
    /// [`BuildError`] where the others are none without it.
    pub fn unset(&mut self, key: &str) -> Result<(), BuildError> {
        let mut values = self.values();
        values.remove(key);
        self.parameters = self.parameters.read_again(values)?;
        Ok(())
    }
}

impl Clone for ModelSpec {
    fn clone(&self) -> Self {
        ModelSpec {
            parameters: self.parameters.copied(),
        }
    }
}

impl PartialEq for ModelSpec {
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id() && self.values() == other.values()
    }
}

impl fmt::Debug for ModelSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.id(), self.parameters)
    }
}

/// Models of the gears and contacts of a scene.
#[derive(Clone, Debug)]
pub struct Modelling {
    /// Model of each gear.
    pub gears: Vec<ModelSpec>,
    /// Contact of each mesh.
    pub contacts: Vec<ContactSpec>,
}
