//! The record of a run: one model under one integrator, with cost, status and results.

use super::{
    ContactSnapshot, GearMotion, Ledger, MeshForce, Metrics, SELF, Steady, TorquePaths,
    is_not_finite, nan, not_a_number, slug,
};
use crate::histories::Histories;
use crate::metrics::{FinishedRun, Metric, UnfinishedRun};
use crate::series::TimeSeries;
use crate::words::words;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

words! {
    /// Status at the end of a run. Charts draw failed runs by their status.
    pub enum Status {
        /// The run reached its end, and a comparison shows an error within the tolerance.
        #[default]
        Converged = "converged",
        /// The run reached its end with a sound energy balance, but no comparison shows its error.
        Unchecked = "unchecked",
        /// Reached the end beyond the tolerance.
        Inaccurate = "inaccurate",
        /// The energy ledger grew by more than loads and drives supplied.
        EnergyGrowth = "energy growth",
        /// Contact opened and closed without end.
        Chatter = "chatter",
        /// Newton's method did not converge.
        NewtonFailure = "newton failure",
        /// Step control went below the smallest step.
        StepUnderflow = "step underflow",
        /// A state was not finite, or out of all bounds.
        BlowUp = "blow-up",
        /// A tooth passed through another unseen.
        Tunnelling = "tunnelling",
        /// A contact force was adhesive (pulled the flanks together).
        AdhesiveForce = "adhesive force",
        /// The run was stopped for taking too long.
        Timeout = "timeout",
        /// The model cannot run the scene, or would exceed the memory limit: the run was not started.
        Refused = "refused",
        /// The program itself failed in the run.
        Aborted = "aborted",
        /// The study was interrupted before the run was finished.
        Interrupted = "interrupted",
    }
}

impl Status {
    /// True if the run did not reach its end soundly, so that its numbers must not be used.
    pub fn is_failure(self) -> bool {
        !matches!(self, Self::Converged | Self::Unchecked | Self::Inaccurate)
    }

    /// True if the run reached its end and no comparison shows an error beyond the tolerance.
    pub fn holds(self) -> bool {
        matches!(self, Self::Converged | Self::Unchecked)
    }
}

/// One model under one integrator.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Run {
    /// Model id: `rigid`, `movable-teeth`, `elastic`, `fe`.
    pub model: String,
    /// Variant that distinguishes the model from others of its id, such as `k = 3.6e9 N/m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// Id of the integrator.
    pub integrator: String,
    /// True if the integrator is implicit.
    #[serde(default)]
    pub implicit: bool,
    /// True if the integrator solves the linear part of the model exactly.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub exact_linear: bool,
    /// Fixed step \[s\].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub step: Option<f64>,
    /// Relative tolerance of an adaptive method [-].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub rtol: Option<f64>,
    /// Status of the run.
    pub status: Status,
    /// Reason why the run did not converge, with time and amount; or a remark on a run that did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Wall time, the median of the repeats \[s\].
    #[serde(default = "nan", skip_serializing_if = "is_not_finite")]
    pub wall_s: f64,
    /// Shortest and longest wall time of the repeats \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_spread_s: Option<[f64; 2]>,
    /// Processor time of the integration, the median of the repeats \[s\]; it does not depend on other work on the
    /// machine.
    #[serde(default = "nan", skip_serializing_if = "is_not_finite")]
    pub cpu_s: f64,
    /// Number of timed repeats without observers; 0 when the observed run itself was timed.
    #[serde(default)]
    pub repeats: u32,
    /// Fixed cost before the first step: mesh, modes, factorisation \[s\].
    #[serde(default = "nan", skip_serializing_if = "is_not_finite")]
    pub setup_s: f64,
    /// Simulated time reached \[s\].
    #[serde(default = "nan", skip_serializing_if = "is_not_finite")]
    pub simulated_s: f64,
    /// Time that the run should reach \[s\]; it exists while a study runs and is not in records.
    #[serde(skip)]
    pub end_s: Option<f64>,
    /// Number of accepted steps.
    pub steps: u64,
    /// Number of rejected steps.
    pub rejected: u64,
    /// Number of evaluations of the force.
    pub force_evaluations: u64,
    /// Number of Newton iterations.
    pub newton_iterations: u64,
    /// Number of matrix factorisations.
    pub factorisations: u64,
    /// Number of located events.
    #[serde(default)]
    pub events: u64,
    /// Number of degrees of freedom.
    pub dofs: usize,
    /// Calibration of the stiffness, such as `impact`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<String>,
    /// Id of the reference of this record to whose history the constants were fitted, if any: the error against it is
    /// the residual of a fit, not a prediction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fitted_to: Option<String>,
    /// Parameters by gear (`contact A - B` for a mesh) and key, in SI units: numbers as numbers.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, BTreeMap<String, serde_json::Value>>,
    /// Largest number of dynamic modes of a gear (elastic model).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<usize>,
    /// Dynamic modes of each gear in the order of the scene, 0 of a gear that has none (elastic model).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub modes_of_gears: Vec<usize>,
    /// True if the truncated modes are kept as residual compliance (elastic model).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual: Option<bool>,
    /// Criterion by which the modes were chosen, `flank-compliance` or `frequency` (elastic model).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choose: Option<String>,
    /// Highest frequency among its modes \[Hz\] (elastic model).
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub highest_hz: Option<f64>,
    /// Steady state that the run settles to (loaded running).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steady: Option<Steady>,
    /// [`Run::published_s`] is not printed there but follows from other published numbers.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub published_derived: bool,
    /// Time that others publish for such a model \[s\]; see [`crate::studies::compare::CompareRecord`].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub published_s: Option<f64>,
    /// The model's own converged solution that the metrics against `self` refer to; absent unless it is ten times finer
    /// than the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub own_solution: Option<ConvergedSettings>,
    /// One entry per reference the run is compared with.
    #[serde(default)]
    pub metrics: Vec<Metrics>,
    /// Energy and impulse ledger.
    #[serde(default)]
    pub ledger: Ledger,
    /// Paths of torque and power, of trains and shafts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub paths: Option<TorquePaths>,
    /// The contact force of each mesh, of scenes with several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh_forces: Vec<MeshForce>,
    /// CSV files with its histories, in the folder of the record.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
    /// Recorded histories of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<TimeSeries>,
    /// Histories at full resolution, for files of their own; they exist while a study runs and in its journal, not in
    /// records.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub histories: Option<Histories>,
    /// The mesh at peak force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contacts: Option<ContactSnapshot>,
    /// Motion of the gears at some instants, of one run of each model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<GearMotion>,
}

/// Method, step and tolerance of a model's own converged solution.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ConvergedSettings {
    /// Id of the integrator.
    pub integrator: String,
    /// Fixed step \[s\].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub step: Option<f64>,
    /// Relative tolerance [-].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub rtol: Option<f64>,
    /// Number of accepted steps.
    pub steps: u64,
}

impl From<&Run> for ConvergedSettings {
    fn from(run: &Run) -> Self {
        ConvergedSettings {
            integrator: run.integrator.clone(),
            step: run.step,
            rtol: run.rtol,
            steps: run.steps,
        }
    }
}

impl fmt::Display for ConvergedSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.integrator)?;
        match (self.step, self.rtol) {
            (Some(h), _) => write!(f, ", step {h:.0e} s"),
            (None, Some(rtol)) => write!(f, ", rtol {rtol:.0e}"),
            (None, None) => Ok(()),
        }
    }
}

impl Run {
    /// Makes a run with model and variant alone: the variant is the label without the model's id in front.
    pub fn called(label: &str, model: &str) -> Run {
        let rest = (label.strip_prefix(model)).and_then(|rest| rest.strip_prefix('-'));
        Run {
            model: model.to_owned(),
            variant: (label != model).then(|| rest.unwrap_or(label).to_owned()),
            ..Run::default()
        }
    }

    /// Returns the label of the model with its variant: runs with the same label differ by integrator only.
    pub fn model_label(&self) -> String {
        match &self.variant {
            Some(variant) => format!("{}, {variant}", self.model),
            None => self.model.clone(),
        }
    }

    /// Returns the processor time of the integration \[s\], which does not depend on other work on the machine; for
    /// records without it the wall time.
    pub fn cost_s(&self) -> f64 {
        match self.cpu_s {
            x if x.is_finite() && x > 0.0 => x,
            _ => self.wall_s,
        }
    }

    /// Returns the error of integration in a metric: that against the model's own converged solution. For errors of a
    /// force history the L1 error stands where there is no other. `None` where it is not known.
    pub fn integration_error(&self, metric: Metric) -> Option<f64> {
        let own = self.against(SELF)?;
        let of_force = matches!(metric, Metric::ForceL2 | Metric::ForceL2Aligned);
        let error = own
            .get(metric)
            .or_else(|| own.force_l1.filter(|_| of_force));
        error.map(f64::abs)
    }

    /// True if the error of integration exceeds a limit, so that an error against a reference within it is chance: the
    /// step has the error of the step of the reference, or errors cancel, while the model itself may be further away.
    pub fn agrees_by_chance(&self, metric: Metric, limit: f64) -> bool {
        self.integration_error(metric).is_some_and(|e| e > limit)
    }

    /// Returns the history of the run if it reached its end, so that metrics can be computed from it.
    ///
    /// # Errors
    /// [`UnfinishedRun`] when it has no history, or one that ends before the run was to end.
    pub fn finished(&self) -> Result<FinishedRun<'_>, UnfinishedRun> {
        let end_s = self.end_s.unwrap_or(self.simulated_s);
        match &self.series {
            Some(series) => FinishedRun::reached(series, &self.ledger, [self.simulated_s, end_s]),
            None => Err(UnfinishedRun {
                reached_s: f64::NEG_INFINITY,
                end_s,
            }),
        }
    }

    /// Returns the metrics against one reference.
    pub fn against(&self, reference: &str) -> Option<&Metrics> {
        self.metrics.iter().find(|m| m.against == reference)
    }

    /// Returns the file name without ending, unique through `index`, the run's place in the record.
    pub fn file_stem(&self, index: usize) -> String {
        let mut stem = format!("run{:02}", index + 1);
        for part in [
            self.model.as_str(),
            self.variant.as_deref().unwrap_or(""),
            self.integrator.as_str(),
        ] {
            let slug = slug(part);
            if !slug.is_empty() {
                stem.push('-');
                stem.push_str(&slug);
            }
        }
        stem
    }
}
