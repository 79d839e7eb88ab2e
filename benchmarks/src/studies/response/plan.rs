//! Plan of a study of frequency response.

use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;

/// Plan of a study of frequency response: conditions, models and range of frequencies.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Conditions of the scene, for the head of the record.
    pub conditions: Conditions,
    /// Models whose response is computed.
    pub entries: Vec<Configuration>,
    /// Range and resolution of the response of each model.
    pub wanted: FrequencyGrid,
}

/// Range and resolution of the frequency response of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyGrid {
    /// Lowest and highest mesh frequency of the first mesh [Hz]; `None` takes them from its resonance.
    pub range: Option<[f64; 2]>,
    /// Number of mesh frequencies.
    pub points: usize,
    /// Number of phases of a mesh cycle.
    pub phases: usize,
}

impl Default for FrequencyGrid {
    fn default() -> Self {
        FrequencyGrid {
            range: None,
            points: 200,
            phases: 96,
        }
    }
}
