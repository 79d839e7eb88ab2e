//! Exchange with other programs by REXS (Reusable Engineering EXchange Standard, <https://www.rexs.info>), versions 1.0 to
//! 2.0.
//!
//! | module | owns |
//! |---|---|
//! | [`attributes`] | the one table of attributes: numeric ids, names of all versions, units |
//! | `units` | units of the standard as factors to SI |
//! | [`model`] | components, relations and load cases as they stand in a file |
//! | [`read`] | files: XML, JSON, zip |
//! | [`import`] | a model as a scene, with what was taken, assumed and left |
//! | [`export`] | a scene as a model, with its mesh stiffness |
//! | `write` | a model as XML or JSON |
//! | `command` | `gearbench import`, `gearbench export` |

pub mod arguments;
pub mod attributes;
pub(crate) mod command;
pub mod export;
pub mod import;
pub mod model;
pub mod read;
mod units;
pub mod write;
