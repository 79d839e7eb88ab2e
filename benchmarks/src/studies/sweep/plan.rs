//! Plan of a sweep of mesh frequencies.

use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use gearbench_integrators::Scheme;
use gearbench_reports::sweep::Branch;

/// Plan of a sweep of mesh frequencies: models, integrator, frequencies and branches.
#[derive(Clone, Debug)]
pub struct Plan {
    pub conditions: Conditions,
    /// Models that are swept.
    pub entries: Vec<Configuration>,
    /// Further models for which only the static cycle is computed.
    pub standing: Vec<Configuration>,
    /// Integrator of models without their own.
    pub method: Scheme,
    /// Mesh frequencies of the sweep [Hz], ascending.
    pub frequencies: Vec<f64>,
    /// Branches of the sweep (speed upwards, downwards, or fresh starts), each at all speeds.
    pub branches: Vec<Branch>,
    /// Number of whole mesh cycles to measure.
    pub cycles: usize,
    /// Settling time before the measurement [s].
    pub settle: f64,
    /// Number of positions of the static cycle.
    pub positions: usize,
}

impl Plan {
    /// Returns the number of runs: frequencies times branches times models.
    pub fn count(&self) -> usize {
        self.frequencies.len() * self.branches.len() * self.entries.len()
    }
}
