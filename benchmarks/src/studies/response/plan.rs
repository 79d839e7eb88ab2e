//! What the study of frequency response looks at.

use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;

/// What to study.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// What heads the record.
    pub conditions: Conditions<'a>,
    /// The models.
    pub entries: Vec<Configuration>,
    /// What is wanted of each.
    pub wanted: Wanted,
}

/// What is wanted of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Lowest and highest mesh frequency of the first mesh [Hz]; `None` takes them from its resonance.
    pub range: Option<[f64; 2]>,
    /// Number of frequencies.
    pub points: usize,
    /// Phases of a mesh cycle.
    pub phases: usize,
}

impl Default for Wanted {
    fn default() -> Self {
        Wanted {
            range: None,
            points: 200,
            phases: 96,
        }
    }
}
