//! What commands share: files of a study, lines on the terminal, refusals and exit codes.
//!
//! Exit codes: 0 done, 1 a result fell short (kept for regression checks), 2 bad input, 3 a run failed to
//! finish, 130 interrupted. Nothing is written when the input is refused.

use crate::experiment::error::StudyError;
use crate::experiment::run::RunError;
use crate::scene_file::{SceneError, SceneFile};
use gearbench_reference::ExternalReference;
use gearbench_reference::statics::StaticsError;
use gearbench_reports::record::Results;
use miette::Report;
use std::process::ExitCode;

/// A result fell short of what was asked.
pub const FELL_SHORT: u8 = 1;
/// Bad input.
pub const BAD_INPUT: u8 = 2;
/// A run failed to finish.
pub const FAILED_RUN: u8 = 3;
/// Interrupted; what was finished is reported.
pub const INTERRUPTED: u8 = 130;

/// Why a command ended without doing its work.
#[derive(Debug)]
pub enum Refusal {
    /// The input is wrong.
    Input(Report),
    /// Files could not be written or read.
    Files(String),
    /// Something that was asked for could not be computed.
    Failed(String),
    /// The user ended it before there was anything to report.
    Interrupted,
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
        Err(Refusal::Interrupted) => {
            say_error(
                "interrupted before there was anything to report; the same command goes on with what is finished",
            );
            ExitCode::from(INTERRUPTED)
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
        RunError::Refused(_) => Refusal::Failed(e.to_string()),
        RunError::Interrupted => Refusal::Interrupted,
        RunError::Journal(e) => Refusal::Files(e.to_string()),
    }
}

/// A line on the terminal.
#[allow(clippy::print_stdout)]
pub fn say(text: &str) {
    println!("{text}");
}

/// A line on standard error.
#[allow(clippy::print_stderr)]
pub fn say_error(text: &str) {
    eprintln!("{text}");
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
