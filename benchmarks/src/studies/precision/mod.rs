//! The study of accuracy against cost: every model under every integrator at a series of steps or tolerances, elastic
//! models with a series of mode counts as well.
//!
//! Two errors, never mixed. Against the model's own converged solution (`self`, one per number of modes) a run shows
//! what its integrator loses; against a reference (stored finite elements, a full model of the scene on a fine step,
//! or, where there is neither, the elastic model with the most modes) it shows what the model and its resolution lose
//! together, and its distance to the reference is what a user of the model gets. References are computed once, before
//! all runs. Every failure is a row. Runs are timed without observers, short ones often enough for a median.

mod arguments;
mod converged;
mod plan;
mod references;
mod resolutions;
mod results;
pub mod scene;
mod study;
#[cfg(test)]
mod tests;

pub(crate) use arguments::Precision;
