//! Support of the benches: ratios by criterion, scenes, sweeps over resolutions, the two-gear problems.
#![allow(dead_code)]

pub mod helical;
pub mod problem;
pub mod ratio;
pub mod scenes;
pub mod sweep;
