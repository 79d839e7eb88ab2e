//! What a sweep runs.

use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::run::RunError;
use gearbench_integrators::Scheme;
use gearbench_reference::statics::StaticsError;

/// What to sweep.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// What all runs share.
    pub conditions: Conditions<'a>,
    /// Models that run.
    pub entries: Vec<Configuration>,
    /// Further models that stand still only.
    pub standing: Vec<Configuration>,
    /// Integrator of models without their own.
    pub method: Scheme,
    /// Mesh frequencies [Hz].
    pub frequencies: Vec<f64>,
    /// Whole mesh cycles to measure.
    pub cycles: usize,
    /// Time to settle [s], mesh cycles or not.
    pub settle: f64,
    /// Positions of the static cycle.
    pub positions: usize,
}

/// Why a sweep ends before its end.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The scene cannot be swept.
    #[error("{0}")]
    Scene(String),
    /// A static equilibrium.
    #[error("{0}: {1}")]
    Statics(String, StaticsError),
}
