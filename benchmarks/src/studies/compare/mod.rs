//! The comparison: every model of a scene under every integrator, against its reference and against the
//! model's own converged solution.
//!
//! Two errors, never mixed: `against` the external reference is the model's error, `against: "self"` the
//! integrator's. The converged solution is Dormand-Prince with located events at a tolerance of 1e-10 (1e-8 where
//! that takes too long); of gears with modes it is the trigonometric method at 1e-4.

pub(crate) mod arguments;
pub(crate) mod command;
mod plan;
mod run;
mod summary;
mod yardstick;

pub use plan::{FramePlan, Plan};
pub use run::compare;
pub use yardstick::{REFINED, YardstickChoice};

#[cfg(test)]
mod shipped_tests;
