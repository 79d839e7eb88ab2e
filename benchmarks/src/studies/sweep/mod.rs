//! The speed sweep: gears run under load through many mesh cycles at speed after speed.
//!
//! A run starts with the teeth touching and unloaded at its speed; the loads rise over the first third of the time it is
//! given to settle, and then stay. Measured are whole mesh cycles after that ([`steady`]). The static transmission error
//! over one base pitch under the same load, by [`gearbench_reference::statics`], is the limit of slow running.

pub(crate) mod arguments;
pub(crate) mod command;
mod plan;
mod run;
pub mod scene;
pub mod steady;
mod summary;

pub use plan::Plan;
pub use run::{check, mesh_resonance, sweep};
