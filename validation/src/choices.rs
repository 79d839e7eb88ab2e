//! Choices of a model validated on random scenes, and their table.
//!
//! A scene is **met** when the chosen candidate keeps the tolerance against the reference over the whole scene, or when
//! no candidate was chosen and none keeps it. Its **cost ratio** is the time of the chosen candidate over that of the
//! cheapest candidate that keeps the tolerance.

use gearbench_reports::columns::Columns;
use gearbench_reports::numbers::{counted, per_cent, quantile, significant};
use gearbench_reports::record::{Part, Results};
use gearbench_reports::tabular::{TableChart, TabularRecord};
use gearbench_reports::{Format, Metric};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Name of the study and of its table.
pub const NAME: &str = "choice_check";

/// Outcome of a choice against the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// The chosen candidate keeps the tolerance.
    #[serde(rename = "adequate")]
    Adequate,
    /// The chosen candidate exceeds the tolerance.
    #[serde(rename = "inadequate")]
    Inadequate,
    /// No candidate was chosen, and none keeps the tolerance.
    #[serde(rename = "rightly none")]
    RightlyNone,
    /// No candidate was chosen, but at least one keeps the tolerance.
    #[serde(rename = "wrongly none")]
    WronglyNone,
    /// No candidate was chosen because the yardstick of the choice could not decide.
    #[serde(rename = "not decided")]
    NotDecided,
    /// The scene has no reference to validate against.
    #[default]
    #[serde(rename = "not validated", alias = "not judged")]
    NotValidated,
}

impl fmt::Display for Outcome {
    /// Writes the word of the outcome, which is that of tables.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Outcome::Adequate => "adequate",
            Outcome::Inadequate => "inadequate",
            Outcome::RightlyNone => "rightly none",
            Outcome::WronglyNone => "wrongly none",
            Outcome::NotDecided => "not decided",
            Outcome::NotValidated => "not validated",
        })
    }
}

impl Outcome {
    /// True if the choice is correct. A choice that could not decide, and a scene without validation, are not met.
    pub fn is_met(self) -> bool {
        matches!(self, Outcome::Adequate | Outcome::RightlyNone)
    }
}

/// A candidate that was run on the whole scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    pub fn cost_ratio(&self) -> Option<f64> {
        let ratio = self.cost_s? / self.cheapest_cost_s?;
        (self.outcome == Outcome::Adequate && ratio.is_finite()).then_some(ratio)
    }

    /// Returns error over tolerance.
    pub fn error_ratio(&self) -> Option<f64> {
        over(self.error?, self.tolerance)
    }

    /// Returns the predicted error over the error against the reference.
    pub fn prediction_ratio(&self) -> Option<f64> {
        over(self.predicted_error?, self.error?)
    }

    /// Returns the reason why a scene was missed, in words.
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

/// Computes the figures of a group of scenes.
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

/// Returns the validated choices of a record, which are the rows of its table; none of a record of another study.
///
/// # Errors
/// A row that is no validated choice.
pub fn choices_of(results: &Results) -> Result<Vec<ValidatedChoice>, serde_json::Error> {
    match &results.part {
        Part::Tabular(table) if table.name == NAME => table.rows_as(),
        _ => Ok(Vec::new()),
    }
}

/// Returns the columns of scenes.
#[rustfmt::skip]
fn columns<'a>() -> Columns<'a, &'a ValidatedChoice> {
    Columns::<&ValidatedChoice>::of("choice_check.csv", "Check of choices: one row per scene.")
        .add("scene", "name of the scene", |s| s.scene.clone()).shown("Scene", Format::Text)
        .add("kind", "kind of the scene", |s| s.kind.clone()).shown("Kind", Format::Text)
        .add("number", "number of the scene in its set", |s| s.number)
        .add("gears", "its gears", |s| s.gears.clone())
        .add("duration_s", "simulated time", |s| s.duration_s)
        .add("metric", "requested metric", |s| s.metric.key())
        .add("tolerance", "requested tolerance", |s| s.tolerance)
        .add("reference", "reference of the choice", |s| s.reference.clone()).shown("Against", Format::Text)
        .add("reference_error", "error of that reference", |s| s.reference_error).shown("Error of the yardstick", Format::Percents(2))
        .add("mesh_error", "error of the mesh of the scene against the reference, with the same contact", |s| s.mesh_error).shown("Mesh of the scene", Format::Percents(2))
        .add("given_error", "error of mesh and contact of the scene against the reference", |s| s.given_error).shown("Mesh and contact of the scene", Format::Percents(2))
        .add("full_error", "error of the choice against full finite elements on a finer mesh", |s| s.full_error).shown("Error against finite elements", Format::Percents(2))
        .add("densest_error", "error of the elastic model with most modes against these", |s| s.densest_error)
        .add("rejected", "refused candidates", |s| s.rejected)
        .add("candidates", "number of candidates", |s| s.candidates)
        .add("failed", "failed candidates", |s| s.failed)
        .add("cut_short", "candidates that exceeded the time limit", |s| s.cut_short)
        .add("outcome", "result of the choice", |s| s.outcome.to_string()).shown("Outcome", Format::Text).result()
        .add("chosen", "the choice", |s| s.chosen.clone()).shown("Chosen", Format::Text)
        .add("predicted_error", "predicted error", |s| s.predicted_error).shown("Predicted error", Format::Percents(2))
        .add("error", "error of the choice", |s| s.error).shown("Error", Format::Percents(2)).result()
        .add("predicted_cost_s", "predicted processor time of one run of the whole scene", |s| s.predicted_cost_s)
        .add("cost_s", "time of the chosen run", |s| s.cost_s)
        .add("cheapest", "cheapest adequate candidate", |s| s.cheapest.clone())
        .add("cheapest_error", "its error", |s| s.cheapest_error)
        .add("cheapest_cost_s", "its time", |s| s.cheapest_cost_s)
        .add("cost_ratio", "time of the chosen run over that", |s| s.cost_ratio()).shown("Cost over the cheapest adequate", Format::Short(3)).result()
        .add("error_over_tolerance", "error of the choice over the tolerance", |s| s.error_ratio())
        .add("predicted_over_tolerance", "predicted error over the tolerance", |s| over(s.predicted_error?, s.tolerance))
        .add("least_error", "least error of all candidates", |s| s.least_error)
        .add("choosing_s", "processor time of choosing", |s| s.choosing_s)
        .add("refining_s", "set-up time of the finer mesh", |s| s.refining_s)
        .add("note", "note", |s| s.note.clone())
}

/// The remark below the table, which explains its columns of errors.
const LEGEND: &str = "Error of the yardstick: its change by twice the step or fewer modes. Mesh of the scene, mesh and contact: their \
                 error against the yardstick with as many modes, the first with its contact. Finite elements: full ones, on a mesh three \
                 times as fine along the flanks as the scene's, with a penalty.";

/// Returns the table of validated choices, with finding and chart.
pub fn table(choices: &[ValidatedChoice]) -> TabularRecord {
    let columns = columns();
    let mut all: Vec<&ValidatedChoice> = choices.iter().collect();
    all.sort_by_key(|s| s.number);
    TabularRecord {
        name: NAME.into(),
        rows_are: "one row per scene".into(),
        finding: finding(choices),
        columns: columns.recorded(),
        rows: all.iter().map(|s| columns.recorded_row(s)).collect(),
        grouped_by: "kind".into(),
        remark: [groups_and_misses(choices), vec![LEGEND.into()]].concat().join(" "),
        charts: vec![TableChart {
            file: NAME.into(),
            title: "Choices on random scenes".into(),
            caption: "Processor time of the choice over that of the cheapest candidate that keeps the tolerance; error of the choice \
                      over the tolerance, against the reference over the whole scene; error as predicted."
                .into(),
            abscissa: "number".into(),
            ordinates: ["cost_ratio", "error_over_tolerance", "predicted_over_tolerance"]
                .map(String::from)
                .to_vec(),
            magnitudes: true,
            levels: vec![1.0],
            points: true,
            ..TableChart::default()
        }],
        ..TabularRecord::default()
    }
}

/// Returns how choices came out, in plain words.
fn finding(choices: &[ValidatedChoice]) -> Vec<String> {
    let groups = shares(choices);
    let Some(total) = groups.first() else {
        return Vec::new();
    };
    let number = |o: Outcome| choices.iter().filter(|s| s.outcome == o).count();
    let part = total.met as f64 / total.scenes.max(1) as f64;
    let three = |x: f64| significant(x, 3);
    let mut sentences = vec![format!(
        "On {} of {} ({}) the choice does what was asked, {} by saying that nothing tried will do; {} beyond the tolerance, {} an \
         adequate candidate was overlooked, {} the yardstick of the choice could not decide, {} could not be validated.",
        total.met,
        counted(total.scenes, "random scene", "random scenes"),
        per_cent(part, 3),
        counted(number(Outcome::RightlyNone), "time", "times"),
        counted(number(Outcome::Inadequate), "choice is", "choices are"),
        counted(number(Outcome::WronglyNone), "time", "times"),
        counted(number(Outcome::NotDecided), "time", "times"),
        counted(number(Outcome::NotValidated), "scene", "scenes"),
    )];
    if let [Some(low), Some(middle), Some(high), Some(most)] = total.cost_ratio {
        sentences.push(format!(
            "An adequate choice costs {} times the cheapest adequate candidate in the median (quartiles {} and {}, nine tenths below {}).",
            three(middle), three(low), three(high), three(most)
        ));
    }
    if let [Some(low), Some(middle), Some(high), _] = total.prediction {
        sentences.push(format!(
            "Predicted errors are {} times those found in the median (quartiles {} and {}).",
            significant(middle, 2),
            significant(low, 2),
            significant(high, 2)
        ));
    }
    sentences
}

/// Returns the counts by kind, metric and reference, and what was missed.
fn groups_and_misses(choices: &[ValidatedChoice]) -> Vec<String> {
    let groups = shares(choices);
    let mut sentences = Vec::new();
    let parts: Vec<String> = (groups.iter().skip(1))
        .map(|g| format!("{}: {} of {}", g.name, g.met, g.scenes))
        .collect();
    if !parts.is_empty() {
        sentences.push(format!(
            "Met by kind, metric and reference: {}.",
            parts.join("; ")
        ));
    }
    sentences.extend(beyond_the_mesh(choices));
    let missed = choices.iter().filter(|s| !s.outcome.is_met());
    sentences.extend(missed.map(|s| {
        format!(
            "Missed: {} ({}, {} to {}), {}: {}.",
            s.scene,
            s.kind,
            s.metric.words(),
            per_cent(s.tolerance, 2),
            s.outcome,
            s.why_missed()
        )
    }));
    sentences
}

/// Returns sentences on the errors of the scenes' own meshes and contacts, and of choices against full finite elements.
fn beyond_the_mesh(choices: &[ValidatedChoice]) -> Vec<String> {
    let errors = |of: fn(&ValidatedChoice) -> Option<f64>| -> Vec<(f64, f64)> {
        let known = choices.iter().filter_map(|s| Some((of(s)?, s.tolerance)));
        known.collect()
    };
    let median = |of: &[(f64, f64)]| {
        let values: Vec<f64> = of.iter().map(|x| x.0).collect();
        quantile(&values, 0.5).map(|x| per_cent(x, 2))
    };
    let kept = |of: &[(f64, f64)]| of.iter().filter(|(e, t)| e <= t).count();
    let mut sentences = Vec::new();
    let (given, mesh) = (errors(|s| s.given_error), errors(|s| s.mesh_error));
    if let (Some(given_off), Some(mesh_off)) = (median(&given), median(&mesh)) {
        sentences.push(format!(
            "Compared with the refined model, mesh and contact of the scenes themselves are {given_off} off in the median with as \
             many modes, and keep the tolerance in {} of {}; their meshes with its contact are {mesh_off} off and keep it in {} of {}.",
            kept(&given), given.len(), kept(&mesh), mesh.len()
        ));
    }
    let full = errors(|s| s.full_error);
    if !full.is_empty() {
        let model = median(&errors(|s| s.densest_error));
        let model = model.map_or_else(String::new, |off| {
            format!("; the refined model itself is {off} off these in the median")
        });
        sentences.push(format!(
            "Against full finite elements on a finer mesh, which touch with their elements, {} of {} choices keep the tolerance{model}.",
            kept(&full), full.len()
        ));
    }
    sentences
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

    /// A table keeps of each choice all that the summary of results reads.
    #[test]
    fn a_choice_is_a_row_and_a_row_a_choice() {
        let scenes = [
            ValidatedChoice {
                number: 2,
                metric: Metric::ForceL2,
                chosen: Some("rigid, static solves".into()),
                ..validated(Outcome::Adequate, 3.0, 1.0)
            },
            ValidatedChoice {
                number: 1,
                note: Some("no reference".into()),
                ..validated(Outcome::NotValidated, 1.0, 1.0)
            },
        ];
        let results = Results {
            part: Part::Tabular(table(&scenes)),
            ..Results::default()
        };
        let text = serde_json::to_string(&results).unwrap();
        let read: Results = serde_json::from_str(&text).unwrap();
        let found = choices_of(&read).unwrap();
        assert_eq!(found, [scenes[1].clone(), scenes[0].clone()]);
    }
}
