//! `gearbench report DIR`: the page of a results folder, written again.

use crate::cli::answer::Answer;
use crate::cli::folder_lock::FolderLock;
use crate::cli::study_folder::remove_staging;
use crate::cli::terminal::{Refusal, absolute, say};
use clap::Args;
use gearbench_reports::ReportError;
use std::path::PathBuf;

/// Arguments of `report`.
#[derive(Args, Clone, Debug)]
pub struct Report {
    /// Folder with a results.json
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
}

fn refuse(e: ReportError) -> Refusal {
    match &e {
        ReportError::Io { .. } => Refusal::Input(miette::miette!(
            help = "name the folder that a study has written (its `--out`, by default out/SCENE/STUDY)",
            "{e}"
        )),
        ReportError::Record { .. } => Refusal::Input(miette::miette!(
            help = "a record is made again by the command that it names: `command` in results.json",
            "{e}"
        )),
        ReportError::Draw(_) => Refusal::Failed(e.to_string()),
    }
}

/// Writes the report.
pub fn run(args: &Report) -> Result<Answer, Refusal> {
    // A folder without a record is refused by what reads it.
    let lock = match args.dir.join(gearbench_reports::RECORD).is_file() {
        true => Some(FolderLock::take(&args.dir)?),
        false => None,
    };
    if lock.is_some() {
        remove_staging(&args.dir);
    }
    let page = gearbench_reports::report_from(&args.dir).map_err(refuse)?;
    drop(lock);
    let page = absolute(page);
    say(&format!("report: {}", page.display()));
    Ok(Answer::done().with("report", page))
}
