//! The end of a command on the terminal, with functions that commands share.

use super::arguments::AnyReference;
pub use super::command_line::command_line;
use super::command_result::{self, CommandResult};
use super::exit::Exit;
pub use super::refusal::{Refusal, refuse_run, refuse_study};
use crate::context::Context;
use crate::experiment::run::RunError;
use crate::messages::{Messages, OutputForm, print_error, put_error};
use crate::scene_file::SceneFile;
use crate::scene_file::references::LoadedReference;
use gearbench_integrators::Scheme;
use gearbench_reference::data::Reference;
use gearbench_reports::escape;
use miette::Report;
use std::io::{self, ErrorKind, IsTerminal};
use std::path::PathBuf;
use std::process::ExitCode;

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

/// Reports the result of a command and returns its exit code.
pub fn end(context: &Context, command: &str, result: Result<CommandResult, Refusal>) -> ExitCode {
    let messages = &context.messages;
    if let Some(why) = context.resources.cache.trouble() {
        messages.warn(&format!(
            "reductions cannot be stored in the cache: {why}; set GEARBENCH_CACHE to another folder, or to `off`"
        ));
    }
    let warnings = messages.warnings();
    let exit = match result {
        Ok(answer) => {
            let exit = answer.exit;
            if messages.form == OutputForm::Json {
                messages.print_text(&answer.json(command, warnings).to_string());
                if output_is_closed() {
                    messages.fail(io::Error::other("it is closed"));
                }
            }
            exit
        }
        Err(refusal) => {
            let (exit, report) = refusal.into_report();
            print_refusal(messages, command, exit, &report, warnings);
            exit
        }
    };
    // A reader of text lines may close the pipe early; an incomplete JSON object is an error.
    let enough =
        |e: &io::Error| e.kind() == ErrorKind::BrokenPipe && messages.form != OutputForm::Json;
    match messages.take_failure().filter(|e| !enough(e)) {
        None => exit.into(),
        Some(e) => {
            let report = miette::miette!(
                help = "the files of the command are complete",
                "standard output cannot be written: {e}"
            );
            print_refusal(messages, command, Exit::BadInput, &report, Vec::new());
            Exit::BadInput.into()
        }
    }
}

/// Prints an error to standard error.
pub(super) fn print_refusal(
    messages: &Messages,
    command: &str,
    exit: Exit,
    report: &Report,
    warnings: Vec<String>,
) {
    match messages.form {
        OutputForm::Json => {
            put_error(&command_result::refusal(command, exit, report, warnings).to_string());
        }
        // A terminal gets colours, a file or a pipe none.
        _ if io::stderr().is_terminal() => put_error(&escape::coloured(&format!("{report:?}"))),
        _ => print_error(&format!("{report:?}")),
    }
}

/// Returns the integrators of an option, whose steps have to suit the scene; `None` without the option.
///
/// # Errors
/// A refusal of an integrator that does not exist, or of its step.
pub fn integrators_of(
    scene: &SceneFile,
    option: Option<&str>,
) -> Result<Option<Vec<Scheme>>, Refusal> {
    let Some(text) = option else {
        return Ok(None);
    };
    let methods = Scheme::list(text, &scene.study.integrators)
        .map_err(RunError::from)
        .map_err(refuse_run)?;
    scene.check_steps(&methods)?;
    Ok(Some(methods))
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
    (scene.odd[known..].iter()).for_each(|odd| scene.context.messages.warn(&odd.to_text()));
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
    (scene.odd[known..].iter()).for_each(|odd| scene.context.messages.warn(&odd.to_text()));
    Ok(references)
}
