//! The command `gearbench report DIR`: writes the report page of an existing record again.

use crate::cli::command_result::CommandResult;
use crate::cli::folder_lock::FolderLock;
use crate::cli::study_folder::remove_staging;
use crate::cli::terminal::{Refusal, absolute};
use crate::context::Context;
use clap::Args;
use gearbench_reference::{file_kind, files, limits};
use gearbench_reports::{RECORD, ReportError};
use std::path::{Path, PathBuf};

/// Arguments of `report`.
#[derive(Args, Clone, Debug)]
pub struct Report {
    /// Folder with a results.json
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
}

/// Largest number of study folders that a refusal lists.
const MOST_NAMED: usize = 5;

fn refuse(dir: &Path, e: ReportError) -> Refusal {
    match &e {
        ReportError::Io { .. } => Refusal::Input(miette::miette!(help = remedy(dir), "{e}")),
        ReportError::Record { .. } => Refusal::Input(miette::miette!(
            help = "repeat the study with the command in the record (`command` in results.json)",
            "{e}"
        )),
        ReportError::Draw(_) => Refusal::Failed(e.to_string()),
    }
}

/// Largest size of a record [bytes].
const MOST_OF_RECORD: u64 = 1 << 32;
/// Memory of a record and its charts, relative to the size of its text.
const MEMORY_OVER_TEXT: f64 = 3.0;

/// Checks that a record, in a folder or at a path that ends in `.json`, is a file that fits into memory.
///
/// # Errors
/// [`Refusal::Input`] with the file and help.
pub(super) fn check_record(path: &Path) -> Result<(), Refusal> {
    let file = match path.extension().is_some_and(|e| e == "json") {
        true => path.to_owned(),
        false => path.join(RECORD),
    };
    let size = files::check(&file, MOST_OF_RECORD).map_err(|source| {
        let error = ReportError::Io {
            path: file.clone(),
            source,
        };
        refuse(path, error)
    })?;
    let what = format!("the record {} of {size} bytes", file.display());
    let way_out = "repeat the study with fewer samples";
    limits::check(what, MEMORY_OVER_TEXT * size as f64, way_out)
        .map_err(|e| Refusal::Input(miette::miette!("{e}")))
}

/// The advice for a folder without a record.
fn remedy(dir: &Path) -> String {
    if let Some(kind) = file_kind::of(dir).filter(|_| dir.is_file()) {
        let way_out = kind.way_out_of(dir);
        return format!("this is {}: {way_out}", kind.name);
    }
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let inside: Vec<PathBuf> = entries.map(|e| e.path()).filter(|p| p.is_dir()).collect();
    // The folder of a scene has its studies, that of all results the scenes.
    let deeper = inside
        .iter()
        .flat_map(|p| std::fs::read_dir(p).into_iter().flatten().flatten());
    let all = inside.iter().cloned().chain(deeper.map(|e| e.path()));
    let studies = all.filter(|p| p.join(RECORD).is_file());
    let mut studies: Vec<String> = studies.map(|p| format!("`{}`", p.display())).collect();
    studies.sort();
    let more = match studies.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    studies.truncate(MOST_NAMED);
    match studies.is_empty() {
        true => {
            "name the output folder of a study (its `--out`, by default out/SCENE/STUDY)".to_owned()
        }
        false => format!(
            "name one of the studies in this folder: {}{more}",
            studies.join(", ")
        ),
    }
}

/// Rewrites the report of a record.
pub fn run(context: &Context, args: &Report) -> Result<CommandResult, Refusal> {
    check_record(&args.dir)?;
    // The reader refuses a folder without a record.
    let lock = match args.dir.join(RECORD).is_file() {
        true => Some(FolderLock::take(&context.messages, &args.dir)?),
        false => None,
    };
    if lock.is_some() {
        remove_staging(&args.dir);
    }
    let page = gearbench_reports::report_from(&args.dir).map_err(|e| refuse(&args.dir, e))?;
    drop(lock);
    let page = absolute(page);
    context
        .messages
        .print_line(&format!("report: {}", page.display()));
    Ok(CommandResult::done().with("report", page))
}
