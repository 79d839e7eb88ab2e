//! Refusals: reasons why a command ends without result, and their exit codes.

use super::exit::Exit;
use crate::experiment::error::StudyError;
use crate::experiment::run::RunError;
use crate::scene_file::{SceneError, SceneFile};
use gearbench_reference::statics::StaticsError;
use miette::Report;

/// Reason why a command ended without result.
#[derive(Debug)]
pub enum Refusal {
    /// The input of the command is wrong.
    Input(Report),
    /// Files could not be read or written.
    Files(String),
    /// A requested computation failed.
    Failed(String),
    /// The user interrupted the command before there was a result.
    Interrupted,
}

impl Refusal {
    /// The exit code and the message of the refusal.
    pub fn into_report(self) -> (Exit, Report) {
        match self {
            Refusal::Input(report) => (Exit::BadInput, report),
            Refusal::Files(message) => (Exit::BadInput, Report::msg(message)),
            Refusal::Failed(message) => (Exit::FailedRun, Report::msg(message)),
            Refusal::Interrupted => (
                Exit::Interrupted,
                miette::miette!(
                    help = "the same command continues after the finished parts",
                    "the command was interrupted before it had any results"
                ),
            ),
        }
    }
}

impl From<SceneError> for Refusal {
    fn from(e: SceneError) -> Self {
        Refusal::Input(e.into())
    }
}

/// Converts the error of a run to a refusal.
pub fn refuse_run(e: RunError) -> Refusal {
    match e {
        RunError::Build(e) => Refusal::Input(miette::miette!("{e}")),
        e @ (RunError::Method(_) | RunError::Unsupported(_)) => Refusal::Input(miette::miette!(
            help = "`gearbench list` names the integrators; the step or tolerance follows an @, as in rk4@1us or dopri5@1e-6",
            "{e}"
        )),
        e @ RunError::NoLinearPart(_) => Refusal::Input(miette::miette!("{e}")),
        RunError::Reference(e) => Refusal::Failed(e),
        RunError::Refused(_) => Refusal::Failed(e.to_string()),
        RunError::Interrupted => Refusal::Interrupted,
        RunError::Picture(e) => Refusal::Files(e),
        RunError::Journal(e) => Refusal::Files(e.to_string()),
    }
}

/// Converts the error of a study to a refusal; an error of assembly names its line in the scene.
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
