//! The study of penalties: force, impulse and static transmission error of one model over the penalty of its contact,
//! beside the same model with hard contact.
//!
//! A penalty is a spring that no body has. Results that change with it say nothing of the gears; with hard contact as
//! the limit the study shows from where on they no longer do.

pub(crate) mod arguments;
pub(crate) mod command;
mod plan;
mod run;
mod summary;

pub use plan::Plan;
pub use run::study;
