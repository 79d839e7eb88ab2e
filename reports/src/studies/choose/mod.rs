//! The study of model choice: requirement, hierarchy of models, candidates that were run on a window, and the choice.

mod chart;
pub(super) mod csv;
mod tables;
mod verdict;

use crate::drawing::canvas::DrawError;
use crate::studies::StudyReport;
use maud::Markup;
use serde::{Deserialize, Serialize};
pub use verdict::{Adequacy, Verdict};

/// The cheapest adequate model, integrator and step of a scene, and the data that the choice follows from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ChoiceRecord {
    /// Metric by its name on the command line, such as `force-aligned`.
    pub metric: String,
    /// Name of the metric in words.
    pub metric_title: String,
    /// Largest relative error that is accurate enough [-].
    pub tolerance: f64,
    /// Verdict: a model is adequate, no candidate is, or the yardstick cannot decide. Absent in records of earlier
    /// versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// The model that all others are compared with.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub yardstick: String,
    /// Estimated error of the yardstick itself over the whole scene, by its modes, its mesh and its integration [-];
    /// absent where it is unknown, and then no model is adequate or inadequate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yardstick_error: Option<f64>,
    /// Part of the yardstick's error by its integration, on the window [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yardstick_integration_error: Option<f64>,
    /// Part of the yardstick's error by its mesh, on the window [-]; absent where the mesh cannot be refined.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yardstick_mesh_error: Option<f64>,
    /// Part of the yardstick's error for a history that is not repeatable: change of the metric over the whole scene by
    /// 1 % more stiffness of rigid gears [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scatter: Option<f64>,
    /// Reason why the history is not repeatable; absent where it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_repeatable: Option<String>,
    /// Distances of the yardstick and of the choice to the references of the scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub references: Vec<ReferenceDistance>,
    /// Runs of the scene over which the set-up is distributed; 0 in records of earlier versions, which ranked without it.
    #[serde(skip_serializing_if = "is_zero")]
    pub runs: u64,
    /// Predicted processor time of the choice for all runs with one set-up \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total_cost_s: Option<f64>,
    /// Index of the choice in [`ChoiceRecord::tried`]; absent when nothing is adequate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<usize>,
    /// Estimated error of the choice against the yardstick over the whole scene, or, without a choice, the least of all
    /// candidates [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_error: Option<f64>,
    /// Part of the predicted error by the model, against the top level [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model_error: Option<f64>,
    /// Part of the predicted error by the integrator, against the model's own fine solution [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integration_error: Option<f64>,
    /// Part of the yardstick's error by its modes, on the window [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub top_error: Option<f64>,
    /// Factor by which errors grow from the window to the whole scene [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
    /// Predicted processor time of one run of the whole scene \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_cost_s: Option<f64>,
    /// Processor time of its set-up, with the caches as they were \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub setup_s: Option<f64>,
    /// Description of the window in words.
    pub window: String,
    /// End of the window \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// The reason, a sentence each.
    pub reason: Vec<String>,
    /// Properties of the scene outside of the range in which choices were validated.
    pub outside: Vec<String>,
    /// The hierarchy, simplest model first.
    #[serde(alias = "rungs")]
    pub levels: Vec<LevelRecord>,
    /// Candidates that were run on the window.
    pub tried: Vec<CandidateRecord>,
}

/// A level of the hierarchy.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct LevelRecord {
    /// Name of the level.
    pub name: String,
    /// Family: `rigid`, `movable-teeth`, `quasi-static`, `elastic`.
    pub family: String,
    /// Modes per gear where gears are elastic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes: Option<usize>,
    /// Distance to the top level on the window [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Distance to the next level on the window [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_up: Option<f64>,
    /// Estimated error against the yardstick over the whole scene [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Verdict on the level's error under the tolerance, as far as the yardstick can decide.
    pub adequate: Adequacy,
    /// Forces on the window, where a history does not repeat.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub statistics: Option<ForceStatistics>,
    /// Place of its cheapest adequate candidate in [`ChoiceRecord::tried`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cheapest: Option<usize>,
    /// Processor time of the set-up \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub setup_s: Option<f64>,
    /// Reason why the numbers of the level must not be used, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// A candidate that was run on the window.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct CandidateRecord {
    /// Name of the candidate's level.
    #[serde(alias = "rung")]
    pub level: String,
    /// Family of its level.
    pub family: String,
    /// Integrator of the candidate.
    pub integrator: String,
    /// Fixed step \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
    /// Relative tolerance [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rtol: Option<f64>,
    /// Estimated error against the yardstick over the whole scene [-]; absent where the run failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Predicted processor time for the whole scene \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost_s: Option<f64>,
    /// Number of steps on the window.
    pub steps: u64,
    /// Force evaluations on the window.
    pub force_evaluations: u64,
    /// Verdict on the candidate's error under the tolerance, as far as the yardstick can decide.
    pub adequate: Adequacy,
    /// Reason of the failure, if the run failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// Distances of yardstick and choice to a reference of the scene, in the metric of the requirement, over the whole
/// scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ReferenceDistance {
    /// Name of the reference.
    pub reference: String,
    /// Distance of the yardstick to it [-]; absent where the yardstick was not run or the reference has no such quantity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yardstick: Option<f64>,
    /// Distance of the choice to the reference [-]; absent if it was not run or the reference has no such quantity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<f64>,
}

/// Statistics of a contact force whose history does not repeat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ForceStatistics {
    /// Root mean square \[N\].
    pub rms_n: f64,
    /// Number of intervals of contact.
    pub spells: usize,
    /// Median of the peak forces of these intervals \[N\].
    pub median_peak_n: f64,
    /// Greatest peak of the force \[N\].
    pub greatest_peak_n: f64,
}

fn is_zero(n: &u64) -> bool {
    *n == 0
}

impl CandidateRecord {
    /// Returns the integrator with its step or tolerance.
    #[must_use]
    pub fn method(&self) -> String {
        let at = match (self.step_s, self.rtol) {
            (Some(h), _) => crate::numbers::round_quantity(h, "s", 3),
            (_, Some(r)) => format!("rtol\u{a0}{}", crate::numbers::significant(r, 1)),
            _ => String::new(),
        };
        format!("{} {at}", self.integrator).trim_end().to_owned()
    }
}

impl ChoiceRecord {
    /// Returns the families in the order of the hierarchy; the index is that of their style.
    #[must_use]
    pub fn families(&self) -> Vec<&str> {
        let mut all: Vec<&str> = Vec::new();
        for r in &self.levels {
            if !all.contains(&r.family.as_str()) {
                all.push(&r.family);
            }
        }
        all
    }

    /// Returns the chosen candidate; `None` when nothing is adequate.
    #[must_use]
    pub fn choice(&self) -> Option<&CandidateRecord> {
        self.tried.get(self.chosen?)
    }

    /// Returns the verdict; in records of earlier versions it follows from the presence of a choice.
    #[must_use]
    pub fn answer(&self) -> Verdict {
        self.verdict.unwrap_or(match self.chosen {
            Some(_) => Verdict::Adequate,
            None => Verdict::NoneAdequate,
        })
    }

    /// Returns the verdict on an error against the yardstick [-] under the tolerance. An unknown error counts as
    /// infinite.
    #[must_use]
    pub fn adequacy(&self, error: Option<f64>) -> Adequacy {
        let own = self.yardstick_error.unwrap_or(f64::INFINITY);
        let error = error.unwrap_or(f64::INFINITY);
        Adequacy::of_grown((error, own), self.growth.unwrap_or(1.0), self.tolerance)
    }

    /// Checks the rules that the types do not enforce: the verdict follows from the numbers.
    ///
    /// # Errors
    ///
    /// A sentence that names the rule.
    pub fn validate(&self) -> Result<(), String> {
        let places = self.levels.iter().filter_map(|r| r.cheapest);
        if let Some(i) = places.chain(self.chosen).find(|i| *i >= self.tried.len()) {
            return Err(format!(
                "the choice names candidate {i}, but {} were tried",
                self.tried.len()
            ));
        }
        let Some(verdict) = self.verdict else {
            return Ok(());
        };
        let levels = (self.levels.iter()).map(|l| (l.name.as_str(), l.error, l.adequate));
        let tried = (self.tried.iter()).map(|t| (t.level.as_str(), t.error, t.adequate));
        for (name, error, adequate) in levels.chain(tried) {
            let follows = self.adequacy(error);
            // Earlier records called a level not adequate by its growth alone.
            let earlier = adequate == Adequacy::NotAdequate && follows == Adequacy::NotDecided;
            if adequate != follows && !earlier {
                return Err(format!(
                    "`{name}` is recorded as {adequate}, but {follows} follows from its error"
                ));
            }
        }
        let chosen = self.choice().map(|t| t.adequate);
        let names = match (verdict, chosen) {
            (Verdict::Adequate, of) => of == Some(Adequacy::Adequate),
            (_, of) => of.is_none(),
        };
        if !names {
            return Err(format!(
                "the verdict is `{verdict}`, and the choice names {}",
                chosen.map_or("no candidate", Adequacy::as_str)
            ));
        }
        Ok(())
    }
}

/// The part of a record that is specific to a study of model choice.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ChooseRecord {
    /// The choice, and the data that it follows from.
    pub choice: ChoiceRecord,
}

/// Returns the report of a study of model choice.
pub(super) fn report(choice: &ChoiceRecord) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(choice),
        tables: tables::tables(choice),
        charts: chart::choose(choice)?.into_iter().collect(),
        details: Markup::default(),
        csv: csv::tables(choice),
        ..StudyReport::default()
    })
}
