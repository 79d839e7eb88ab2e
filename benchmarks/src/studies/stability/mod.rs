//! The study of stability: maps of the steps at which methods fail. Each model under each integrator has a map over the
//! step and one or two parameters of contact, teeth, damping, speed, modes or the method itself. Every cell is a short
//! run of the scene with exactly one label.
//!
//! | module | owns |
//! |---|---|
//! | `axis` | the parameters: their effect, and the models that have them |
//! | `plan` | maps, their cells in order, the echo of a plan |
//! | `cell` | one run and its label, the converged solution that it is compared with |
//! | `theory` | theoretical limits as lines over the rows of a map |
//!
//! The study runs on several threads in any order; the record is put together in the order of the
//! plan, so that it does not depend on threads, kills and resumptions. A run ends by its number of steps; the wall
//! clock is a backstop only.

pub(crate) mod arguments;
pub(crate) mod axis;
mod cell;
pub(crate) mod command;
pub mod limits;
mod plan;
mod run;
pub mod scene;
mod setup;
mod summary;
mod theory;
