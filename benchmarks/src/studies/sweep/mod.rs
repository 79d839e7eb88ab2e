//! The speed sweep: gears run under load through many mesh cycles at speed after speed.
//!
//! A mesh with backlash may run in more than one way at the same speed, and goes on in the way it comes from: so the speed
//! goes up and down again, each run from the state in which the last one ended, its rigid rotation brought to the new
//! speed and its vibration kept. A fresh run starts with the teeth touching and unloaded; the loads rise over the first
//! third of the time it is given to settle, and then stay. Measured are whole mesh cycles after that time ([`steady`]). The static transmission error
//! over one base pitch under the same load, by [`gearbench_reference::statics`], is the limit of slow running.

pub(crate) mod arguments;
pub(crate) mod command;
mod end_state;
mod pair;
mod plan;
mod run;
pub mod scene;
pub mod steady;
mod summary;

pub use plan::Plan;
pub use run::{check, mesh_resonance, sweep};
