//! The study of many scenes: keys of a scene varied at once, with statistics, sensitivity indices and charts of the
//! responses.
//!
//! The rows of all cells are in a file of their own, `cells.csv`, which may be too long for a record. The record has
//! what is computed from them, and as many rows as a chart shows.

mod charts;
pub(super) mod csv;
mod tables;

use crate::csv_table::named_unit;
use crate::drawing::canvas::DrawError;
use crate::metrics::Metric;
use crate::record::checks::{each, same_length};
use crate::record::{Results, Status, not_a_number};
use crate::studies::{Part, StudyReport};
use crate::words::words;
use serde::{Deserialize, Serialize};

words! {
    /// How distributions are sampled.
    pub enum Sampling {
        /// Sobol sequence, scrambled and seeded.
        #[default]
        Sobol = "sobol",
        /// Latin hypercube.
        Latin = "latin",
        /// Independent samples.
        Random = "random",
    }
}

impl std::str::FromStr for Sampling {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|s| s.as_str() == text);
        found.ok_or_else(|| "expected sobol, latin or random".into())
    }
}

/// The part of a record that is specific to a scan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ScanRecord {
    /// Program, scene and options that the cells are computed from: all shards of a scan have the same.
    pub identity: ScanIdentity,
    /// Axes of the scan.
    pub axes: Vec<ScanAxis>,
    /// How distributions are sampled; absent without them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<SampleDesign>,
    /// Number of cells: scenes with different values.
    pub cells: u64,
    /// Part of the cells that this record has; absent if it has all of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// Quantities of each run, with the SI unit at the end of the name.
    pub outputs: Vec<String>,
    /// Models and integrators that run in each cell.
    pub configurations: Vec<ScanConfiguration>,
    /// Failed runs by configuration and status.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<FailureCount>,
    /// Positions of the configurations whose results are the same in all cells, from 0: no varied key has an effect.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unaffected: Vec<usize>,
    /// Statistics over the samples.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub statistics: Vec<SampleStatistics>,
    /// Sensitivity indices.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub indices: Vec<SensitivityIndex>,
    /// Rows that charts show.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shown: Vec<ShownRow>,
}

/// Program, scene and options that the cells of a scan are computed from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ScanIdentity {
    /// Version and commit of the program.
    pub program: String,
    /// Hash of the scene, its calibrations and the files that it reads.
    pub scene: String,
    /// Options that the cells depend on.
    pub arguments: String,
}

/// Axis of a scan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ScanAxis {
    /// Keys of the scene, several where they change together.
    pub keys: Vec<String>,
    /// Listed values of the first key; empty for a random axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<String>,
    /// Distribution of a random axis, such as `uniform(1,2)` or `seeds(200)`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distribution: Option<String>,
}

/// How distributions are sampled.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SampleDesign {
    /// Kind of the samples.
    pub sampling: Sampling,
    /// Number of samples.
    pub samples: u64,
    /// Seed of the samples.
    pub seed: u64,
    /// Number of variants of each sample, for sensitivity indices; else 1.
    pub variants: u64,
}

/// Part of the cells of a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: u64,
    /// Number of parts.
    pub of: u64,
    /// First cell of the part, from 1.
    pub first: u64,
    /// Last cell of the part; the one before the first in an empty part.
    pub last: u64,
}

/// Model and integrator of a scan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ScanConfiguration {
    /// Label of the model in its scene.
    pub label: String,
    /// Integrator with its step or tolerance.
    pub integrator: String,
}

impl ScanConfiguration {
    fn text(&self) -> String {
        format!("{}, {}", self.label, self.integrator)
    }
}

/// Failed runs of a configuration that ended alike.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FailureCount {
    /// Position of the configuration in the record, from 0.
    pub configuration: usize,
    /// How the runs ended.
    pub status: Status,
    /// Number of such runs.
    pub count: u64,
    /// First cell with such a run, from 1.
    pub first_cell: u64,
    /// The reason in that cell.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub message: String,
}

/// Statistics of an output over the samples, for one configuration and one combination of listed values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SampleStatistics {
    /// Position of the configuration in the record, from 0.
    pub configuration: usize,
    /// Position of the output in the record, from 0.
    pub output: usize,
    /// Position of the value on each axis, from 0; 0 for random axes.
    pub at: Vec<usize>,
    /// Number of samples with a value.
    pub count: u64,
    /// Number of samples without one.
    pub missing: u64,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of a sample.
    pub deviation: f64,
    /// Least value, the values that 5, 25, 50, 75 and 95 % of the samples do not exceed, and the greatest value.
    pub quantiles: [f64; 7],
}

/// Shares of the variance of an output that an axis causes (I. M. Sobol).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SensitivityIndex {
    /// Position of the configuration in the record, from 0.
    pub configuration: usize,
    /// Position of the output in the record, from 0.
    pub output: usize,
    /// Position of the value on each axis, from 0; 0 for random axes.
    pub at: Vec<usize>,
    /// Position of the axis in the record, from 0.
    pub axis: usize,
    /// First-order index with its 95 % interval: share that the axis causes alone.
    pub first: [f64; 3],
    /// Total index with its 95 % interval: share that it causes alone and together with other axes.
    pub total: [f64; 3],
}

/// Row of a cell that charts show.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ShownRow {
    /// Number of the cell, from 1.
    pub cell: u64,
    /// Position of the configuration in the record, from 0.
    pub configuration: usize,
    /// Position of the value on each axis, from 0; 0 for random axes.
    pub at: Vec<usize>,
    /// Values of the first key of each axis, absent where they are no numbers.
    pub values: Vec<Option<f64>>,
    /// Values of the outputs, absent where there are none.
    pub outputs: Vec<Option<f64>>,
}

impl Results {
    /// Returns the part of a scan; `None` in records of other studies.
    pub fn scan(&self) -> Option<&ScanRecord> {
        match &self.part {
            Part::Scan(part) => Some(part),
            _ => None,
        }
    }
}

impl ScanRecord {
    /// Checks the rules that the types do not enforce.
    pub(crate) fn validate(&self) -> Result<(), String> {
        let known = |configuration: usize, output: usize, at: &[usize]| {
            same_length("at", at.len(), "axes", self.axes.len())?;
            for (axis, at) in self.axes.iter().zip(at) {
                if *at >= axis.values.len().max(1) {
                    return Err(format!(
                        "at {at} is beyond the values of {}",
                        axis.keys.join(" | ")
                    ));
                }
            }
            match configuration < self.configurations.len() && output < self.outputs.len() {
                true => Ok(()),
                false => Err("there is no such configuration or output".to_owned()),
            }
        };
        each("failures", &self.failures, |f| {
            known(f.configuration, 0, &vec![0; self.axes.len()])
        })?;
        let of = |c: &usize| known(*c, 0, &vec![0; self.axes.len()]);
        each("unaffected", &self.unaffected, of)?;
        each("statistics", &self.statistics, |s| {
            known(s.configuration, s.output, &s.at)
        })?;
        each("indices", &self.indices, |s| {
            known(s.configuration, s.output, &s.at)?;
            match s.axis < self.axes.len() {
                true => Ok(()),
                false => Err("there is no such axis".into()),
            }
        })?;
        each("shown", &self.shown, |s| {
            known(s.configuration, 0, &s.at)?;
            same_length("values", s.values.len(), "axes", self.axes.len())?;
            same_length("outputs", s.outputs.len(), "outputs", self.outputs.len())
        })
    }

    /// Removes all numbers that are not finite.
    pub(crate) fn keep_finite(&mut self) {
        let finite = |x: &[f64]| x.iter().all(|x| x.is_finite());
        self.statistics
            .retain(|s| finite(&[s.mean, s.deviation]) && finite(&s.quantiles));
        self.indices
            .retain(|s| finite(&s.first) && finite(&s.total));
        for row in &mut self.shown {
            for x in row.values.iter_mut().chain(&mut row.outputs) {
                if not_a_number(x) {
                    *x = None;
                }
            }
        }
    }

    /// Number of runs.
    pub fn runs(&self) -> u64 {
        let cells = self.shard.map_or(self.cells, |s| s.last + 1 - s.first);
        cells * self.configurations.len() as u64
    }

    /// Number of failed runs.
    pub fn failed(&self) -> u64 {
        self.failures.iter().map(|f| f.count).sum()
    }

    /// Values of the listed axes at their positions, as text: empty without listed axes.
    fn at_text(&self, at: &[usize]) -> String {
        let of = |(axis, at): (&ScanAxis, &usize)| {
            let value = axis.values.get(*at)?;
            Some(format!("{} = {value}", short_name(&axis.keys[0])))
        };
        let parts: Vec<String> = self.axes.iter().zip(at).filter_map(of).collect();
        parts.join(", ")
    }
}

/// The last names of a key, by which a chart names its axis: `gears.pinion.speed_rad_s` is `pinion.speed_rad_s`.
fn short_name(key: &str) -> &str {
    let mut dots = key.rmatch_indices('.').map(|(i, _)| i);
    dots.nth(1).map_or(key, |i| &key[i + 1..])
}

/// Name of a key next to an axis: the words of its last two parts without numbers of entries, and its unit.
fn axis_words(key: &str) -> String {
    let mut unit = "";
    let mut words: Vec<String> = Vec::new();
    for part in short_name(key)
        .split('.')
        .filter(|p| p.parse::<usize>().is_err())
    {
        let (stem, found) = match part.strip_suffix("_deg") {
            Some(stem) => (stem, "deg"),
            None => named_unit(part),
        };
        if !found.is_empty() {
            unit = found;
        }
        words.push(stem.replace('_', " "));
    }
    match unit {
        "" => words.join(", "),
        unit => format!("{} [{unit}]", words.join(", ")),
    }
}

/// Name of an output in words, with its unit.
fn output_text(key: &str) -> (String, &'static str) {
    match key.parse::<Metric>() {
        Ok(metric) => (metric.words().to_owned(), metric.unit()),
        Err(_) => (key.replace('_', " "), ""),
    }
}

/// Returns the report of a scan.
pub(super) fn report(record: &ScanRecord) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(record),
        tables: tables::tables(record),
        charts: charts::charts(record)?,
        csv: csv::tables(record),
        ..StudyReport::default()
    })
}
