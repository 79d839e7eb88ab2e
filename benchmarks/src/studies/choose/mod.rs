//! The cheapest adequate model, resolution, integrator and step for a scene, without finite-element transients.
//!
//! A wish is a metric and a tolerance. A **ladder** of models is climbed on a short **window** of the scene: rigid gears
//! (stiffness of the norm, of analytic tooth compliance, of static solves of the elastic gears), movable teeth,
//! quasi-static compliance, elastic gears with more and more modes. Differences between rungs estimate the error of
//! the top one; the climb ends where two of them in a row lie well below the tolerance. All other rungs are held
//! against the top one, and of the adequate ones every integrator is taken to the longest step that keeps the
//! tolerance. The cheapest of all that is left is the choice.
//!
//! | module | owns |
//! |---|---|
//! | [`situation`] | the scene and what its elastic gears are made of |
//! | [`wish`] | metrics by their names, and the error in them |
//! | [`candidate`] | what could be run: rungs, integrators, steps |
//! | [`statics`] | the stiffness of rigid gears from static solves of the elastic ones |
//! | [`scout`] | a rigid run through the scene: the window, and how errors grow beyond it |
//! | [`trial`] | a model on the window: its history, its cost |
//! | [`climb`] | the ladder of elastic gears, and what its top is still off |
//! | [`pick`] | the cheapest adequate candidate |
//! | [`domain`] | what the choice has been checked on |
//! | [`reason`] | the reason in plain words |
//! | [`choice`] | the answer |
//! | [`record`] | the answer as a record |
//! | [`chosen`] | the scene file with the choice written in |

pub mod arguments;
pub mod candidate;
pub mod choice;
pub mod chosen;
pub mod climb;
pub mod command;
pub mod domain;
pub mod pick;
pub mod reason;
pub mod record;
pub mod scout;
pub mod situation;
pub mod statics;
#[cfg(test)]
mod tests;
pub mod trial;
pub mod wish;

pub use candidate::{Candidate, Rung, candidates, densest, full};
pub use choice::{Choice, ChooseError, Parts, RungTried, Tried, choose};
pub use situation::{Flexible, Own, Situation};
pub use wish::{Metric, Wish};
