//! Why a command ends without doing its work, and how that comes of the errors below it.

use super::exit::Exit;
use crate::experiment::error::StudyError;
use crate::experiment::run::RunError;
use crate::scene_file::{SceneError, SceneFile};
use gearbench_reference::statics::StaticsError;
use miette::Report;

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

impl Refusal {
    /// How the command ends, and what it says.
    pub fn told(self) -> (Exit, Report) {
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

/// Why a run could not start, for the user.
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
