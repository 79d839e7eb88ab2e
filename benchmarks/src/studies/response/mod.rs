//! Frequency response of a whole scene to the passing of its teeth, about its loaded state: transmission errors, mesh forces and
//! forces on mounts over the mesh frequency, by harmonic balance ([`response`](crate::small_signals::response)).

pub(crate) mod arguments;
pub(crate) mod command;
mod plan;
mod run;
mod summary;
#[cfg(test)]
mod tests;

pub use plan::{FrequencyGrid, Plan};
pub use run::{response, study};
