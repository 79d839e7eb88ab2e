//! Plan of a study of natural frequencies.

use super::run::ModesSettings;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;

/// Plan of a study of natural frequencies: conditions, models and range of frequencies.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Conditions of the scene, for the head of the record.
    pub conditions: Conditions,
    /// Models whose natural frequencies are computed.
    pub entries: Vec<Configuration>,
    /// Range of frequencies that are listed for each model.
    pub wanted: ModesSettings,
}
