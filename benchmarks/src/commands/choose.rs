//! `gearbench choose SCENE`.

use super::{Refusal, choice_check};
use crate::cli::Choose;
use std::process::ExitCode;

/// Runs the study and writes its folder.
pub fn run(args: &Choose, command: &str) -> Result<ExitCode, Refusal> {
    if let Some((set, number)) = &args.check.draw {
        return choice_check::print(set, *number);
    }
    if let Some(set) = &args.check.check {
        return choice_check::judge(set, args, command);
    }
    Err(Refusal::Failed("not built yet".into()))
}
