//! What commands share: files of a study, lines on the terminal, refusals and exit codes.
//!
//! Exit codes: 0 done, 1 a result fell short (kept for regression checks), 2 bad input, 3 a run failed to
//! finish. Nothing is written when the input is refused.

use crate::experiment::conditions::Progress;
use crate::experiment::error::StudyError;
use crate::experiment::run::RunError;
use crate::scene_file::{SceneError, SceneFile};
use gearbench_reference::ExternalReference;
use gearbench_reference::statics::StaticsError;
use gearbench_reports::record::Results;
use indicatif::{ProgressBar, ProgressStyle};
use miette::Report;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// A result fell short of what was asked.
pub const FELL_SHORT: u8 = 1;
/// Bad input.
pub const BAD_INPUT: u8 = 2;
/// A run failed to finish.
pub const FAILED_RUN: u8 = 3;

/// Why a command ended without doing its work.
#[derive(Debug)]
pub enum Refusal {
    /// The input is wrong.
    Input(Report),
    /// Files could not be written or read.
    Files(String),
    /// Something that was asked for could not be computed.
    Failed(String),
}

impl From<SceneError> for Refusal {
    fn from(e: SceneError) -> Self {
        Refusal::Input(e.into())
    }
}

/// Says how a command ended.
pub fn end(result: Result<ExitCode, Refusal>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(Refusal::Input(report)) => {
            say_error(&format!("{report:?}"));
            ExitCode::from(BAD_INPUT)
        }
        Err(Refusal::Files(message)) => {
            say_error(&format!("error: {message}"));
            ExitCode::from(BAD_INPUT)
        }
        Err(Refusal::Failed(message)) => {
            say_error(&format!("error: {message}"));
            ExitCode::from(FAILED_RUN)
        }
    }
}

/// The command line as it was given, with the program's own name instead of its path.
pub fn told(program: &str) -> String {
    let quote = |a: String| {
        let plain = !a.is_empty()
            && a.chars()
                .all(|c| c.is_ascii_alphanumeric() || "-_./=@,:+".contains(c));
        if plain {
            a
        } else {
            format!("'{}'", a.replace('\'', "'\\''"))
        }
    };
    let arguments: Vec<String> = std::env::args().skip(1).map(quote).collect();
    format!("{program} {}", arguments.join(" "))
}

/// The folder of a study.
pub fn folder(out: Option<&Path>, scene: &str, study: &str) -> PathBuf {
    out.map_or_else(|| Path::new("out").join(scene).join(study), Path::to_owned)
}

/// Writes the folder of a study, prints its summary and where everything lies.
pub fn write(
    results: &Results,
    (out, scene): (Option<&Path>, &str),
    summarise: impl FnOnce(&Results),
) -> Result<(), Refusal> {
    let dir = folder(out, scene, results.study().as_str());
    let page = gearbench_reports::write_results(&dir, results)
        .map_err(|e| Refusal::Files(e.to_string()))?;
    summarise(results);
    say(&format!("record: {}", dir.join("results.json").display()));
    let absolute = page.canonicalize().unwrap_or(page);
    say(&format!("report: {}", absolute.display()));
    Ok(())
}

/// Exit code of a study whose runs are to finish.
pub fn exit_code(results: &Results) -> ExitCode {
    if results.runs.iter().any(|r| r.status.is_failure()) {
        ExitCode::from(FAILED_RUN)
    } else {
        ExitCode::SUCCESS
    }
}

/// Why a run could not start, for the user.
pub fn refuse_run(e: RunError) -> Refusal {
    match e {
        RunError::Build(e) => Refusal::Failed(e.to_string()),
        e @ (RunError::Method(_) | RunError::Unsupported(_)) => Refusal::Input(miette::miette!(
            help = "`gearbench list` names the integrators; a step or tolerance follows an @, as in rk4@1us or dopri5@1e-6",
            "{e}"
        )),
        e @ RunError::NoLinearPart(_) => Refusal::Input(miette::miette!("{e}")),
        RunError::Reference(e) => Refusal::Failed(e),
    }
}

/// A line on the terminal.
#[allow(clippy::print_stdout)]
pub fn say(text: &str) {
    println!("{text}");
}

#[allow(clippy::print_stderr)]
fn say_error(text: &str) {
    eprintln!("{text}");
}

/// A progress bar on a terminal, nothing otherwise.
pub fn progress_bar(length: usize) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(length as u64);
    let style = ProgressStyle::with_template("{bar:30} {pos:>3}/{len} {elapsed:>4}  {wide_msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.set_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// Does a study under a progress bar.
pub fn with_progress<T>(length: usize, study: impl FnOnce(Progress<'_>) -> T) -> T {
    let bar = progress_bar(length);
    let done = study(&|done, total, what| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        bar.set_message(what.to_string());
    });
    bar.finish_and_clear();
    done
}

/// The stored reference of a scene.
pub fn stored_reference(scene: &SceneFile) -> Result<Option<ExternalReference>, Refusal> {
    (scene
        .reference
        .as_deref()
        .map(gearbench_reference::reference))
    .transpose()
    .map_err(|e| Refusal::Files(e.to_string()))
}

/// Why a study ended, for the user: an error of assembly at its line of the scene.
pub fn refuse_study(scene: &SceneFile, e: StudyError) -> Refusal {
    match e {
        StudyError::Run(e) => refuse_run(e),
        StudyError::Statics(label, StaticsError::Build(e)) if scene.model(&label).is_some() => {
            Refusal::from(scene.locate_in(&label, &e))
        }
        StudyError::Statics(..) => Refusal::Failed(e.to_string()),
        StudyError::Scene(why, help) => Refusal::from(SceneError::plain(why, help)),
        StudyError::Journal(e) => Refusal::Files(e.to_string()),
    }
}
