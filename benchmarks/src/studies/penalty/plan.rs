//! What the study of penalties runs.

use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use gearbench_integrators::Scheme;

/// What to study.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
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
