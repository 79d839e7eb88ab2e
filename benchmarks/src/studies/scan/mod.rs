//! Many scenes that differ in some keys: grids, samples of distributions, sensitivity indices, and parts that several
//! machines compute.

pub(crate) mod arguments;
mod axis;
pub(crate) mod command;
mod design;
pub(crate) mod merge;
mod output;
#[cfg(feature = "parquet")]
mod parquet;
mod plan;
mod results;
mod run;
mod statistics;
mod summary;
mod table;
