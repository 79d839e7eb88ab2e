//! The study of penalties: force, impulse and static transmission error of one model over the penalty of its contact,
//! compared with the same model with hard contact.
//!
//! A penalty is a numerical spring without physical counterpart. Results that depend on it are no results for the
//! gears; with hard contact as the limit, the study shows above which penalty they no longer depend on it.

pub(crate) mod arguments;
pub(crate) mod command;
mod plan;
mod run;
mod summary;

pub use plan::Plan;
pub use run::study;
