//! `gearbench report DIR`: the page of a results folder, written again.

use crate::cli::terminal::{Refusal, say};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `report`.
#[derive(Args, Clone, Debug)]
pub struct Report {
    /// Folder with a results.json
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
}

/// Writes the report.
pub fn run(args: &Report) -> Result<ExitCode, Refusal> {
    let page =
        gearbench_reports::report_from(&args.dir).map_err(|e| Refusal::Files(e.to_string()))?;
    say(&format!("report: {}", page.display()));
    Ok(ExitCode::SUCCESS)
}
