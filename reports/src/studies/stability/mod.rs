//! The study of stability: maps of how runs ended over step and parameters, and the largest stable step.
//!
//! A map belongs to one model under one integrator. A row has one value of every axis, and its cells go from the
//! smallest to the largest step (or tolerance, for methods with step control). Every cell has exactly one [`Status`].

mod charts;
pub(super) mod csv;
mod limit;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::record::checks::{each, same_length};
use crate::record::{Results, Status};
use crate::studies::{Part, StudyReport};
use crate::words::words;
pub use csv::timings;
pub use limit::{BRACKET, Limit, is_lost};
use maud::Markup;
use serde::{Deserialize, Serialize};

words! {
    /// Quantity along the columns of a map.
    pub enum Columns {
        /// Fixed steps \[s\].
        #[default]
        Step = "step_s",
        /// Relative tolerances [-].
        Tolerance = "rtol",
    }
}

/// A parameter that a map varies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MapAxis {
    /// Id, such as `contact-stiffness`.
    pub id: String,
    /// Name for axes, such as `contact stiffness over the scene's`.
    pub name: String,
    /// Unit, empty for ratios and counts.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Values of the parameter, ascending.
    pub values: Vec<f64>,
    /// Place of the scene's own value among them.
    pub own: usize,
}

/// Status and work of one run of a map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Cell {
    /// Step \[s\] or relative tolerance [-].
    pub at: f64,
    /// Status of the run.
    pub status: Status,
    /// Reason of the status, or a remark on the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Error against the model's own converged solution, in the metric of the tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Energy that the integration made up or lost, over the largest energy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy_rel: Option<f64>,
    /// Simulated time reached \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reached_s: Option<f64>,
    /// Number of accepted steps.
    pub steps: u64,
    /// Number of rejected steps.
    pub rejected: u64,
    /// Number of evaluations of the force.
    pub force_evaluations: u64,
    /// Number of Newton iterations.
    pub newton_iterations: u64,
}

words! {
    /// Kind of a line of theory.
    pub enum LineKind {
        /// Beyond this step the linear system grows.
        #[default]
        Stability = "stability",
        /// At this step the method resonates with a mode.
        Resonance = "resonance",
        /// The step that follows from the frequency of the contact's penalty.
        Penalty = "penalty",
    }
}

/// A line of theory over the rows of a map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MapLine {
    /// Label of the line, such as `omega_max h = 2`.
    pub label: String,
    /// Kind of the line.
    pub kind: LineKind,
    /// Step of every row \[s\]; none where theory has none.
    pub step_s: Vec<Option<f64>>,
}

/// The model's own converged solution that the cells of a row are compared with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SelfReference {
    /// Method and tolerance of the solution and of the run that checks it.
    pub method: String,
    /// Distance of the two in the metric of the tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checked: Option<f64>,
    /// Reason why there is no solution; the cells are then classified by the energy ledger alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// One model under one integrator over steps and parameters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Map {
    /// Maps of one set share axes and duration.
    pub set: usize,
    /// Id of the model.
    pub model: String,
    /// Variant that distinguishes the model from others of its id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// Integrator with its parameters.
    pub integrator: String,
    /// True if the integrator is implicit.
    pub implicit: bool,
    /// Simulated time \[s\].
    pub duration_s: f64,
    /// Quantity along the columns.
    pub columns: Columns,
    /// Steps or tolerances, ascending.
    pub at: Vec<f64>,
    /// One or two parameters that the map varies.
    pub axes: Vec<MapAxis>,
    /// The cells: along the columns first, then along the first axis, then along the second.
    pub cells: Vec<Cell>,
    /// Runs at the scene's own parameters that narrow the bracket of the largest stable step, in the order they were
    /// made.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refined: Vec<Cell>,
    /// Lines of theory over the map.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<MapLine>,
    /// Converged solutions, one per row.
    pub references: Vec<SelfReference>,
}

/// Returns each pair of model and integrator once, by its first map; several sets may contain the pair.
pub(crate) fn unique_pairs<'a>(maps: impl IntoIterator<Item = &'a Map>) -> Vec<&'a Map> {
    let mut found: Vec<&Map> = Vec::new();
    for map in maps {
        let same =
            |o: &&Map| o.model_label() == map.model_label() && o.integrator == map.integrator;
        if !found.iter().any(same) {
            found.push(map);
        }
    }
    found
}

impl Map {
    /// Returns the label of the model with its variant.
    pub fn model_label(&self) -> String {
        match &self.variant {
            Some(variant) => format!("{}, {variant}", self.model),
            None => self.model.clone(),
        }
    }

    /// Returns the number of rows, one per combination of parameter values.
    pub fn rows(&self) -> usize {
        self.axes.iter().map(|a| a.values.len()).product()
    }

    /// Returns the index of the row of the scene's own parameters.
    pub fn own_row(&self) -> usize {
        let second = self.axes.get(1).map_or(0, |a| a.own);
        let (own, length) = (self.axes.first()).map_or((0, 1), |a| (a.own, a.values.len()));
        second * length + own
    }

    /// Returns the cells of a row.
    pub fn row(&self, row: usize) -> &[Cell] {
        let n = self.at.len();
        self.cells.get(row * n..(row + 1) * n).unwrap_or(&[])
    }

    /// Returns the values of the axes in a row.
    pub fn values(&self, row: usize) -> Vec<f64> {
        let mut rest = row;
        let mut value = |a: &MapAxis| {
            let n = a.values.len().max(1);
            let found = a.values.get(rest % n).copied().unwrap_or(0.0);
            rest /= n;
            found
        };
        self.axes.iter().map(&mut value).collect()
    }

    /// Returns the number of cells of each status, in the order of [`Status::ALL`].
    pub fn counts(&self) -> [usize; Status::ALL.len()] {
        Status::ALL.map(|s| self.cells.iter().filter(|c| c.status == s).count())
    }

    /// Checks the rules that the types do not enforce.
    ///
    /// # Errors
    /// A sentence that names the rule.
    pub fn validate(&self) -> Result<(), String> {
        if self.axes.is_empty() || self.axes.len() > 2 {
            return Err(format!(
                "axes has {} entries, expected 1 or 2",
                self.axes.len()
            ));
        }
        each("axes", &self.axes, |a| match a.own < a.values.len() {
            true => Ok(()),
            false => Err(format!(
                "own is {}, expected less than {} as `values`",
                a.own,
                a.values.len()
            )),
        })?;
        let cells = self.rows().saturating_mul(self.at.len());
        same_length("cells", self.cells.len(), "rows times `at`", cells)?;
        if self.at.is_empty() || !self.at.iter().all(|x| *x > 0.0 && x.is_finite()) {
            return Err("at has an entry that is not above zero, or none".into());
        }
        each("lines", &self.lines, |l| {
            same_length("step_s", l.step_s.len(), "rows", self.rows())
        })?;
        let axes = self.axes.iter().flat_map(|a| &a.values);
        let cells = (self.cells.iter().chain(&self.refined)).flat_map(|c| {
            let more = [c.error, c.energy_rel, c.reached_s];
            std::iter::once(c.at).chain(more.into_iter().flatten())
        });
        let lines = (self.lines.iter()).flat_map(|l| l.step_s.iter().flatten());
        let all = (axes.copied().chain(self.at.iter().copied()))
            .chain(cells)
            .chain(lines.copied())
            .chain([self.duration_s]);
        if all.into_iter().any(|x| !x.is_finite()) {
            return Err("axes, cells, refined, lines or duration_s: a number is not finite".into());
        }
        Ok(())
    }
}

/// The part of a record that is specific to a study of stability.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StabilityRecord {
    /// Maps of where methods fail.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub maps: Vec<Map>,
}

impl Results {
    /// Returns the stability maps; empty in records of other studies.
    pub fn maps(&self) -> &[Map] {
        match &self.part {
            Part::Stability(part) => &part.maps,
            _ => &[],
        }
    }
}

/// Returns the report of a study of stability.
pub(super) fn report(part: &StabilityRecord) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(&part.maps),
        tables: tables::tables(&part.maps),
        charts: charts::stability(&part.maps)?,
        details: Markup::default(),
        csv: csv::tables(&part.maps),
        ..StudyReport::default()
    })
}
