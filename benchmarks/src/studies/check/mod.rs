//! `gearbench check FILE`: results, work and runtime of chosen runs against a stored baseline.
//!
//! | module | owns |
//! |---|---|
//! | [`arguments`] | the command line |
//! | `file` | the file that says what is checked |
//! | `quantity` | what is looked at in a run |
//! | `baseline` | stored baselines, one line for each entry |
//! | `measure` | runs of the cases |
//! | `kernel` | runtime in units of a fixed kernel |
//! | `judge` | an entry beside its baseline, the runtimes of all entries |
//! | [`command`], `summary` | the study, and what the terminal says of it |

pub mod arguments;
mod baseline;
pub mod command;
pub(crate) mod file;
mod judge;
mod kernel;
mod measure;
mod quantity;
mod summary;
