//! A reference computed by another program: parameters, histories and where they come from.
//!
//! `table` owns the list of stored references, embedded in the program: one line each in [`REFERENCES`].
//!
//! Owns the reading of the stored files: a CSV whose header carries SI units, and two JSON files, what the
//! deck was made from (`params.json`) and figures computed from the results (`summary.json`).

mod format;
mod history;
mod parameters;
mod table;

pub use history::{History, trapezoid};
pub use parameters::{GearData, ImpactParameters, RackData, Summary};
pub use table::{REFERENCES, StoredReference, reference};

use format::RawParameters;

/// Why stored data cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum ReferenceError {
    #[error("there is no reference `{id}`; there are {known}")]
    Unknown { id: String, known: String },
    #[error("reference `{id}`, {file}: {message}")]
    Damaged {
        id: String,
        file: &'static str,
        message: String,
    },
}

/// A finite-element run of another program, with all that is needed to judge and to repeat it.
#[derive(Clone, Debug)]
pub struct ExternalReference {
    /// Id, `program/case`.
    pub id: &'static str,
    /// One line for legends and lists.
    pub title: &'static str,
    /// Program and version.
    pub solver: String,
    /// Who computed what and how: the text of its `SOURCE.md`.
    pub source: &'static str,
    /// Command that computes it again, from the root of the repository.
    pub regenerate: &'static str,
    /// Input deck, gzip.
    pub deck: &'static [u8],
    /// What the deck was made from.
    pub parameters: ImpactParameters,
    /// Figures computed from the results when they were made.
    pub summary: Summary,
    /// Histories.
    pub history: History,
}

impl ExternalReference {
    /// Reads the stored texts of a reference.
    pub(crate) fn read(stored: &StoredReference) -> Result<Self, ReferenceError> {
        let damaged = |file: &'static str, message: String| ReferenceError::Damaged {
            id: stored.id.into(),
            file,
            message,
        };
        let raw: RawParameters = serde_json::from_str(stored.params)
            .map_err(|e| damaged("params.json", e.to_string()))?;
        let summary: Summary = serde_json::from_str(stored.summary)
            .map_err(|e| damaged("summary.json", e.to_string()))?;
        let solver = raw.solver.clone();
        let parameters = raw
            .typed()
            .map_err(|message| damaged("params.json", message))?;
        let history = History::read(stored.results, parameters.rack.is_some())
            .map_err(|message| damaged("results.csv", message))?;
        Ok(Self {
            id: stored.id,
            title: stored.title,
            solver,
            source: stored.source,
            regenerate: stored.regenerate,
            deck: stored.deck,
            parameters,
            summary,
            history,
        })
    }
}
