//! The validation of model choices on random scenes.
//!
//! A scene is **met** when the chosen candidate keeps the tolerance against the reference over the whole scene, or when
//! no candidate was chosen and none keeps it. Its **cost ratio** is the time of the chosen candidate over that of the
//! cheapest candidate that keeps the tolerance.

mod chart;
pub(super) mod csv;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::metrics::Metric;
use crate::record::Results;
use crate::studies::{Part, StudyReport};
use crate::words::words;
use serde::{Deserialize, Serialize};

words! {
    /// Outcome of a choice against the reference.
    pub enum Outcome {
        /// The chosen candidate keeps the tolerance.
        Adequate = "adequate",
        /// The chosen candidate exceeds the tolerance.
        Inadequate = "inadequate",
        /// No candidate was chosen, and none keeps the tolerance.
        RightlyNone = "rightly none",
        /// No candidate was chosen, but at least one keeps the tolerance.
        WronglyNone = "wrongly none",
        /// No candidate was chosen because the yardstick of the choice could not decide.
        NotDecided = "not decided",
        /// The scene has no reference to validate against.
        #[default]
        #[serde(alias = "not judged")]
        NotValidated = "not validated",
    }
}

impl Outcome {
    /// True if the choice is correct. A choice that could not decide, and a scene without validation, are not met.
    #[must_use]
    pub fn is_met(self) -> bool {
        matches!(self, Outcome::Adequate | Outcome::RightlyNone)
    }
}

/// A candidate that was run on the whole scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ValidatedCandidate {
    /// Name of the candidate.
    pub name: String,
    /// Error against the reference; absent when it failed, or costs more than the cheapest that is adequate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Time on a processor \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost_s: Option<f64>,
    /// `adequate`, `inadequate`, `dearer`, `skipped`, or how it failed.
    pub status: String,
}

/// A choice on one scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ValidatedChoice {
    /// Name of the scene.
    pub scene: String,
    /// Number of the scene in the set.
    pub number: usize,
    /// Kind of motion in the scene, the key by which scenes are grouped.
    pub kind: String,
    /// Gears of the scene in words.
    pub gears: String,
    /// Simulated time \[s\].
    pub duration_s: f64,
    /// Metric of the requirement.
    pub metric: Metric,
    /// Largest error that is accurate enough [-].
    pub tolerance: f64,
    /// Reference that errors are taken against.
    pub reference: String,
    /// Estimated error of the reference: the larger of its changes by twice the step and by fewer modes [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_error: Option<f64>,
    /// Error of the scene's own mesh against the reference, with as many modes and the same contact [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_error: Option<f64>,
    /// Error of the scene's own mesh and contact together against the reference, with as many modes [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub given_error: Option<f64>,
    /// Error of the choice against full finite elements on a finer mesh [-]; absent where these were not run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_error: Option<f64>,
    /// Error of the elastic model with most modes against full finite elements [-]; absent where these were not run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub densest_error: Option<f64>,
    /// Samples that were not sound before this scene.
    #[serde(alias = "redraws")]
    pub rejected: u32,
    /// Number of candidates of the choice.
    pub candidates: usize,
    /// Number of candidates that failed.
    pub failed: usize,
    /// Number of candidates that were stopped early because they could not be the cheapest.
    pub cut_short: usize,
    /// Outcome of the choice against the reference.
    pub outcome: Outcome,
    /// The candidate that was chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<String>,
    /// Error of the chosen candidate as predicted by the choice [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_error: Option<f64>,
    /// Error of the chosen candidate against the reference [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Processor time of the chosen candidate as predicted by the choice \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_cost_s: Option<f64>,
    /// Processor time of the chosen candidate \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost_s: Option<f64>,
    /// The cheapest candidate that keeps the tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cheapest: Option<String>,
    /// Error of the cheapest adequate candidate [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cheapest_error: Option<f64>,
    /// Processor time of the cheapest adequate candidate, measured in turn with that of the choice \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cheapest_cost_s: Option<f64>,
    /// Least error of all candidates that were run to the end [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_error: Option<f64>,
    /// Time of the choice itself \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choosing_s: Option<f64>,
    /// Part of that time for setting up the finer mesh, with the caches as they were \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refining_s: Option<f64>,
    /// Properties of the scene outside of the range in which choices have been validated, as the choice states them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<String>,
    /// Reason why the scene could not be validated, or why there is no choice.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// All candidates; left out of stored records.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tried: Vec<ValidatedCandidate>,
}

impl ValidatedChoice {
    /// Returns the cost of the choice over that of the cheapest adequate candidate, where the choice is adequate.
    #[must_use]
    pub fn cost_ratio(&self) -> Option<f64> {
        let ratio = self.cost_s? / self.cheapest_cost_s?;
        (self.outcome == Outcome::Adequate && ratio.is_finite()).then_some(ratio)
    }

    /// Returns error over tolerance.
    #[must_use]
    pub fn error_ratio(&self) -> Option<f64> {
        over(self.error?, self.tolerance)
    }

    /// Returns the predicted error over the error against the reference.
    #[must_use]
    pub fn prediction_ratio(&self) -> Option<f64> {
        over(self.predicted_error?, self.error?)
    }

    /// Returns the reason why a scene was missed, in words.
    #[must_use]
    pub fn why_missed(&self) -> String {
        let percent =
            |x: Option<f64>| x.map_or_else(|| "no error".into(), |e| format!("{:.2} %", 100.0 * e));
        match self.outcome {
            Outcome::Adequate | Outcome::RightlyNone => String::new(),
            Outcome::Inadequate => format!(
                "{} found, {} predicted, {} allowed",
                percent(self.error),
                percent(self.predicted_error),
                percent(Some(self.tolerance))
            ),
            Outcome::WronglyNone => format!(
                "{} has {}{}",
                self.cheapest.as_deref().unwrap_or("a candidate"),
                percent(self.cheapest_error),
                self.note
                    .as_ref()
                    .map_or(String::new(), |n| format!("; {n}"))
            ),
            Outcome::NotDecided | Outcome::NotValidated => self.note.clone().unwrap_or_default(),
        }
    }
}

fn over(a: f64, b: f64) -> Option<f64> {
    let ratio = a / b;
    (ratio.is_finite() && ratio >= 0.0).then_some(ratio)
}

/// Figures of a group of scenes.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// Common property of the scenes in the group.
    pub name: String,
    /// Number of scenes in the group.
    pub scenes: usize,
    /// Number of scenes that are met.
    pub met: usize,
    /// Number of these scenes without any adequate candidate, as the choice stated.
    pub rightly_none: usize,
    /// Quartiles and 90 % point of the cost ratios.
    pub cost_ratio: [Option<f64>; 4],
    /// Quartiles and 90 % point of predicted over true errors.
    pub prediction: [Option<f64>; 4],
}

/// Quantiles of the ratios in [`Share`].
pub const QUANTILES: [f64; 4] = [0.25, 0.5, 0.75, 0.9];

/// Computes a quantile of the finite values, in any order, by linear interpolation between neighbours.
#[must_use]
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let place = part.clamp(0.0, 1.0) * last as f64;
    let (low, rest) = (place.floor() as usize, place.fract());
    let high = (low + 1).min(last);
    Some(sorted[low] + rest * (sorted[high] - sorted[low]))
}

/// Computes the figures of a group of scenes.
#[must_use]
pub fn share(name: &str, scenes: &[&ValidatedChoice]) -> Share {
    let quantiles = |get: fn(&ValidatedChoice) -> Option<f64>| {
        let values: Vec<f64> = scenes.iter().filter_map(|s| get(s)).collect();
        QUANTILES.map(|part| quantile(&values, part))
    };
    let count = |f: fn(&ValidatedChoice) -> bool| scenes.iter().filter(|s| f(s)).count();
    Share {
        name: name.into(),
        scenes: scenes.len(),
        met: count(|s| s.outcome.is_met()),
        rightly_none: count(|s| s.outcome == Outcome::RightlyNone),
        cost_ratio: quantiles(ValidatedChoice::cost_ratio),
        prediction: quantiles(|s| s.prediction_ratio().filter(|r| *r > 0.0)),
    }
}

/// Computes the figures of all scenes, then by kind, by metric and by reference.
#[must_use]
pub fn shares(scenes: &[ValidatedChoice]) -> Vec<Share> {
    let all: Vec<&ValidatedChoice> = scenes.iter().collect();
    let mut found = vec![share("all", &all)];
    let keys: [fn(&ValidatedChoice) -> &str; 3] =
        [|s| &s.kind, |s| s.metric.words(), |s| &s.reference];
    for key in keys {
        let mut names: Vec<&str> = all.iter().map(|s| key(s)).collect();
        names.sort_unstable();
        names.dedup();
        for name in names {
            let of: Vec<&ValidatedChoice> =
                all.iter().filter(|s| key(s) == name).copied().collect();
            found.push(share(name, &of));
        }
    }
    found
}

/// The part of a record that is specific to a validation of choices.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ChoiceCheckRecord {
    /// Choices of a model validated on random scenes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<ValidatedChoice>,
}

impl Results {
    /// Returns the validated choices; empty in records of other studies.
    pub fn choices(&self) -> &[ValidatedChoice] {
        match &self.part {
            Part::ChoiceCheck(part) => &part.choices,
            _ => &[],
        }
    }
}

/// Returns the report of a validation of choices.
pub(super) fn report(choices: &[ValidatedChoice]) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(choices),
        tables: tables::tables(choices),
        charts: chart::choice_check(choices)?,
        details: tables::scenes(choices),
        csv: csv::tables(choices),
        ..StudyReport::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn validated(outcome: Outcome, cost: f64, cheapest: f64) -> ValidatedChoice {
        ValidatedChoice {
            kind: if cost > 2.0 { "a" } else { "b" }.into(),
            metric: Metric::PeakForceRel,
            reference: "fe".into(),
            tolerance: 0.05,
            outcome,
            predicted_error: Some(0.02),
            error: Some(0.01),
            cost_s: Some(cost),
            cheapest_cost_s: Some(cheapest),
            ..ValidatedChoice::default()
        }
    }

    #[test]
    fn quantiles_of_small_samples() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[3.0], 0.9), Some(3.0));
        assert_eq!(quantile(&[4.0, 1.0, f64::NAN, 2.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[0.0, 10.0], 0.25), Some(2.5));
    }

    /// A miss has no cost ratio: to be cheap and wrong is no merit. What could not be validated is not met.
    #[test]
    fn figures_of_a_set() {
        let scenes = [
            validated(Outcome::Adequate, 3.0, 1.0),
            validated(Outcome::Adequate, 1.0, 1.0),
            validated(Outcome::Inadequate, 0.1, 1.0),
            validated(Outcome::WronglyNone, 1.0, 1.0),
            validated(Outcome::RightlyNone, 1.0, 1.0),
            validated(Outcome::NotValidated, 1.0, 1.0),
            validated(Outcome::NotDecided, 1.0, 1.0),
        ];
        let found = shares(&scenes);
        let all = &found[0];
        assert_eq!((all.scenes, all.met, all.rightly_none), (7, 3, 1));
        assert_eq!(all.cost_ratio[1], Some(2.0));
        assert_eq!(all.prediction[1], Some(2.0));
        let names: Vec<&str> = found.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["all", "a", "b", "peak-force error", "fe"]);
        assert_eq!((found[1].scenes, found[1].met), (1, 1));
        assert!(scenes[2].why_missed().contains("5.00 %"));
        assert!(scenes[0].why_missed().is_empty());
    }
}
