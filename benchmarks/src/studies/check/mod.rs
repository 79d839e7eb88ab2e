//! `gearbench check FILE`: results, work and runtime of chosen runs against a stored baseline.
//!
//! | module | owns |
//! |---|---|
//! | [`arguments`] | the command line |
//! | `file` | check files: cases, quantities, tolerances |
//! | `quantity` | quantities that a check compares |
//! | `baseline` | stored baselines, one line for each entry |
//! | `measure` | runs of the cases |
//! | `kernel` | runtime in units of a fixed kernel |
//! | `comparison` | comparison of entries with their baselines, and of the runtimes of all entries |
//! | [`command`], `summary` | the study, and its terminal summary |

pub mod arguments;
mod baseline;
pub mod command;
mod comparison;
pub(crate) mod file;
mod kernel;
mod measure;
mod quantity;
mod summary;
