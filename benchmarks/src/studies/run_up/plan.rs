//! Plan of a run-up: the speed ramp, the models, and the evaluation of the histories.

use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use gearbench_integrators::Scheme;
use serde::Serialize;

/// Linear speed ramp of the reference gear, in place of the scene's own speeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ramp {
    /// Magnitude of the speed of the reference gear at the start [rad/s].
    pub from: f64,
    /// Magnitude of the speed of the reference gear at the end [rad/s].
    pub to: f64,
    /// Duration of the ramp [s].
    pub over: f64,
}

/// Settings of the evaluation of a run-up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EvaluationSettings {
    /// Index of the reference gear in the scene.
    pub gear: usize,
    /// Number of multiples of mesh orders that are followed and shown.
    pub multiples: usize,
    /// Number of whole turns in a window; `None` takes a hundredth of the run.
    pub turns: Option<u32>,
    /// Start of the evaluation [s]; earlier samples are left out.
    pub onset: f64,
    /// Number of samples of the run.
    pub samples: usize,
}

/// Plan of a study of run-ups.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Conditions of the scene, for the head of the record; the duration is that of the run-up.
    pub conditions: Conditions,
    /// Models that are run up.
    pub entries: Vec<Configuration>,
    /// Integrator of models without their own.
    pub method: Scheme,
    /// Speed ramp in place of the scene's own speeds and loads; `None` keeps these.
    pub ramp: Option<Ramp>,
    /// Settings of the evaluation.
    pub look: EvaluationSettings,
}
