//! Parameters of the model `elastic`, as its construction and studies read and change them.

use super::choose::Criterion;
use super::open;
use super::table::{MODEL, PARAMETERS};
use crate::mesh_source::MeshParameters;
use gearbench_models::gear::elastic::SpinTerms;
use gearbench_models::gear::parameters::{ModelParameters, number, whole};
use gearbench_models::gear::table::ParameterInfo;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The parameters; the table of models says what they mean.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[expect(
    missing_docs,
    reason = "the keys of scenes, described in the table of models"
)]
pub struct ElasticParameters {
    pub reduction: Option<String>,
    #[serde(deserialize_with = "whole")]
    pub modes: Option<usize>,
    #[serde(deserialize_with = "number")]
    pub max_frequency_hz: Option<f64>,
    pub choose: Option<Criterion>,
    pub residual: Option<bool>,
    #[serde(deserialize_with = "number")]
    pub target_error: Option<f64>,
    #[serde(deserialize_with = "number")]
    pub damping_ratio: Option<f64>,
    pub rayleigh: Option<[f64; 2]>,
    #[serde(deserialize_with = "number")]
    pub step_s: Option<f64>,
    pub spin_terms: Option<SpinTerms>,
    #[serde(deserialize_with = "number")]
    pub vibration_cut_off: Option<f64>,
    #[serde(flatten)]
    pub mesh: MeshParameters,
}

impl ModelParameters for ElasticParameters {
    const MODEL: &'static str = MODEL;
    const KEYS: &'static [ParameterInfo] = &PARAMETERS;
}

impl ElasticParameters {
    /// Modes kept of a mesh by default.
    pub const MODES: usize = 100;

    /// Limits the number of kept modes, whatever was requested before.
    pub fn with_modes(&mut self, n: usize) {
        self.max_frequency_hz = None;
        self.target_error = None;
        self.modes = Some(n);
    }

    /// Most modes that are kept, by count; `None` where an error or a frequency decides, or where the stored reduction
    /// cannot be read.
    pub fn most_modes(&self) -> Option<usize> {
        match (self.modes, &self.reduction) {
            _ if self.target_error.is_some() => None,
            (Some(n), _) => Some(n),
            _ if self.max_frequency_hz.is_some() => None,
            (None, Some(path)) => {
                let stored = open::open(Path::new(path)).ok()?;
                Some(stored.basis.omega.len())
            }
            (None, None) => Some(Self::MODES),
        }
    }

    /// Truncated modes stay as static compliance.
    pub fn keeps_residual(&self) -> bool {
        self.residual != Some(false)
    }
}
