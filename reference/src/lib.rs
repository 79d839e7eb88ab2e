//! Finite-element references for gear contact.
//!
//! | room | owns |
//! |---|---|
//! | [`external`] | what a stored reference of another program carries, and how it is read |
//! | [`table`] | the stored references, embedded in the program: one line each in [`table::REFERENCES`] |
//!
//! The data lie beside the sources in `reference/calculix/`, each case with its deck, results, parameters
//! and a `SOURCE.md` that says who computed what and how; `regenerate.sh` there runs a deck again.
//! Everything is in SI units; the conventions of a case stand in its `SOURCE.md`.

pub mod external;
mod stored_format;
pub mod table;

pub use external::{
    ExternalReference, GearData, History, ImpactParameters, ReferenceError, Summary,
};
pub use table::{REFERENCES, StoredReference, reference};
