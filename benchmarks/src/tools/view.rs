//! The command `gearbench view FOLDER`: opens the report of a result, or a gallery of all results in a folder.

use super::report::check_record;
use crate::cli::command_result::CommandResult;
use crate::cli::files::write_whole;
use crate::cli::terminal::{Refusal, absolute};
use crate::context::Context;
use clap::Args;
use gearbench_reports::gallery::{Entry, GENERATOR, gallery};
use gearbench_reports::store::PAGE;
use gearbench_reports::{RECORD, load_results};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Arguments of `view`.
#[derive(Args, Clone, Debug)]
pub struct View {
    /// Folder of a study, or a folder with the results of several
    #[arg(value_name = "FOLDER", default_value = "out")]
    pub folder: PathBuf,
    /// Print the path of the page and open nothing
    #[arg(long)]
    pub print: bool,
}

/// Depth of folders in which results are searched: `out/SCENE/STUDY` and one folder around it.
const DEPTH: usize = 4;
/// Largest number of results in a gallery.
const MOST_RESULTS: usize = 500;

/// Opens the page of a folder, and prints its path.
///
/// # Errors
/// [`Refusal::Input`] for a folder without results, or whose page is not gearbench's.
pub fn run(context: &Context, args: &View) -> Result<CommandResult, Refusal> {
    let folder = &args.folder;
    let page = match folder.join(RECORD).is_file() {
        true => report_of(folder)?,
        false => gallery_of(context, folder)?,
    };
    let page = absolute(page);
    let is_open = !args.print && open(&page);
    context
        .messages
        .print_line(&format!("page: {}", page.display()));
    if !args.print && !is_open {
        context
            .messages
            .print_line("no program was found that opens it; open it in a browser");
    }
    Ok(CommandResult::done()
        .with("page", page)
        .with("opened", is_open))
}

/// Returns the page of a study.
fn report_of(folder: &Path) -> Result<PathBuf, Refusal> {
    let page = folder.join(PAGE);
    match page.is_file() {
        true => Ok(page),
        false => Err(Refusal::Input(miette::miette!(
            help = format!(
                "write it from the record with `gearbench report {}`",
                folder.display()
            ),
            "{} has a record, but not its page {PAGE}",
            folder.display()
        ))),
    }
}

/// Writes the gallery of the results in a folder and returns its path.
fn gallery_of(context: &Context, folder: &Path) -> Result<PathBuf, Refusal> {
    if !folder.is_dir() {
        return Err(Refusal::Input(miette::miette!(
            help = "name the folder of a study (its `--out`, by default out/SCENE/STUDY) or a folder around several",
            "{} is not a folder",
            folder.display()
        )));
    }
    let mut found = Vec::new();
    add_results(folder, DEPTH, &mut found);
    found.sort();
    if found.len() > MOST_RESULTS {
        context.messages.warn(&format!(
            "{} has {} results; the gallery shows {MOST_RESULTS}",
            folder.display(),
            found.len()
        ));
        found.truncate(MOST_RESULTS);
    }
    let mut entries = Vec::new();
    for result in &found {
        check_record(result)?;
        match load_results(result) {
            Ok(results) => entries.push(Entry {
                folder: relative(folder, result),
                results,
            }),
            Err(e) => context.messages.warn(&format!("left out: {e}")),
        }
    }
    if entries.is_empty() {
        return Err(Refusal::Input(miette::miette!(
            help = "a study writes its results into out/SCENE/STUDY, or into the folder of `--out`",
            "{} has no results: no folder with a {RECORD} was found in it",
            folder.display()
        )));
    }
    let page = folder.join(PAGE);
    let is_foreign = |text: &str| !text.contains(&format!("content=\"{GENERATOR}\""));
    if std::fs::read_to_string(&page).is_ok_and(|text| is_foreign(&text)) {
        return Err(Refusal::Input(miette::miette!(
            help = "move the file, or view one of the results",
            "{} is not a gallery of gearbench and is not replaced",
            page.display()
        )));
    }
    let name = absolute(folder.to_owned());
    let name = name.file_name().map(|n| n.to_string_lossy().into_owned());
    let title = format!(
        "Results in {}",
        name.unwrap_or_else(|| folder.display().to_string())
    );
    let text = gallery(&title, &entries).map_err(|e| Refusal::Failed(e.to_string()))?;
    write_whole(&page, text)
        .map_err(|e| Refusal::Files(format!("{} cannot be written: {e}", page.display())))?;
    Ok(page)
}

/// Adds all folders with a record, to some depth. Folders that cannot be read and links have none.
fn add_results(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    if folder.join(RECORD).is_file() {
        found.push(folder.to_owned());
    }
    if depth == 0 {
        return;
    }
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_type().is_ok_and(|t| t.is_dir()) {
            add_results(&entry.path(), depth - 1, found);
        }
    }
}

/// Returns the path of a result from the folder of the gallery, with `/` between its parts.
fn relative(folder: &Path, result: &Path) -> String {
    let path = result.strip_prefix(folder).unwrap_or(result);
    let parts = path.iter().map(|part| part.to_string_lossy());
    parts.collect::<Vec<_>>().join("/")
}

/// Starts the program of the system that opens a page; true if it was started. On Linux and its relatives nothing is
/// started without a display.
fn open(page: &Path) -> bool {
    let (program, arguments): (&str, &[&str]) = match std::env::consts::OS {
        "windows" => ("cmd", &["/C", "start", ""]),
        "macos" => ("open", &[]),
        _ => ("xdg-open", &[]),
    };
    let displays = ["DISPLAY", "WAYLAND_DISPLAY"];
    let has_display = |name: &&str| std::env::var_os(name).is_some_and(|x| !x.is_empty());
    if program == "xdg-open" && !displays.iter().any(has_display) {
        return false;
    }
    let mut command = Command::new(program);
    command.args(arguments).arg(page).stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().is_ok()
}
