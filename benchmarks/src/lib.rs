//! The library behind the command `gearbench`: scenes, studies, commands.
//!
//! | room | owns |
//! |---|---|
//! | [`models`] | the table of gear models that scenes may name |
//! | [`scene_file`] | the scene format, the shipped scenes, calibrations |
//! | [`study`] | what is computed: runs, comparison, identification |
//! | [`cli`], [`commands`] | arguments and help; files, messages, exit codes |

pub mod cli;
pub mod commands;
pub mod models;
pub mod scene_file;
pub mod study;
