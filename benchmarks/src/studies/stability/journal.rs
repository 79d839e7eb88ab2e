//! What the journal of a map holds: cells and converged solutions.

use crate::experiment::journal;
use gearbench_reports::stability::{Cell, SelfReference};
use serde::{Deserialize, Serialize};

/// The journal of a map.
pub type Journal = journal::Journal<Line>;

/// What a line holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    Cell(Cell),
    Reference(SelfReference),
}

/// A finished run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Which run of the plan.
    pub key: String,
    #[serde(flatten)]
    pub outcome: Outcome,
    /// Wall time [s]: the only part that differs when the run is made again.
    pub wall_s: f64,
}

impl journal::Finished for Line {
    fn key(&self) -> String {
        self.key.clone()
    }
}

impl Journal {
    pub(super) fn cell(&self, key: &str) -> Option<&Cell> {
        match &self.get(key)?.outcome {
            Outcome::Cell(cell) => Some(cell),
            Outcome::Reference(_) => None,
        }
    }

    pub(super) fn reference(&self, key: &str) -> Option<&SelfReference> {
        match &self.get(key)?.outcome {
            Outcome::Reference(reference) => Some(reference),
            Outcome::Cell(_) => None,
        }
    }
}
