//! Plan of a study of the contact penalty.

use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use gearbench_integrators::Scheme;

/// Plan of a study of the contact penalty: model, penalties and comparison with hard contact.
#[derive(Clone, Debug)]
pub struct Plan {
    pub conditions: Conditions,
    /// Model whose contact penalty is varied.
    pub entry: Configuration,
    /// Model with hard contact and otherwise equal settings.
    pub hard: Option<Configuration>,
    /// Integrator, for a model without its own.
    pub method: Scheme,
    /// Contact penalties [Pa/m], one run each.
    pub penalties: Vec<f64>,
    /// Force along the line of action in the static equilibria [N]; `None` leaves them out.
    pub load: Option<f64>,
    /// Number of positions of the static cycle.
    pub positions: usize,
}
