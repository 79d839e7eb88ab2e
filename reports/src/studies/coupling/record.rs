//! The record of a study of coupling: models of a scene whose hubs are moved by a host, over the communication step.

use crate::record::{Results, Status, finite};
use crate::studies::Part;
use crate::words::words;
use serde::{Deserialize, Serialize};

/// The part of a record that is specific to a study of coupling.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CouplingRecord {
    /// Couplings, model by model.
    pub couplings: Vec<Coupling>,
}

impl Results {
    /// Returns the couplings of models to a host; empty in records of other studies.
    pub fn couplings(&self) -> &[Coupling] {
        match &self.part {
            Part::Coupling(part) => &part.couplings,
            _ => &[],
        }
    }
}

words! {
    /// Extrapolation of the forces on the hubs over a communication step, by the host.
    pub enum Extrapolation {
        /// The last value is constant over the step.
        Constant = "constant",
        /// The line through the last two.
        Linear = "linear",
        /// The parabola through the last three.
        #[default]
        Quadratic = "quadratic",
    }
}

words! {
    /// Interpolation of the hubs' motion between two communication points, by the gears.
    pub enum Motion {
        /// The straight line between both positions.
        #[default]
        Linear = "linear",
        /// The cubic through both positions with both velocities.
        Cubic = "cubic",
    }
}

/// A model under one extrapolation of forces and one interpolation of motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Coupling {
    /// Id of the model.
    pub model: String,
    /// Variant that distinguishes the model from others of its id.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// True if the truncated modes are kept as residual compliance (elastic model).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual: Option<bool>,
    /// Extrapolation of the forces on the hubs.
    pub extrapolation: Extrapolation,
    /// Interpolation of the motion of the hubs.
    pub motion: Motion,
    /// Integrator of the gears.
    pub integrator: String,
    /// Fixed step of that integrator [s]; absent under a tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
    /// Natural frequency of the hubs on the static stiffness of the gears in contact [Hz].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// Damping ratio of that vibration [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_ratio: Option<f64>,
    /// Time in contact of the run as one system [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_s: Option<f64>,
    /// Reference energy of the energy errors [J]: the energy that vibrates and passes through contacts in the run as
    /// one system.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_j: Option<f64>,
    /// Communication step from which on linear theory has the coupling make up more energy than is allowed [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theory_s: Option<f64>,
    /// Runs, from the smallest communication step to the largest.
    pub cells: Vec<CouplingCell>,
    /// Runs that narrow the bracket of the largest stable step, in the order they were made.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub refined: Vec<CouplingCell>,
}

/// A run in two parts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct CouplingCell {
    /// Communication step [s].
    pub step_s: f64,
    /// Status of the run.
    pub status: Status,
    /// Reason of the status.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Relative L2 error of the force history against the run as one system [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_l2: Option<f64>,
    /// Largest deviation of the last speed of a gear over the span of its speed [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rebound_rel: Option<f64>,
    /// Energy error of the coupling [J]: work of the extrapolated forces on the host, less that of the gears along
    /// their motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_error_j: Option<f64>,
    /// Energy error of the coupling over the energy that vibrates [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_error_rel: Option<f64>,
    /// Largest magnitude of the energy error in one communication step, over the energy that vibrates [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_error_step_rel: Option<f64>,
    /// Simulated time reached [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reached_s: Option<f64>,
    /// Number of communication steps.
    pub exchanges: u64,
}

impl CouplingRecord {
    /// Removes all numbers that are not finite.
    pub(crate) fn keep_finite(&mut self) {
        for c in &mut self.couplings {
            for x in c.cells.iter_mut().chain(&mut c.refined) {
                for value in [
                    &mut x.force_l2,
                    &mut x.rebound_rel,
                    &mut x.energy_error_j,
                    &mut x.energy_error_rel,
                    &mut x.energy_error_step_rel,
                    &mut x.reached_s,
                ] {
                    *value = value.and_then(finite);
                }
            }
        }
    }
}

impl Coupling {
    /// Returns the label of the model with its variant.
    pub fn model_label(&self) -> String {
        match &self.variant {
            Some(variant) => format!("{}, {variant}", self.model),
            None => self.model.clone(),
        }
    }

    /// Returns extrapolation and interpolation in words.
    pub fn manner(&self) -> String {
        match self.motion {
            Motion::Linear => self.extrapolation.to_string(),
            other => format!("{}, {other} motion", self.extrapolation),
        }
    }

    /// Returns all runs, ascending in communication step.
    pub fn all(&self) -> Vec<&CouplingCell> {
        let mut all: Vec<&CouplingCell> = self.cells.iter().chain(&self.refined).collect();
        all.sort_by(|a, b| a.step_s.total_cmp(&b.step_s));
        all
    }

    /// Returns the largest step up to which the condition holds for all runs, and the next one, for which it does not.
    fn up_to(&self, holds: impl Fn(Status) -> bool) -> [Option<f64>; 2] {
        let mut made = self.all();
        made.retain(|c| c.status != Status::Interrupted);
        let held = made.iter().take_while(|c| holds(c.status)).count();
        let step = |i: usize| made.get(i).map(|c| c.step_s);
        [held.checked_sub(1).and_then(step), step(held)]
    }

    /// Returns the largest communication step up to which every run was within the tolerance, and the next one.
    pub fn accurate(&self) -> [Option<f64>; 2] {
        self.up_to(|s| s == Status::Converged)
    }

    /// Returns the largest communication step up to which no run failed, and the next one.
    pub fn stable(&self) -> [Option<f64>; 2] {
        self.up_to(|s| !s.is_failure())
    }
}
