//! The regression check: measured quantities, their deviations from a stored baseline, and the allowed deviations.
//!
//! An **entry** is one scene under one model and one method. A **finding** is one quantity of an entry compared with
//! its baseline. Metrics and counts of work decide the verdict; runtime, in units of a kernel that is timed together
//! with it, decides where the check states this; parameters never decide and name the changes. The verdict of the whole
//! is that of its worst finding.

mod chart;
pub(super) mod files;
mod page;

pub use files::{junit, markdown};

use crate::drawing::canvas::DrawError;
use crate::numbers;
use crate::record::Status;
use crate::studies::StudyReport;
use crate::words::words;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

words! {
    /// Kind of the quantity of a finding.
    pub enum Kind {
        /// Status of the run.
        #[default]
        Status = "status",
        /// A metric of the run.
        Metric = "metric",
        /// A bound on a result, whatever the baseline.
        Limit = "limit",
        /// A count of work.
        Work = "work",
        /// Runtime in units of the kernel.
        Runtime = "runtime",
        /// A constant that the model was built with.
        Parameter = "parameter",
        /// Presence of the entry in both run and baseline.
        Entry = "entry",
    }
}

words! {
    /// Verdict on a finding.
    pub enum Verdict {
        /// The quantity is within its tolerance.
        #[default]
        Held = "held",
        /// The quantity differs without consequence and is reported alone.
        Reported = "reported",
        /// The quantity is beyond its tolerance.
        Moved = "moved",
    }
}

/// One entry as it was measured, and as baselines keep it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MeasuredEntry {
    /// Name of the case.
    pub case: String,
    /// Scene of the case.
    pub scene: String,
    /// Label of the model.
    pub model: String,
    /// Method with its step or tolerance, such as `dopri5@1e-6`.
    pub method: String,
    /// Status of the run.
    pub status: Status,
    /// Reason why the run did not converge, if it did not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Results by key, in SI units; errors against references as `force_l2@calculix`.
    pub metrics: BTreeMap<String, f64>,
    /// Counts of work by key.
    pub work: BTreeMap<String, u64>,
    /// Processor time of one integration over that of the kernel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub runtime: Option<f64>,
    /// Constants of the models by gear or mesh and key, as [`crate::record::Run::parameters`].
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, BTreeMap<String, serde_json::Value>>,
}

impl MeasuredEntry {
    /// Returns the name in messages, which is unique in a check.
    pub fn name(&self) -> String {
        format!("{} / {} / {}", self.case, self.model, self.method)
    }

    /// True if both are the same entry: same case, model and method.
    pub fn is(&self, other: &MeasuredEntry) -> bool {
        (&self.case, &self.model, &self.method) == (&other.case, &other.model, &other.method)
    }
}

/// A value of a quantity: a number with all its digits, or words, such as how a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum CheckedValue {
    /// A number in SI units, or a count.
    Number(f64),
    /// Words; empty where there is no value.
    Text(String),
}

impl CheckedValue {
    /// Returns the number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            CheckedValue::Number(x) => Some(*x),
            CheckedValue::Text(_) => None,
        }
    }
}

impl Default for CheckedValue {
    fn default() -> Self {
        CheckedValue::Text(String::new())
    }
}

impl From<&str> for CheckedValue {
    fn from(text: &str) -> Self {
        CheckedValue::Text(text.into())
    }
}

impl From<String> for CheckedValue {
    fn from(text: String) -> Self {
        CheckedValue::Text(text)
    }
}

impl From<f64> for CheckedValue {
    /// Converts a number; one that is not finite has no form in JSON and becomes a text.
    fn from(x: f64) -> Self {
        match x.is_finite() {
            true => CheckedValue::Number(x),
            false => CheckedValue::Text(x.to_string()),
        }
    }
}

/// A quantity compared with its baseline.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Finding {
    /// Kind of the quantity.
    pub kind: Kind,
    /// Key of the quantity.
    pub what: String,
    /// Value in the present run.
    pub now: CheckedValue,
    /// Value in the baseline.
    pub before: CheckedValue,
    /// Change over the baseline [-], where both are numbers and the baseline is not zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub change: Option<f64>,
    /// Allowed deviation in words.
    pub allowed: String,
    /// Verdict on the quantity.
    pub verdict: Verdict,
}

impl Finding {
    /// Returns both values for people, `now` first: numbers with as many digits as distinguish them.
    pub fn texts(&self) -> [String; 2] {
        let numbers = [&self.now, &self.before].map(CheckedValue::number);
        let known: Vec<f64> = numbers.iter().copied().flatten().collect();
        let digits = numbers::digits_apart(&known, if self.kind == Kind::Runtime { 4 } else { 5 });
        [&self.now, &self.before].map(|value| match value {
            CheckedValue::Text(text) => text.clone(),
            CheckedValue::Number(n) if self.kind == Kind::Work => format!("{n:.0}"),
            CheckedValue::Number(x) => numbers::short(*x, digits),
        })
    }

    /// Returns the finding in one line: `peak_force_n 3612.3, baseline 3599.1 (+0.37 %, allowed 1e-6 of it)`.
    pub fn to_text(&self) -> String {
        let change = self.change.map_or(String::new(), |c| {
            format!("{}\u{a0}%, ", numbers::deviation(c, 3))
        });
        let [now, before] = self.texts();
        let before = match before.as_str() {
            "" => String::new(),
            before => format!(", baseline {before}"),
        };
        let allowed = match self.allowed.as_str() {
            "" => "reported".to_owned(),
            allowed => format!("allowed {allowed}"),
        };
        format!("{} {now}{before} ({change}{allowed})", self.what)
    }
}

/// An entry with its findings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct CheckedEntry {
    /// Entry as it was measured; for an entry that only the baseline has, as the baseline stores it.
    #[serde(flatten)]
    pub measured: MeasuredEntry,
    /// Findings on all quantities of the entry.
    pub findings: Vec<Finding>,
}

impl CheckedEntry {
    /// Returns the quantities beyond their tolerance.
    pub fn moved(&self) -> impl Iterator<Item = &Finding> {
        self.of(Verdict::Moved)
    }

    /// Returns the quantities that differ without consequence and are reported alone.
    pub fn reported(&self) -> impl Iterator<Item = &Finding> {
        self.of(Verdict::Reported)
    }

    fn of(&self, verdict: Verdict) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |f| f.verdict == verdict)
    }
}

/// Origin of a stored baseline: number, commit, time and processor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Stored {
    /// Number of the baseline, from 1.
    pub baseline: u32,
    /// Commit of gearbench that stored it.
    pub commit: String,
    /// Time at which it was stored (RFC 3339).
    pub created: String,
    /// Processor that its runtimes were measured on.
    pub cpu: String,
}

/// A quantity of an entry over all baselines, the present run last.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Trend {
    /// Name of the entry, see [`MeasuredEntry::name`].
    pub entry: String,
    /// Number of the baseline (of the present run the next one) and value.
    pub points: Vec<(u32, f64)>,
}

/// The part of a record that is specific to a regression check.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct CheckRecord {
    /// File that defines the check.
    pub file: String,
    /// Baseline that the entries are compared with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stored: Option<Stored>,
    /// All entries of the check.
    pub entries: Vec<CheckedEntry>,
    /// Key of the quantity whose history is drawn.
    pub quantity: String,
    /// History of that quantity, one trend per entry.
    pub history: Vec<Trend>,
}

impl CheckRecord {
    /// Returns the entries with a quantity beyond its tolerance.
    pub fn moved(&self) -> impl Iterator<Item = &CheckedEntry> {
        self.entries.iter().filter(|e| e.moved().next().is_some())
    }

    /// True if no quantity is beyond its tolerance.
    pub fn holds(&self) -> bool {
        self.moved().next().is_none()
    }

    /// Returns the verdict in one line, the same in terminal, page and summary.
    pub fn verdict(&self) -> String {
        use numbers::counted;
        let entries = counted(self.entries.len(), "entry", "entries");
        let quantities: usize = self.entries.iter().map(|e| e.findings.len()).sum();
        let quantities = counted(quantities, "quantity", "quantities");
        let (moved, all) = (self.moved().count(), self.entries.len());
        let Some(stored) = &self.stored else {
            return format!("{entries} measured, there was no baseline before");
        };
        let against = format!("baseline {} of {}", stored.baseline, stored.created);
        match (all, moved) {
            (0, _) => format!("nothing was run; the newest is {against}"),
            (_, 0) => format!("{entries} hold {quantities} against {against}"),
            _ => format!("{moved} of {entries} moved against {against}"),
        }
    }
}

/// Returns the report of a regression check.
pub(super) fn report(record: &CheckRecord) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        viewer: None,
        finding: page::finding(record),
        tables: page::moved(record),
        charts: chart::history(record)?,
        details: page::all(record),
        csv: files::tables(record),
        texts: vec![
            ("summary.md".into(), markdown(record)),
            ("junit.xml".into(), junit(record)),
        ],
        ..StudyReport::default()
    })
}

#[cfg(test)]
mod tests;
