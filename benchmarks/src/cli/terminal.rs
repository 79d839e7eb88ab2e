//! The only writer to standard output and standard error, with functions that commands share.
//!
//! Standard output contains the result: lines of text, or one JSON object (`--json`), or nothing (`--quiet`). Standard
//! error contains refusals, warnings and progress. A closed pipe (`gearbench list | head -1`) ends the output but not
//! the command, whose files and exit code stay the same. A full disk behind standard output is an error, and so is a
//! JSON object that cannot be written.

use super::arguments::AnyReference;
pub use super::command_line::command_line;
use super::command_result::{self, CommandResult};
use super::exit::Exit;
pub use super::refusal::{Refusal, refuse_run, refuse_study};
use crate::scene_file::SceneFile;
use crate::scene_file::references::LoadedReference;
use gearbench_reference::data::Reference;
use gearbench_reports::escape;
use miette::Report;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Mutex, OnceLock};

/// Form of the output: text, nothing, or JSON.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutputForm {
    /// Lines of text for a human reader.
    #[default]
    Lines,
    /// No output: files, warnings and the exit code only.
    Quiet,
    /// One JSON object for a program.
    Json,
}

/// The form of the output, chosen once before the first line.
static MANNER: OnceLock<OutputForm> = OnceLock::new();
/// The first write error; nothing is written after it.
static FAILED: Mutex<Option<io::Error>> = Mutex::new(None);
/// Warnings so far, for the JSON object.
static WARNINGS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Chooses the form of the output; later calls have no effect.
pub fn choose(manner: OutputForm) {
    let _ = MANNER.set(manner);
}

/// The chosen form of the output.
pub fn manner() -> OutputForm {
    MANNER.get().copied().unwrap_or_default()
}

/// Prints a line of text to standard output, escaped by [`escape::terminal`]; without effect for JSON and quiet output.
pub fn print_line(text: &str) {
    if manner() == OutputForm::Lines {
        print_text(&escape::terminal(text));
    }
}

/// Prints text to standard output in every form of output.
pub fn print_text(text: &str) {
    let Ok(mut failed) = FAILED.lock() else {
        return;
    };
    if failed.is_none() {
        let mut out = io::stdout().lock();
        *failed = writeln!(out, "{text}").and_then(|()| out.flush()).err();
    }
}

/// Stores the first write error.
fn fail(e: io::Error) {
    if let Ok(mut failed) = FAILED.lock() {
        failed.get_or_insert(e);
    }
}

/// True if standard output was closed when the program began. The runtime then opens the null device for reading and
/// writing in its place, which a redirection of an output does not.
fn output_is_closed() -> bool {
    let null = std::fs::read_link("/proc/self/fd/1").is_ok_and(|to| to.as_os_str() == "/dev/null");
    let info = std::fs::read_to_string("/proc/self/fdinfo/1").unwrap_or_default();
    let flags = info.lines().find_map(|l| l.strip_prefix("flags:"));
    let flags = flags.and_then(|f| u32::from_str_radix(f.trim(), 8).ok());
    const BOTH: u32 = 0o2;
    null && flags.is_some_and(|f| f & 0o3 == BOTH)
}

/// Prints a warning to standard error, or adds it to the warnings of the JSON object; each text once.
pub fn warn(text: &str) {
    let Ok(mut warnings) = WARNINGS.lock() else {
        return;
    };
    if warnings.iter().any(|w| w == text) {
        return;
    }
    warnings.push(text.to_owned());
    if manner() != OutputForm::Json {
        print_error(&format!("warning: {text}"));
    }
}

/// Prints a line of text to standard error, escaped by [`escape::terminal`].
pub fn print_error(text: &str) {
    put_error(&escape::terminal(text));
}

/// Writes text to standard error; write errors are ignored.
fn put_error(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Reports the result of a command and returns its exit code.
pub fn end(command: &str, result: Result<CommandResult, Refusal>) -> ExitCode {
    if let Some(why) = gearbench_reference::reduction::cache::trouble() {
        warn(&format!(
            "reductions cannot be stored in the cache: {why}; set GEARBENCH_CACHE to another folder, or to `off`"
        ));
    }
    let warnings = WARNINGS.lock().map_or_else(|_| Vec::new(), |w| w.clone());
    let exit = match result {
        Ok(answer) => {
            let exit = answer.exit;
            if manner() == OutputForm::Json {
                print_text(&answer.json(command, warnings).to_string());
                if output_is_closed() {
                    fail(io::Error::other("it is closed"));
                }
            }
            exit
        }
        Err(refusal) => {
            let (exit, report) = refusal.into_report();
            print_refusal(command, exit, &report, warnings);
            exit
        }
    };
    let failed = FAILED.lock().ok().and_then(|mut f| f.take());
    // A reader of text lines may close the pipe early; an incomplete JSON object is an error.
    let enough = |e: &io::Error| e.kind() == ErrorKind::BrokenPipe && manner() != OutputForm::Json;
    match failed.filter(|e| !enough(e)) {
        None => exit.into(),
        Some(e) => {
            let report = miette::miette!(
                help = "the files of the command are complete",
                "standard output cannot be written: {e}"
            );
            print_refusal(command, Exit::BadInput, &report, Vec::new());
            Exit::BadInput.into()
        }
    }
}

/// Prints an error to standard error.
pub(super) fn print_refusal(command: &str, exit: Exit, report: &Report, warnings: Vec<String>) {
    match manner() {
        OutputForm::Json => {
            put_error(&command_result::refusal(command, exit, report, warnings).to_string());
        }
        // A terminal gets colours, a file or a pipe none.
        _ if io::stderr().is_terminal() => put_error(&escape::coloured(&format!("{report:?}"))),
        _ => print_error(&format!("{report:?}")),
    }
}

/// Converts a path to an absolute one.
pub fn absolute(path: PathBuf) -> PathBuf {
    path.canonicalize().unwrap_or(path)
}

/// Reads all references of a scene, also those at other speeds and loads; each must belong to its gears unless the user
/// insists.
///
/// # Errors
/// A refusal at the line of the scene, or of the file with the data.
pub fn all_references_of(
    scene: &mut SceneFile,
    insist: &AnyReference,
) -> Result<Vec<LoadedReference>, Refusal> {
    let known = scene.odd.len();
    let references = scene.load_references(insist.any_reference)?;
    (scene.odd[known..].iter()).for_each(|odd| warn(&odd.to_text()));
    Ok(references)
}

/// Reads the references under the conditions of the scene itself, which its models are compared with.
///
/// # Errors
/// As [`all_references_of`].
pub fn references_of(
    scene: &mut SceneFile,
    insist: &AnyReference,
) -> Result<Vec<Reference>, Refusal> {
    let known = scene.odd.len();
    let references = scene.load_own_references(insist.any_reference)?;
    (scene.odd[known..].iter()).for_each(|odd| warn(&odd.to_text()));
    Ok(references)
}
