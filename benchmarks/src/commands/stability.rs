//! `gearbench stability SCENE`.

use super::Refusal;
use crate::cli::Stability;
use std::process::ExitCode;

/// Runs the study and writes its folder.
pub fn run(_args: &Stability, _command: &str) -> Result<ExitCode, Refusal> {
    Err(Refusal::Failed("not built yet".into()))
}
