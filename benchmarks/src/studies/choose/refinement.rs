//! Refinement of elastic gears on the window: more modes until the results converge, then a finer mesh with as many.
//!
//! With `d_i` the distance of level `i` to level `i + 1` in the metric, the refinement of modes ends where the last two are
//! both below a part of the tolerance, as errors grow over the scene; for a metric that is a single number the force
//! histories must agree as well, since two numbers may meet by chance. What the top level is still off is estimated as that
//! of a geometric series, `d q / (1 - q)` with `q` the ratio of the last two; that is to be as small.
//!
//! The distance of the [finer mesh](super::detail) with the modes of the top level is the error of the mesh. What the finer
//! one is still off itself follows from the order at which errors fall with the size of the elements: the second where
//! flanks touch on half-spaces, the first where they touch with their elements (`q` = 1/4 and 1/2). A distance beyond a fifth
//! is outside of the range of that order and counts whole.
//!
//! The **yardstick** is the top level. Its own error over the whole scene is the sum of the three parts on the window, by its
//! modes, its mesh and its integration, times the growth of errors from the window to the scene. The part by the integration
//! follows from a further run with twice the step, or with half of it where twice the step does not carry all modes, by the
//! second order of the method. Nothing is judged more precisely than that ([`Refinement::own_error`]).

use super::level::Level;
use super::pilot::Window;
use super::plan::{Candidate, CandidateData, MODES};
use super::problem::{ElasticSettings, Problem};
use super::reasons::per_cent;
use super::requirement::{Requirement, is_scalar};
use super::run::ChooseError;
use super::trial::{Outcome, WindowModel, cannot_run};
use crate::experiment::budget::NOT_TRIED;
use gearbench_integrators::modal::resonance::SAFE;
use gearbench_reports::Metric;
use gearbench_reports::numbers::quantile;

/// Steps per contact time of the refinement, for tolerances up to a limit, so that its integration error is negligible.
const STEPS: [(f64, f64); 3] = [(0.015, 512.0), (0.04, 256.0), (f64::INFINITY, 128.0)];
/// Part of the tolerance that the last two differences stay below.
const SETTLED: f64 = 0.25;
/// Multiple of the tolerance that the last two differences of the histories stay below, where the metric is a single
/// number.
const HISTORY: f64 = 2.0;
/// Least error of reduced gears against full ones of the same mesh, which no number of modes removes [-]: for
/// histories, for single numbers. No estimate goes below.
const FLOOR: [f64; 2] = [3e-3, 1e-3];
/// Bounds of the ratio of differences.
const RATIO: [f64; 2] = [0.3, 0.5];
/// Error of a step over the distance to twice and to half the step, of a method of the second order.
const OF_STEPS: [f64; 2] = [1.0 / 3.0, 4.0 / 3.0];
/// Least number of differences from which a decreasing trend can be judged.
const DIFFERENCES: usize = 4;
/// Differences of the later half over those of the first half from which on they do not fall, medians.
const STEADY: f64 = 0.5;
/// Ratio of the errors of a mesh to those of one with half the elements: on half-spaces, with the elements themselves.
const OF_MESHES: [f64; 2] = [0.25, 0.5];
/// Distance of two meshes up to which errors fall by that ratio.
const IN_ORDER: f64 = 0.2;

/// Returns the steps per contact time at which the integration error is negligible for a tolerance.
pub fn steps_per_contact(tolerance: f64) -> f64 {
    let found = STEPS.iter().find(|(limit, _)| tolerance < *limit);
    found.map_or(STEPS[2].1, |s| s.1)
}

/// Estimates the error of a mesh from its distance to one with half the elements; above the range of convergence, it is
/// the whole distance.
pub fn error_of_mesh(distance: f64, on_half_spaces: bool) -> f64 {
    let q = OF_MESHES[usize::from(!on_half_spaces)];
    match distance <= IN_ORDER {
        true => distance * q / (1.0 - q),
        false => distance,
    }
}

/// Level of elastic gears with its result on the window.
#[derive(Clone, Debug)]
pub struct RefinedLevel {
    /// Model, integrator and resolution of the run.
    pub candidate: Candidate,
    pub outcome: Outcome,
    /// Processor time of the set-up [s].
    pub setup_s: f64,
    /// Distance to the next level in the metric [-].
    pub step_up: Option<f64>,
}

/// Hierarchy of elastic gears as far as it was refined, with the error of its top level.
#[derive(Clone, Debug)]
pub struct Refinement {
    /// Levels that ran to the end, by modes, ascending.
    pub levels: Vec<RefinedLevel>,
    /// Level with as many modes as the last one, on a finer mesh, or the reason why there is none.
    pub finer: Result<RefinedLevel, String>,
    /// Estimated error of the top level on the window by the truncation of its modes [-].
    pub remaining: f64,
    /// Estimated error of the top level on the window by its mesh [-]; `None` without a finer mesh.
    pub of_finer: Option<f64>,
    /// Estimated error of integration of the top level on the window.
    pub integration: f64,
    /// Factor by which errors grow from the window to the scene.
    pub growth: f64,
    /// True if the differences between levels became small.
    pub settled: bool,
    /// Reason why differences between levels do not bound the error: they do not fall with more modes. `None` if they
    /// fall.
    pub not_convergent: Option<String>,
    /// Levels that cannot run, with the reason.
    pub refused: Vec<(Candidate, String)>,
    /// True if a finer mesh is possible but did not run, so that the error of the mesh is unknown.
    pub lacks_finer: bool,
    /// Levels for which no processor time was left.
    pub not_tried: Vec<String>,
    /// Integration steps per contact time.
    steps: f64,
}

impl Refinement {
    /// Returns the top level: the one on the finer mesh, else the one with most modes.
    pub fn top(&self) -> Option<&RefinedLevel> {
        self.finer.as_ref().ok().or(self.levels.last())
    }

    /// Returns the error of the mesh of the scene [-]: the distance of the finest modes on it to those on the finer
    /// mesh; `None` without a finer mesh.
    pub fn of_mesh(&self) -> Option<f64> {
        let last = self.levels.last().filter(|_| self.finer.is_ok());
        last.and_then(|l| l.step_up)
    }

    /// Returns the estimated error of the top level itself over the whole scene; `None` where it is unknown.
    pub fn own_error(&self) -> Option<f64> {
        let parts = self.remaining + self.of_finer.unwrap_or(0.0) + self.integration;
        let known = !self.lacks_finer && self.not_convergent.is_none();
        Some(self.growth * parts).filter(|e| known && e.is_finite())
    }

    /// Runs a further level at the same steps per contact time as the others.
    ///
    /// # Errors
    /// Why the run could not start, or why it is not to be used.
    pub fn further(
        &self,
        (problem, prepared, window): (&Problem, &CandidateData, &Window),
        of: &ElasticSettings,
        modes: usize,
    ) -> Result<Result<RefinedLevel, String>, ChooseError> {
        let candidate = prepared.at_steps(problem, of, modes, self.steps);
        match level(problem, candidate, window) {
            Err(ChooseError::Run(e)) => match cannot_run(&e) {
                Some(why) => Ok(Err(why)),
                None => Err(e.into()),
            },
            other => other,
        }
    }
}

/// Error of integration of a level on the window, estimated by a further run with another step.
fn integration_error(
    problem: &Problem,
    level: &RefinedLevel,
    window: &Window,
    metric: Metric,
) -> Result<f64, ChooseError> {
    let candidate = &level.candidate;
    let Some(step) = candidate.method.resolution.step() else {
        return Ok(f64::INFINITY);
    };
    let mut trial = WindowModel::new(problem, &candidate.scene, &candidate.modelling)?;
    let highest = level.outcome.row.highest_hz.unwrap_or(0.0);
    let found = error_of_step((step, highest), |other| {
        let other = trial.run(&candidate.method.method.at_step(other), window)?;
        Ok::<_, ChooseError>(other.error(metric, &level.outcome))
    })?;
    Ok(found.unwrap_or(f64::INFINITY))
}

/// Estimates the integration error of a run from its `distance` to one with another step, for a method of the second
/// order. The other step is twice the step, or half of it where twice the step does not resolve modes up to `highest`
/// [Hz] or has no result.
///
/// # Errors
/// The errors that `distance` returns.
pub fn error_of_step<E>(
    (step, highest): (f64, f64),
    mut distance: impl FnMut(f64) -> Result<f64, E>,
) -> Result<Option<f64>, E> {
    let coarse_carries = SAFE / (4.0 * step) > highest;
    for (factor, of_distance) in [2.0, 0.5].into_iter().zip(OF_STEPS) {
        if factor > 1.0 && !coarse_carries {
            continue;
        }
        let found = distance(factor * step)?;
        if found.is_finite() {
            return Ok(Some(of_distance * found));
        }
    }
    Ok(None)
}

/// Estimates the truncation error of elastic gears from the distances between levels of fewer modes and the next, the
/// last to themselves.
pub fn error_of_modes(distances: &[f64], metric: Metric) -> f64 {
    remaining(distances).max(FLOOR[usize::from(is_scalar(metric))])
}

/// Returns the reason why differences between levels do not fall with more modes; `None` if they fall.
fn not_falling(differences: &[f64], allowed: f64) -> Option<String> {
    if differences.len() < DIFFERENCES || differences.last().is_none_or(|d| *d <= allowed) {
        return None;
    }
    let (first, later) = differences.split_at(differences.len() / 2);
    let [first, later] = [first, later].map(|half| quantile(half, 0.5).unwrap_or(0.0));
    (later > STEADY * first).then(|| {
        format!(
            "the distances between elastic levels do not fall with more modes, {} at first and {} at last in the median",
            per_cent(first),
            per_cent(later)
        )
    })
}

/// Runs a level on the window, or returns the reason why its results are not usable.
fn level(
    problem: &Problem,
    candidate: Candidate,
    window: &Window,
) -> Result<Result<RefinedLevel, String>, ChooseError> {
    let mut trial = WindowModel::new(problem, &candidate.scene, &candidate.modelling)?;
    let outcome = trial.run(&candidate.method, window)?;
    if !outcome.usable() {
        return Ok(Err(
            (outcome.row.message.clone()).unwrap_or_else(|| outcome.row.status.to_string())
        ));
    }
    let setup_s = trial.setup.as_secs_f64();
    Ok(Ok(RefinedLevel {
        candidate,
        outcome,
        setup_s,
        step_up: None,
    }))
}

/// Refines elastic gears on the window, in modes and in the mesh, and estimates the error of the top level.
///
/// # Errors
/// [`ChooseError::Hierarchy`] when no elastic gears reach the end of the window.
pub fn refine(
    problem: &Problem,
    prepared: &CandidateData,
    window: &Window,
    requirement: &Requirement,
    growth: f64,
    progress: &mut impl FnMut(&str),
) -> Result<Refinement, ChooseError> {
    let what = (problem, prepared, window);
    refine_over(what, (requirement, growth), &MODES, progress)
}

/// Refines elastic gears over the given numbers of modes.
///
/// # Errors
/// [`ChooseError`] for the reasons that [`refine`] names.
pub fn refine_over(
    (problem, prepared, window): (&Problem, &CandidateData, &Window),
    (requirement, growth): (&Requirement, f64),
    all_modes: &[usize],
    progress: &mut impl FnMut(&str),
) -> Result<Refinement, ChooseError> {
    let steps = steps_per_contact(requirement.tolerance);
    let lead = &prepared.details.lead;
    let mut levels: Vec<RefinedLevel> = Vec::new();
    let mut failure = String::from("no reason given");
    let mut settled = false;
    // How far histories are apart, for metrics that are single numbers.
    let mut apart: Vec<f64> = Vec::new();
    let mut not_tried: Vec<String> = Vec::new();
    let budget = problem.runner.budget();
    let mut refused: Vec<(Candidate, String)> = Vec::new();
    let mut first_error = None;
    for modes in std::iter::once(0).chain(all_modes.iter().copied()) {
        if budget.is_spent() {
            not_tried.push(Level::elastic(modes, lead.detail).name());
            continue;
        }
        progress(&format!(
            "{} on the window",
            Level::elastic(modes, lead.detail).name()
        ));
        let candidate = prepared.at_steps(problem, lead, modes, steps);
        let next = match level(problem, candidate.clone(), window) {
            Ok(Ok(next)) => next,
            Ok(Err(why)) => {
                refused.push((candidate, why.clone()));
                failure = why;
                continue;
            }
            // A level that would take too much memory, or that cannot be meshed, takes none of the others with it.
            Err(ChooseError::Run(e)) => {
                let Some(why) = cannot_run(&e) else {
                    return Err(e.into());
                };
                refused.push((candidate, why.clone()));
                failure = why;
                first_error.get_or_insert(e);
                continue;
            }
            Err(e) => return Err(e),
        };
        if let Some(below) = levels.last_mut() {
            below.step_up = Some(below.outcome.error(requirement.metric, &next.outcome));
            if is_scalar(requirement.metric) {
                apart.push(below.outcome.error(Metric::ForceL2Aligned, &next.outcome));
            }
        }
        levels.push(next);
        let differences = differences(&levels);
        let last =
            |x: &[f64], limit: f64| x.len() >= 2 && x.iter().rev().take(2).all(|d| *d <= limit);
        let small = SETTLED * requirement.tolerance / growth;
        settled = last(&differences, small)
            && remaining(&differences) <= small
            && (!is_scalar(requirement.metric) || last(&apart, HISTORY * requirement.tolerance));
        if settled {
            break;
        }
    }
    if let Some(e) = first_error.filter(|_| levels.is_empty()) {
        return Err(e.into());
    }
    let differences_of_modes = differences(&levels);
    let modes = remaining(&differences_of_modes);
    let (Some(last), true) = (levels.last_mut(), modes.is_finite()) else {
        return Err(match not_tried.is_empty() {
            true => ChooseError::Hierarchy(failure),
            false => ChooseError::Budget(budget.described()),
        });
    };
    let mut refinement = Refinement {
        finer: Err(String::new()),
        levels: Vec::new(),
        remaining: error_of_modes(&differences_of_modes, requirement.metric),
        of_finer: None,
        integration: 0.0,
        growth,
        settled,
        not_convergent: (!settled)
            .then(|| not_falling(&differences_of_modes, requirement.tolerance / growth))
            .flatten(),
        refused,
        lacks_finer: false,
        not_tried,
        steps,
    };
    refinement.finer = match &prepared.details.finer {
        Ok(finer) if budget.is_spent() => {
            let modes = last.candidate.level.modes().unwrap_or(0);
            let name = Level::elastic(modes, finer.detail).name();
            refinement.not_tried.push(name);
            Err(NOT_TRIED.into())
        }
        Ok(finer) => {
            let modes = last.candidate.level.modes().unwrap_or(0);
            progress(&format!(
                "{} on the window",
                Level::elastic(modes, finer.detail).name()
            ));
            refinement.further((problem, prepared, window), finer, modes)?
        }
        Err(why) => Err(why.clone()),
    };
    if let Ok(finer) = &refinement.finer {
        let distance = last.outcome.error(requirement.metric, &finer.outcome);
        last.step_up = Some(distance);
        let on_half_spaces = prepared.details.on_half_spaces();
        refinement.of_finer = Some(error_of_mesh(distance, on_half_spaces));
    }
    refinement.lacks_finer = prepared.details.finer.is_ok() && refinement.finer.is_err();
    let top = refinement.finer.as_ref().unwrap_or(last);
    progress(&format!(
        "{} under another step",
        top.candidate.level.name()
    ));
    refinement.integration = integration_error(problem, top, window, requirement.metric)?;
    refinement.levels = levels;
    Ok(refinement)
}

fn differences(levels: &[RefinedLevel]) -> Vec<f64> {
    levels.iter().filter_map(|l| l.step_up).collect()
}

/// See the head of the module.
fn remaining(d: &[f64]) -> f64 {
    let [.., before, last] = d else {
        return d.last().copied().unwrap_or(f64::INFINITY);
    };
    let q = (last / before).clamp(RATIO[0], RATIO[1]);
    // A difference that happens to be small does not say that the next one is.
    let last = last.max(RATIO[0] * before);
    if q.is_nan() {
        last
    } else {
        last * q / (1.0 - q)
    }
}

#[cfg(test)]
mod tests {
    use super::{error_of_step, not_falling, remaining};
    use std::convert::Infallible;

    /// Differences that do not fall give no bound on the error; those that fall, or are within the permitted error, do.
    #[test]
    fn differences_that_do_not_fall_are_recognised() {
        assert!(not_falling(&[0.6, 0.5, 0.6, 0.3, 0.5, 0.7], 0.1).is_some());
        assert_eq!(not_falling(&[0.6, 0.5, 0.3, 0.2, 0.15, 0.12], 0.1), None);
        assert_eq!(not_falling(&[0.06, 0.05, 0.06, 0.05, 0.06], 0.1), None);
        assert_eq!(not_falling(&[0.6, 0.5, 0.6], 0.1), None);
    }

    /// The error of a method of the second order is a third of the distance to twice the step, and four thirds of that
    /// to half.
    #[test]
    fn the_error_of_a_step_follows_from_another_one() {
        let exact = |h: f64| 3.0 * h * h;
        let found = |highest: f64, fails: bool| {
            let distance = |other: f64| {
                let fails = fails && other > 1e-3;
                let found = if fails {
                    f64::INFINITY
                } else {
                    (exact(other) - exact(1e-3)).abs()
                };
                Ok::<_, Infallible>(found)
            };
            error_of_step((1e-3, highest), distance).unwrap().unwrap()
        };
        // Twice the step does not carry modes of 400 Hz, or its run fails.
        for (highest, fails) in [(10.0, false), (400.0, false), (10.0, true)] {
            let found = found(highest, fails);
            assert!((found / exact(1e-3) - 1.0).abs() < 1e-9, "{found}");
        }
        let none = error_of_step((1e-3, 10.0), |_| Ok::<_, Infallible>(f64::NAN));
        assert_eq!(none, Ok(None));
    }

    #[test]
    fn a_geometric_series_is_summed() {
        // Differences 1, 1/2, 1/4 leave a remainder of 1/4.
        assert!((remaining(&[1.0, 0.5, 0.25]) - 0.25).abs() < 1e-12);
        // Differences that grow promise nothing: the bound of the ratio speaks.
        assert!((remaining(&[0.1, 0.2]) - 0.2).abs() < 1e-12);
        // One that vanishes by chance counts as a part of the one before.
        assert!(remaining(&[0.1, 0.0]) > 0.01);
        assert_eq!(remaining(&[0.1]), 0.1);
    }
}
