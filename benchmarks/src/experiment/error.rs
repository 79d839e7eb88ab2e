//! Errors of runs and studies. A run that fails during integration is a row of the record, not an error.

use super::journal::JournalError;
use gearbench_integrators::MethodError;
use gearbench_models::error::{BuildError, Fault};
use gearbench_models::scene::{Coupling, Scene};
use gearbench_models::spec::SceneSpec;
use gearbench_reference::limits::TooMuchMemory;
use gearbench_reference::statics::StaticsError;

/// Reason why a run could not start, or was stopped by the user.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene cannot be assembled.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The integrator is unknown or its parameters are wrong.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The integrator does not support the request.
    #[error("{0}")]
    Unsupported(String),
    /// The integrator needs a linear part, which the model does not have.
    #[error(transparent)]
    NoLinearPart(#[from] CoupledCoordinates),
    /// A reference run did not reach the end.
    #[error("{0}")]
    Reference(String),
    /// The run would need more memory than allowed.
    #[error(transparent)]
    Refused(#[from] TooMuchMemory),
    /// The frames cannot be written.
    #[error("{0}")]
    Picture(String),
    /// The user interrupted the run.
    #[error("interrupted")]
    Interrupted,
    /// The journal of finished runs cannot be read or written.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// Refusal of a method for independent oscillators by a scene with coupled coordinates.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{method}` needs coordinates that are independent oscillators: {why}; {}name another integrator for this model, for example dopri5 or hht-alpha",
    .without.as_ref().map_or_else(String::new, |w| format!("omit them with {w}, or "))
)]
pub struct CoupledCoordinates {
    /// Id of the method.
    pub method: String,
    /// Cause of the coupling.
    pub why: String,
    /// The key that omits the coupling terms, where there is one.
    pub without: Option<String>,
}

impl RunError {
    /// The refusal of a method for uncoupled oscillators by a scene with coupled coordinates: the reason, and advice.
    pub fn no_linear_part(method: &str, scene: &Scene, spec: &SceneSpec) -> RunError {
        let name = |i: usize| spec.gears.get(i).map_or("", |g| g.name.as_str());
        let mut without = None;
        let why = match scene.coupling() {
            Some(Coupling::Carrier) => "the rotation of the carrier couples the gears on it".into(),
            Some(Coupling::Gyroscopic(i)) => {
                without = Some("`spin_terms = \"off\"` of the gears on bearings".into());
                format!(
                    "gyroscopic terms couple the directions of `{}` on its bearing",
                    name(i)
                )
            }
            Some(Coupling::Coriolis(i)) => {
                without = Some("`spin_terms = \"none\"` in the parameters of the model".into());
                format!("Coriolis forces couple the modes of `{}`", name(i))
            }
            Some(Coupling::Bearing(i)) => format!(
                "the bearing of `{}` has clearance or couples its directions",
                name(i)
            ),
            Some(Coupling::Gear(i)) => format!(
                "the coordinates of `{}` are coupled, in contrast to those of rigid and elastic gears",
                name(i)
            ),
            Some(Coupling::Shaft) | None => "a rigid shaft couples coordinates that vibrate".into(),
        };
        RunError::NoLinearPart(CoupledCoordinates {
            method: method.to_owned(),
            why,
            without,
        })
    }

    /// True if the method does not apply to the model, so that a study omits the pair and continues.
    pub fn leaves_out(&self) -> bool {
        matches!(self, RunError::NoLinearPart(_) | RunError::Unsupported(_))
    }
}

/// Errors that can mean that a model cannot run its scene: studies record this as a row and go on with other models.
pub trait ModelRefusal {
    /// The reason why the model cannot run; `None` for any other error.
    fn refusal(&self) -> Option<String>;
}

impl ModelRefusal for BuildError {
    fn refusal(&self) -> Option<String> {
        (self.fault == Fault::Model).then(|| self.to_string())
    }
}

impl ModelRefusal for RunError {
    fn refusal(&self) -> Option<String> {
        match self {
            RunError::Build(e) => e.refusal(),
            RunError::Refused(e) => Some(e.to_string()),
            _ => None,
        }
    }
}

impl ModelRefusal for StudyError {
    fn refusal(&self) -> Option<String> {
        match self {
            StudyError::Run(e) => e.refusal(),
            StudyError::Statics(_, StaticsError::Build(e)) => e.refusal(),
            StudyError::Statics(_, e) => Some(e.to_string()),
            _ => None,
        }
    }
}

/// Reason why a study ends early.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A run could not start, or a reference run did not reach its end.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The model with this label has no static equilibrium.
    #[error("{0}: {1}")]
    Statics(String, StaticsError),
    /// The scene or model is not suitable for this study: reason and advice.
    #[error("{0}")]
    Scene(String, &'static str),
    /// The journal of finished runs cannot be read or written.
    #[error(transparent)]
    Journal(#[from] JournalError),
}
