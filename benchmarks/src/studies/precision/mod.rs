//! The study of accuracy against cost: every model under every integrator at a ladder of steps or tolerances, elastic
//! models with a ladder of mode counts as well.
//!
//! Two errors, never mixed. Against the model's own converged solution (`self`, one per number of modes) a run shows
//! what its integrator loses; against a reference (stored finite elements, a full model of the scene on a fine step,
//! or, where there is neither, the elastic model with the most modes) it shows what the model and its resolution lose
//! together, and its distance to the reference is what a user of the model gets. References are computed once, before
//! all runs. Every failure is a row. Runs are timed without observers, short ones often enough for a median.

pub mod arguments;
pub mod command;
mod ladder;
mod metric;
mod plan;
mod references;
mod run;
pub mod scene;
mod summary;

pub use metric::metrics_of;
pub use plan::{Asked, COUNTS, Full, Plan, Variant};
pub use run::study;
