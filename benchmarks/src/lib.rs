//! Library of the command-line program `gearbench`: scenes, studies and tools.
//!
//! | room | owns |
//! |---|---|
//! | [`models`] | the table of gear models that scenes may name |
//! | [`scene_file`] | the scene format, the shipped scenes, calibrations |
//! | [`experiment`] | one model under one integrator: what is run, its row of the record, how it ended |
//! | [`fmu`] | a scene as a functional mock-up unit: variables, description, package |
//! | [`studies`] | a study in one room: arguments, plan, runs, summary |
//! | `tools` | what the command does beside studies |
//! | [`cli`] | the table of commands; messages, files, exit codes |

pub mod cli;
pub mod experiment;
pub mod fmu;
pub mod models;
pub mod scene_file;
pub mod studies;
mod tools;
