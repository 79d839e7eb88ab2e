//! What the study of natural frequencies looks at.

use super::run::Wanted;
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
