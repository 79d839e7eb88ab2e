//! `gearbench precision SCENE`.

use super::Refusal;
use crate::cli::Precision;
use std::process::ExitCode;

/// Runs the study and writes its folder.
pub fn run(_args: &Precision, _command: &str) -> Result<ExitCode, Refusal> {
    Err(Refusal::Failed("not built yet".into()))
}
