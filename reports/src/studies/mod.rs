//! The studies that write a record, a room each: what the record holds, and what page, charts and CSV say of it.
//!
//! A new study is a room, a variant of [`Study`] and its line in [`STUDIES`].

pub mod choice_check;
pub mod choose;
pub mod compare;
pub mod penalty;
pub mod precision;
pub mod stability;
pub mod stiffness;
pub mod sweep;
pub mod truncation;

use crate::csv_table::CsvTable;
use crate::drawing::Chart;
use crate::drawing::canvas::DrawError;
use crate::record::Results;
use crate::view::View;
use maud::Markup;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A study.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Study {
    /// All models and integrators of a scene against its references.
    #[default]
    Compare,
    /// Error against cost.
    Precision,
    /// Where methods fail.
    Stability,
    /// The cheapest adequate model, integrator and step.
    Choose,
    /// Choices judged on random scenes.
    ChoiceCheck,
    /// Error over the number of modes that a reduction keeps.
    Truncation,
    /// Force and transmission error over the penalty of the contact.
    Penalty,
    /// Running under load at speed after speed.
    Sweep,
}

/// Writes what a study says of a record.
type Writer = fn(&View<'_>) -> Result<StudyReport, DrawError>;

/// The studies: the word of the format, of commands and of folders, and what writes their reports.
const STUDIES: [(Study, &str, Writer); 8] = [
    (Study::Compare, "compare", compare::report),
    (Study::Precision, "precision", precision::report),
    (Study::Stability, "stability", stability::report),
    (Study::Choose, "choose", choose::report),
    (Study::ChoiceCheck, "choice-check", choice_check::report),
    (Study::Truncation, "truncation", truncation::report),
    (Study::Penalty, "penalty", penalty::report),
    (Study::Sweep, "sweep", sweep::report),
];

/// What a study says of a record: all that the page, the charts and the tables in CSV are written from.
#[derive(Clone, Debug, Default)]
pub struct StudyReport {
    /// The finding in plain words, a paragraph each.
    pub finding: Vec<Markup>,
    /// Sections above the charts.
    pub tables: Markup,
    /// Charts.
    pub charts: Vec<Chart>,
    /// Sections below the charts.
    pub details: Markup,
    /// Tables in files of their own.
    pub csv: Vec<CsvTable>,
}

/// What the study of a record says.
///
/// # Errors
/// [`DrawError`] when the drawing backend refuses.
pub fn report(results: &Results) -> Result<StudyReport, DrawError> {
    let (_, _, write) = results.study.entry();
    write(&View::new(results))
}

impl Study {
    fn entry(self) -> &'static (Study, &'static str, Writer) {
        let found = STUDIES.iter().find(|s| s.0 == self);
        found.unwrap_or(&STUDIES[0])
    }

    /// All.
    pub fn all() -> impl Iterator<Item = Self> {
        STUDIES.iter().map(|s| s.0)
    }

    /// The word of the format, of commands and of folders.
    pub fn as_str(self) -> &'static str {
        self.entry().1
    }
}

impl std::fmt::Display for Study {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

/// What the study of mode counts was called in records.
const FORMER_TRUNCATION: &str = "modes";

impl std::str::FromStr for Study {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(study) = Self::all().find(|s| s.as_str() == text) {
            return Ok(study);
        }
        let new = Self::Truncation;
        Err(if text == FORMER_TRUNCATION {
            format!(
                "the record is of an older version: its study `{text}` is called `{new}` now; run the study again, or \
                 write `{new}` into the record"
            )
        } else {
            let all: Vec<&str> = STUDIES.iter().map(|s| s.1).collect();
            format!(
                "there is no study `{text}`; this version knows {}",
                all.join(", ")
            )
        })
    }
}

impl Serialize for Study {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for Study {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lead_back_and_the_former_name_is_refused_with_the_new_one() {
        for s in [
            Study::Compare,
            Study::ChoiceCheck,
            Study::Truncation,
            Study::Sweep,
        ] {
            assert_eq!(s.as_str().parse(), Ok(s));
        }
        let old = "modes".parse::<Study>().unwrap_err();
        assert!(old.contains("`truncation`"), "{old}");
        assert!("mode".parse::<Study>().unwrap_err().contains("compare"));
    }
}
