//! What the choice answers, and the order in which it asks.

use super::candidate::{Candidate, Prepared, Rung};
use super::climb::{Climb, climb};
use super::scout::Window;
use super::situation::Situation;
use super::wish::Wish;
use super::{domain, pick, scout};
use crate::experiment::run::RunError;
use gearbench_integrators::Scheme;
use gearbench_models::error::BuildError;

/// Why there is no answer at all.
#[derive(Debug, thiserror::Error)]
pub enum ChooseError {
    /// The scene cannot be assembled.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A run could not start, or was stopped by the user.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Teeth stay apart.
    #[error(
        "no teeth touch within {duration:.3e} s; there is no contact to choose a model for: simulate longer, or start closer"
    )]
    NoContact {
        /// Duration of the scene [s].
        duration: f64,
    },
    /// The elastic gears do not run.
    #[error(
        "the elastic gears that all models are held against do not reach the end of the window: {0}"
    )]
    Ladder(String),
}

/// How a rung did on the window.
#[derive(Clone, Debug)]
pub struct RungTried {
    /// The rung.
    pub rung: Rung,
    /// Integrator and resolution that make its own error small.
    pub method: Scheme,
    /// Distance to the top rung in the metric; what the top rung itself is off is not in it.
    pub distance: f64,
    /// Distance to the next denser rung, where the ladder goes on.
    pub step_up: Option<f64>,
    /// Estimated error over the whole scene.
    pub error: f64,
    /// Keeps the tolerance.
    pub adequate: bool,
    /// The cheapest adequate integrator and resolution, and its predicted cost for the whole scene [s].
    pub cheapest: Option<(Candidate, f64)>,
    /// Set-up on this machine, caches as they were [s].
    pub setup_s: f64,
    /// Why its numbers are not to be used, if so.
    pub failure: Option<String>,
}

/// A candidate that was run on the window.
#[derive(Clone, Debug)]
pub struct Tried {
    /// It.
    pub candidate: Candidate,
    /// Estimated error over the whole scene.
    pub error: f64,
    /// Predicted cost for the whole scene [s].
    pub cost_s: f64,
    /// Keeps the tolerance.
    pub adequate: bool,
    /// Steps and force evaluations on the window.
    pub work: [u64; 2],
    /// How the run failed, if so.
    pub failure: Option<String>,
}

/// The answer.
#[derive(Clone, Debug)]
pub struct Choice {
    /// What to run; `None` when nothing is adequate.
    pub candidate: Option<Candidate>,
    /// Estimated error of it over the whole scene, or the least there is.
    pub predicted_error: f64,
    /// Parts of it: the model against the top rung, the integrator against the model's own fine solution, what the top
    /// rung is off, and the factor from the window to the whole scene.
    pub parts: Parts,
    /// Time for the whole scene on this machine [s].
    pub predicted_cost_s: f64,
    /// Time of the set-up (mesh, modes; kept on disk for next time), beside the cost [s].
    pub setup_s: f64,
    /// The reason, a sentence each.
    pub reason: Vec<String>,
    /// The ladder.
    pub rungs: Vec<RungTried>,
    /// All that was run on the window.
    pub tried: Vec<Tried>,
    /// The window.
    pub window: Window,
    /// In which ways the scene lies outside of what the choice has been checked on.
    pub outside: Vec<String>,
}

/// Parts of an estimated error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts {
    /// Rung against the top rung.
    pub model: f64,
    /// Method against the rung's own fine solution.
    pub integration: f64,
    /// Top rung against the limit of the ladder.
    pub top: f64,
    /// Factor by which errors grow from the window to the whole scene.
    pub growth: f64,
}

/// Chooses. `progress` is told what is being done.
///
/// # Errors
/// [`ChooseError`] when there is no answer at all; that nothing is adequate is an answer.
pub fn choose(
    situation: &Situation,
    wish: &Wish,
    mut progress: impl FnMut(&str),
) -> Result<Choice, ChooseError> {
    progress("static solves");
    let prepared = Prepared::of(situation)?;
    progress("rigid run through the scene");
    let scouted = prepared.best_rigid();
    let window = scout::window(situation, scouted, &prepared.swing, wish.metric)?;
    let growth = scout::growth(situation, scouted, &window, &prepared.swing, wish.metric)?;
    let ladder: Climb = climb(situation, &prepared, &window, wish, growth, &mut progress)?;
    let picked = pick::pick(situation, &prepared, &window, wish, ladder, &mut progress)?;
    Ok(Choice {
        outside: domain::outside(situation, &prepared),
        window,
        ..picked
    })
}
