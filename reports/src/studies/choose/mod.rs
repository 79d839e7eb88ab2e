//! What a study of model choice records beside its scene: the requirement, the hierarchy, what was tried, the answer.

mod chart;
mod csv;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::studies::StudyReport;
use maud::Markup;
use serde::{Deserialize, Serialize};

/// The answer to "what is the cheapest that will do", and how it was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ChoiceRecord {
    /// Metric by its name on the command line, such as `force-aligned`.
    pub metric: String,
    /// The metric in words.
    pub metric_title: String,
    /// Largest relative error that is accurate enough [-].
    pub tolerance: f64,
    /// Place of the choice in [`ChoiceRecord::tried`]; none when nothing is adequate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<usize>,
    /// Estimated error of the choice over the whole scene, else the least there is [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_error: Option<f64>,
    /// Part of it by the model, against the top level [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model_error: Option<f64>,
    /// Part of it by the integrator, against the model's own fine solution [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integration_error: Option<f64>,
    /// What the top level is estimated to be off on the window [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub top_error: Option<f64>,
    /// Factor by which errors grow from the window to the whole scene [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
    /// Predicted processor time for the whole scene \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_cost_s: Option<f64>,
    /// Set-up beside it, as it was met \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub setup_s: Option<f64>,
    /// The window in words.
    pub window: String,
    /// Its end \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// The reason, a sentence each.
    pub reason: Vec<String>,
    /// In which ways the scene lies outside of what choices were checked on.
    pub outside: Vec<String>,
    /// The hierarchy, simplest model first.
    #[serde(alias = "rungs")]
    pub levels: Vec<LevelRecord>,
    /// What was run on the window.
    pub tried: Vec<TriedRecord>,
}

/// A level of the hierarchy.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LevelRecord {
    /// Name.
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
    /// Estimated error over the whole scene [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Keeps the tolerance.
    pub adequate: bool,
    /// Place of its cheapest adequate candidate in [`ChoiceRecord::tried`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cheapest: Option<usize>,
    /// Set-up \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub setup_s: Option<f64>,
    /// Why its numbers are not to be used, if so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// A candidate that was run on the window.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TriedRecord {
    /// Its level.
    #[serde(alias = "rung")]
    pub level: String,
    /// Family of its level.
    pub family: String,
    /// Integrator.
    pub integrator: String,
    /// Fixed step \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
    /// Relative tolerance [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rtol: Option<f64>,
    /// Estimated error over the whole scene [-]; none where the run failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Predicted processor time for the whole scene \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost_s: Option<f64>,
    /// Steps on the window.
    pub steps: u64,
    /// Force evaluations on the window.
    pub force_evaluations: u64,
    /// Keeps the tolerance.
    pub adequate: bool,
    /// How the run failed, if so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

impl TriedRecord {
    /// Integrator with its step or tolerance.
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
    /// The families in the order of the hierarchy: their place is their style.
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

    /// What was chosen.
    #[must_use]
    pub fn choice(&self) -> Option<&TriedRecord> {
        self.tried.get(self.chosen?)
    }

    /// Checks the rules that the types do not enforce.
    ///
    /// # Errors
    /// A sentence that names the rule.
    pub fn validate(&self) -> Result<(), String> {
        let places = self.levels.iter().filter_map(|r| r.cheapest);
        match places.chain(self.chosen).find(|i| *i >= self.tried.len()) {
            Some(i) => Err(format!(
                "the choice names candidate {i}, but {} were tried",
                self.tried.len()
            )),
            None => Ok(()),
        }
    }
}

/// What the record of this study has of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChooseRecord {
    /// The answer, and how it was found.
    pub choice: ChoiceRecord,
}

/// What the study says of a record.
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
