//! The choice of a model: its result, and the sequence of refinement, levels and candidates that leads to it.

use super::detail::{Detail, Details};
use super::level::Level;
use super::pilot::Window;
use super::plan::{Candidate, CandidateData, MODES};
use super::problem::Problem;
use super::refinement::{refine, refine_over};
use super::requirement::{Requirement, is_scalar};
use super::{domain, pilot, selection};
use crate::experiment::run::RunError;
use gearbench_integrators::Scheme;
use gearbench_models::error::BuildError;
use gearbench_reports::{Adequacy, ForceStatistics, ReferenceDistance, Verdict};

/// Numbers of modes of which the statistics are described where a history does not repeat.
const FEW: usize = 2;

/// Error that prevents any result of the choice.
#[derive(Debug, thiserror::Error)]
pub enum ChooseError {
    /// The scene cannot be assembled.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A run could not start, or was stopped by the user.
    #[error(transparent)]
    Run(#[from] RunError),
    /// No teeth come into contact within the duration of the scene.
    #[error(
        "no teeth touch within {duration:.3e} s; there is no contact to choose a model for: simulate longer, or start closer"
    )]
    NoContact {
        /// Duration of the scene [s].
        duration: f64,
    },
    /// The budget is spent before an error can be estimated.
    #[error(
        "the budget of {0} is spent before two levels of elastic gears have run, and no error can be estimated: allow more with --budget, or give the elastic model fewer elements (`flank_elements`, `rim_elements`)"
    )]
    Budget(String),
    /// The elastic gears do not run.
    #[error(
        "the elastic gears that all models are compared with do not reach the end of the window: {0}"
    )]
    Hierarchy(String),
}

/// Result of a level on the window.
#[derive(Clone, Debug)]
pub struct LevelResult {
    /// Level of the model hierarchy.
    pub level: Level,
    /// Integrator and resolution with a negligible integration error.
    pub method: Scheme,
    /// Distance to the top level in the metric, without the error of the top level itself.
    pub distance: f64,
    /// Distance to the next denser level, where there is one.
    pub step_up: Option<f64>,
    /// Estimated error against the top level over the whole scene.
    pub error: f64,
    /// Verdict on the estimated error against the tolerance.
    pub adequate: Adequacy,
    /// Statistics of the contact force on the window, where its history does not repeat.
    pub statistics: Option<ForceStatistics>,
    /// The cheapest adequate integrator and resolution, and its predicted cost for the whole scene [s].
    pub cheapest: Option<(Candidate, f64)>,
    /// Processor time of the set-up on this machine, caches as they were [s].
    pub setup_s: f64,
    /// Reason why the results of the level are not usable; `None` if they are.
    pub failure: Option<String>,
}

/// Candidate with its result on the window.
#[derive(Clone, Debug)]
pub struct CandidateResult {
    /// Model, integrator and resolution that were tried.
    pub candidate: Candidate,
    /// Estimated error against the top level over the whole scene.
    pub error: f64,
    /// Predicted processor time of one run of the whole scene [s].
    pub cost_s: f64,
    /// Verdict on the estimated error against the tolerance.
    pub adequate: Adequacy,
    /// Steps and force evaluations on the window.
    pub work: [u64; 2],
    /// Reason of the failure of the run; `None` if it succeeded.
    pub failure: Option<String>,
}

/// Result of `choose`: the candidate with its estimated error and cost, and all that was tried.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Verdict of the whole choice.
    pub verdict: Verdict,
    /// The chosen candidate; `None` when nothing is adequate, or when it is not decided.
    pub candidate: Option<Candidate>,
    /// Top level of the hierarchy, with which all others are compared.
    pub yardstick: Candidate,
    /// Estimated error of the yardstick itself over the whole scene; `None` where it is not known, and nothing is judged.
    pub own_error: Option<f64>,
    /// Part of the yardstick's error that is due to a history that does not repeat.
    pub scatter: f64,
    /// Reason why the history does not repeat; `None` if it does.
    pub not_repeatable: Option<String>,
    /// Distances of the yardstick and of the choice to references of the scene.
    pub references: Vec<ReferenceDistance>,
    /// Number of runs over which the set-up is distributed.
    pub runs: u64,
    /// Processor time of the choice for all runs with one set-up [s].
    pub total_cost_s: f64,
    /// Estimated error of the choice against the yardstick over the whole scene, or the least there is.
    pub predicted_error: f64,
    /// Parts of the predicted error: the model against the top level, the integrator against the model's own fine
    /// solution, the error of the top level, and the growth from the window to the whole scene.
    pub parts: Parts,
    /// Processor time of one run of the whole scene on this machine [s].
    pub predicted_cost_s: f64,
    /// Processor time of the set-up (mesh, modes; kept on disk for next time) [s].
    pub setup_s: f64,
    /// Sentences that explain the choice.
    pub reason: Vec<String>,
    /// Levels of the model hierarchy that were tried.
    pub levels: Vec<LevelResult>,
    /// All candidates that were run on the window.
    pub tried: Vec<CandidateResult>,
    /// Window of the scene on which the models were compared.
    pub window: Window,
    /// Properties of the scene that lie outside of the range in which the choice has been validated.
    pub outside: Vec<String>,
    /// Mesh and contact of the elastic gears, those of the yardstick included.
    pub details: Details,
    /// Levels and candidates for which no processor time was left.
    pub not_tried: Vec<String>,
}

/// Parts of an estimated error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts {
    /// Error of the level against the top level.
    pub model: f64,
    /// Error of the integrator against the level's own fine solution.
    pub integration: f64,
    /// Error of the top level against the limit of the hierarchy of modes.
    pub top: f64,
    /// Error of the top level against the limit of finer and finer meshes, where it is known.
    pub mesh: Option<f64>,
    /// Integration error of the top level against its own limit of short steps.
    pub top_integration: f64,
    /// Factor by which errors grow from the window to the whole scene.
    pub growth: f64,
}

/// Chooses the cheapest adequate candidate of a problem. `progress` receives descriptions of the steps.
///
/// # Errors
/// [`ChooseError`] when there is no result at all; that no candidate is adequate is a result.
pub fn choose(
    problem: &Problem,
    requirement: &Requirement,
    mut progress: impl FnMut(&str),
) -> Result<Choice, ChooseError> {
    progress("static solves");
    let prepared = CandidateData::of(problem)?;
    let on_half_spaces = prepared.details.lead.detail == Detail::HalfSpaces;
    match choose_among(problem, prepared, requirement, &mut progress) {
        Err(ChooseError::Hierarchy(why)) if on_half_spaces => {
            progress("static solves");
            let why = format!("no run on half-spaces is sound ({why})");
            let prepared = CandidateData::with(problem, Details::as_given(problem, why))?;
            choose_among(problem, prepared, requirement, &mut progress)
        }
        other => other,
    }
}

/// Chooses with elastic gears that are meshed and touch in a way that was found.
fn choose_among(
    problem: &Problem,
    prepared: CandidateData,
    requirement: &Requirement,
    progress: &mut impl FnMut(&str),
) -> Result<Choice, ChooseError> {
    progress("rigid run through the scene");
    let pilot_level = prepared.best_rigid();
    let window = pilot::window(
        problem,
        pilot_level,
        &prepared.oscillator,
        requirement.metric,
    )?;
    let sensitivity = pilot::sensitivity(
        problem,
        pilot_level,
        &window,
        &prepared.oscillator,
        requirement.metric,
    )?;
    // A history that does not repeat is not judged, and need not be refined.
    let growth = sensitivity.growth;
    let judged = sensitivity.not_repeatable.is_none() || is_scalar(requirement.metric);
    let hierarchy = match judged {
        true => refine(problem, &prepared, &window, requirement, growth, progress)?,
        false => {
            let what = (problem, &prepared, &window);
            refine_over(what, (requirement, growth), &MODES[..FEW], progress)?
        }
    };
    let selected = selection::select(
        problem,
        &prepared,
        &window,
        requirement,
        (hierarchy, &sensitivity),
        progress,
    )?;
    Ok(Choice {
        outside: domain::outside(problem, &prepared),
        window,
        ..selected
    })
}
