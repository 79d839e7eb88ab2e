//! `gearbench report DIR`: the page of a results folder, written again.

use crate::cli::answer::Answer;
use crate::cli::terminal::{Refusal, absolute, say};
use clap::Args;
use gearbench_reference::{files, limits};
use gearbench_reports::{RECORD, ReportError};
use std::path::{Path, PathBuf};

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

/// Bytes that a record may have.
const MOST_OF_RECORD: u64 = 1 << 32;
/// Memory that a record and its charts take over the bytes of its text.
const MEMORY_OVER_TEXT: f64 = 3.0;

/// Checks that the record of a folder, or at a path that ends in `.json`, is a file that the memory has room for.
///
/// # Errors
/// [`Refusal::Input`] with the file and a way out.
pub(super) fn check_record(path: &Path) -> Result<(), Refusal> {
    let file = match path.extension().is_some_and(|e| e == "json") {
        true => path.to_owned(),
        false => path.join(RECORD),
    };
    let size = files::check(&file, MOST_OF_RECORD).map_err(|source| {
        refuse(ReportError::Io {
            path: file.clone(),
            source,
        })
    })?;
    let what = format!("the record {} of {size} bytes", file.display());
    let way_out = "make the study again with fewer samples";
    limits::check(what, MEMORY_OVER_TEXT * size as f64, way_out)
        .map_err(|e| Refusal::Input(miette::miette!("{e}")))
}

/// Writes the report.
pub fn run(args: &Report) -> Result<Answer, Refusal> {
    check_record(&args.dir)?;
    let page = gearbench_reports::report_from(&args.dir).map_err(refuse)?;
    let page = absolute(page);
    say(&format!("report: {}", page.display()));
    Ok(Answer::done().with("report", page))
}
