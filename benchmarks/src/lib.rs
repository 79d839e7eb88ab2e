//! Library of the command-line program `gearbench`: scenes, studies and tools.
//!
//! | module | owns |
//! |---|---|
//! | [`context`] | what a command or a study has of its own: models, interruption, scene of a rerun, messages, memory |
//! | [`messages`] | standard output and standard error, warnings |
//! | [`models`] | the table of gear models |
//! | [`scene_file`] | the scene format, embedded scenes, calibrations |
//! | [`small_signals`] | equilibrium, natural modes and frequency response of linearised scenes, stated damping |
//! | [`experiment`] | runs of one model under one integrator: conditions, row of the record, status |
//! | [`fmu`] | a scene as a functional mock-up unit: variables, description, package |
//! | [`rexs`] | exchange with other programs by REXS: import and export |
//! | [`studies`] | one module for each study: arguments, plan, runs, summary |
//! | `tools` | commands that are not studies |
//! | [`cli`] | table of commands, messages, files, exit codes |

pub mod cli;
pub mod context;
pub mod experiment;
pub mod fmu;
pub mod messages;
pub mod models;
pub mod rexs;
pub mod scene_file;
pub mod small_signals;
pub mod studies;
mod tools;
