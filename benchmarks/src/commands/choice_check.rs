//! `gearbench choose --draw SET:N` and `gearbench choose --check SET`: random scenes, and choices judged on them.

use super::{Refusal, say};
use crate::study::choose::draw::{self, DrawError};
use std::process::ExitCode;

fn refuse(e: DrawError) -> Refusal {
    match e {
        DrawError::Set { .. } | DrawError::Number { .. } => Refusal::Input(miette::miette!(
            help = "sets and their sizes stand in benchmarks/choose/sets.toml",
            "{e}"
        )),
        e => Refusal::Failed(e.to_string()),
    }
}

/// Prints a random scene as a scene file.
pub fn print(set: &str, number: usize) -> Result<ExitCode, Refusal> {
    let set = draw::set(set).map_err(refuse)?;
    let drawn = draw::draw(&set, number).map_err(refuse)?;
    say(drawn.text.trim_end());
    Ok(ExitCode::SUCCESS)
}
