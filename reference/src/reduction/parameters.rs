//! Parameters of the model `elastic`, as its construction and studies read and change them.

use super::choose::Criterion;
use super::open;
use crate::mesh_source::MeshParameters;
use gearbench_models::declare_parameters;
use gearbench_models::gear::elastic::SpinTerms;
use gearbench_models::gear::parameters::{number, whole};
use std::path::Path;

declare_parameters! {
    /// Parameters of the model.
    pub struct ElasticParameters model "elastic" {
        /// path of a stored reduction (.npz, made by `gearbench reduce`) in place of a mesh
        reduction: String,
        /// most modes to keep; default 100 (all of a stored reduction, or where `max_frequency_hz` is given), 0 is quasi-static
        #[serde(deserialize_with = "whole")]
        modes: usize,
        /// highest frequency of a mode to keep
        #[serde(deserialize_with = "number")]
        max_frequency_hz: f64,
        /// "teeth-in-mesh": made for the teeth in mesh at the start (default of a short scene without loads in which less than half a pitch passes); "flank-compliance" (default of others): the modes that yield most at the flanks; "frequency": the lowest
        choose: Criterion,
        /// true (default): truncated modes stay as static compliance; false: plain truncation
        residual: bool,
        /// keeps the fewest modes whose estimated error of the force history, relative L2, is this or less
        #[serde(deserialize_with = "number")]
        target_error: f64,
        /// damping ratio of all modes; default 0
        #[serde(deserialize_with = "number")]
        damping_ratio: f64,
        /// [alpha, beta] of the damping alpha M + beta K, in 1/s and s; beta damps the static compliance of cut modes and the contact as well; alpha damps the modes of `elastic`
        rayleigh: [f64; 2],
        /// longest step that shall carry the modes: those above 0.64 pi / step are truncated; default 1e-6
        #[serde(deserialize_with = "number")]
        step_s: f64,
        /// centrifugal and Coriolis terms, which couple the modes: "auto" (default: from a spin rate of 1 % of the lowest frequency), "full" or "none"
        spin_terms: SpinTerms,
        flatten mesh: MeshParameters,
    }
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
