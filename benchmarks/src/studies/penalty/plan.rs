//! What the study of penalties runs.

use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::run::RunError;
use gearbench_integrators::Scheme;
use gearbench_reference::statics::StaticsError;

/// What to study.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// What all runs share.
    pub conditions: Conditions<'a>,
    /// The model; its penalty is the study's.
    pub entry: Configuration,
    /// The same model with hard contact.
    pub hard: Option<Configuration>,
    /// Integrator, if the model has none of its own.
    pub method: Scheme,
    /// Penalties [Pa/m].
    pub penalties: Vec<f64>,
    /// Force along the line of action of the static equilibria [N]; `None` leaves them out.
    pub load: Option<f64>,
    /// Positions of the static cycle.
    pub positions: usize,
}

/// Why the study ends before its end.
#[derive(Debug, thiserror::Error)]
pub enum PenaltyError {
    /// A run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A static equilibrium.
    #[error("{0}: {1}")]
    Statics(String, StaticsError),
    /// The model's contact has no penalty per area.
    #[error("the contact of `{0}` has no penalty in Pa/m")]
    NoPenalty(String),
}
