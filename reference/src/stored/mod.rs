//! A reference computed by another program: parameters, histories and where they come from.
//!
//! `table` owns the list of stored references, embedded in the program: one line each in [`REFERENCES`].
//!
//! Owns the reading of the stored files: a CSV whose header carries SI units, and two JSON files, what the
//! deck was made from (`params.json`) and figures computed from the results (`summary.json`).

mod data;
mod format;
mod history;
mod parameters;
mod table;

pub use history::{History, trapezoid};
pub use parameters::{GearData, ImpactParameters, RackData, Summary};
pub use table::{REFERENCES, StoredReference, reference};

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
    /// Identifier `program/case`.
    pub id: &'static str,
    /// One line for legends and lists.
    pub title: &'static str,
    /// Program that computed the reference, with its version.
    pub solver: String,
    /// Text of its `SOURCE.md`: origin and method of the computation.
    pub source: &'static str,
    /// Command that computes it again, from the root of the repository.
    pub regenerate: &'static str,
    /// Note for the assessment of the reference.
    pub note: &'static str,
    /// Estimated relative error of its own force history [-].
    pub own_error: Option<f64>,
    /// Input deck, compressed by gzip.
    pub deck: &'static [u8],
    /// Parameters of the reference.
    pub parameters: ImpactParameters,
    /// Figures computed from the results when they were made.
    pub summary: Summary,
    /// Computed histories.
    pub history: History,
}
