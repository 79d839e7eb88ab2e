//! The yardstick of a comparison: the history that all models are compared with, its own error, and the adequacy of a
//! model.
//!
//! With the error `e` of a run against the yardstick and the error `u` of the yardstick itself, both in the metric of
//! the tolerance `T`, a model is adequate where `e + u <= T`, not adequate where `e - u > T`, and not decided between
//! the two. Where `u` is unknown no model is adequate.

use crate::metrics::Metric;
use crate::numbers::per_cent;
use crate::record::{Run, not_a_number};
use crate::studies::choose::Adequacy;
use crate::words::words;
use serde::{Deserialize, Serialize};

words! {
    /// Kind of a yardstick.
    pub enum Kind {
        /// A stored reference: measured, or computed by another program.
        #[default]
        Stored = "stored",
        /// Elastic gears that gearbench made for the comparison, with a finer mesh and contact on half-spaces.
        Refined = "refined",
        /// The most detailed model of the scene.
        Model = "model",
        /// A model that the scene, or the user, names as the one to compare with: it counts as exact.
        Named = "named",
    }
}

/// The history that the models of a comparison are compared with, and its own error.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Yardstick {
    /// Id of the reference, as in [`crate::record::Metrics::against`].
    pub id: String,
    /// Kind of the yardstick.
    pub kind: Kind,
    /// Name of the yardstick in a sentence.
    pub title: String,
    /// Error of its integration, in the metric of the comparison [-].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub integration_error: Option<f64>,
    /// Error of its truncated modes, in the metric of the comparison [-].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub modes_error: Option<f64>,
    /// Error of its mesh, in the metric of the comparison [-].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub mesh_error: Option<f64>,
    /// Sum of the three errors; absent where one of them is unknown [-].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub error: Option<f64>,
    /// Reason why there is no better yardstick, such as why no refined gears could be made.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

impl Yardstick {
    /// Returns the verdict on an error under a limit. Stored references without a stated error count as exact, and so
    /// do models that the user names.
    pub fn verdict(&self, error: f64, limit: f64) -> Adequacy {
        let own = match (self.error, self.kind) {
            (Some(own), _) => own,
            (None, Kind::Stored | Kind::Named) => 0.0,
            (None, _) => f64::INFINITY,
        };
        Adequacy::of(error, own, limit)
    }

    /// Returns the verdict on a run with an error in a metric: one that keeps the limit by chance
    /// ([`Run::agrees_by_chance`]) is not decided.
    pub fn verdict_on(&self, run: &Run, (metric, error): (Metric, f64), limit: f64) -> Adequacy {
        match self.verdict(error, limit) {
            Adequacy::Adequate if run.agrees_by_chance(metric, limit) => Adequacy::NotDecided,
            verdict => verdict,
        }
    }

    /// Returns the clause on the yardstick's own error, for the end of a sentence.
    pub fn own_error(&self) -> String {
        let parts = [
            ("integration", self.integration_error),
            ("modes", self.modes_error),
            ("mesh", self.mesh_error),
        ];
        let known: Vec<String> = (parts.iter())
            .filter_map(|(what, e)| Some(format!("{what} {}", per_cent((*e)?, 2))))
            .collect();
        match (self.error, self.kind) {
            (Some(all), _) if known.is_empty() => {
                format!("its own error is stated as {}", per_cent(all, 2))
            }
            (Some(all), _) => format!(
                "its own error is estimated as {} ({})",
                per_cent(all, 2),
                known.join(", ")
            ),
            (None, Kind::Stored) => "its own error is not stated".into(),
            (None, Kind::Named) => "it is taken as exact".into(),
            (None, _) if known.is_empty() => "its own error is not known".into(),
            (None, _) => format!(
                "of its own error only a part is known ({})",
                known.join(", ")
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_the_yardstick_leaves_a_band_that_is_not_decided() {
        let of = |error, kind| Yardstick {
            error,
            kind,
            ..Yardstick::default()
        };
        let refined = of(Some(0.01), Kind::Refined);
        let found = [0.03, 0.045, 0.055, 0.07].map(|e| refined.verdict(e, 0.05));
        use Adequacy::{Adequate, NotAdequate, NotDecided};
        assert_eq!(found, [Adequate, NotDecided, NotDecided, NotAdequate]);
        // A model of the scene whose mesh nobody refined decides nothing, a stored reference counts as exact.
        assert_eq!(of(None, Kind::Model).verdict(0.0, 0.05), NotDecided);
        assert_eq!(of(None, Kind::Model).verdict(9.0, 0.05), NotDecided);
        assert_eq!(of(None, Kind::Named).verdict(0.049, 0.05), Adequate);
        assert_eq!(of(None, Kind::Stored).verdict(0.049, 0.05), Adequate);
        assert_eq!(of(None, Kind::Stored).verdict(0.051, 0.05), NotAdequate);
    }
}
