//! `gearbench choose SCENE`.

use super::Refusal;
use crate::cli::Choose;
use std::process::ExitCode;

/// Runs the study and writes its folder.
pub fn run(_args: &Choose, _command: &str) -> Result<ExitCode, Refusal> {
    Err(Refusal::Failed("not built yet".into()))
}
