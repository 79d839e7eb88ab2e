//! The refinement: elastic gears with more and more modes on the window, until more of them change little.
//!
//! With `d_i` the distance of level `i` to level `i + 1` in the metric, the refinement ends where the last two are both below a
//! part of the tolerance, as errors grow over the scene; for a metric that is a single number the force histories must
//! agree as well, since two numbers may meet by chance. What the top level is still off is estimated as that of a
//! geometric series, `d q / (1 - q)` with `q` the ratio of the last two; that is to be as small.

use super::pilot::Window;
use super::plan::{Candidate, MODES, Prepared};
use super::problem::Problem;
use super::requirement::{Requirement, is_scalar};
use super::run::ChooseError;
use super::trial::{Outcome, Trial};
use gearbench_reports::Metric;

/// Steps per contact time of the refinement, for tolerances up to a limit: their own error is not to show beside it.
const STEPS: [(f64, f64); 3] = [(0.015, 512.0), (0.04, 256.0), (f64::INFINITY, 128.0)];
/// Part of the tolerance that the last two differences stay below.
const SETTLED: f64 = 0.25;
/// The same for histories, in tolerances, where the metric is a single number.
const HISTORY: f64 = 2.0;
/// What reduced gears are off from full ones of the same mesh however many modes they have, histories and single
/// numbers: no estimate goes below.
const FLOOR: [f64; 2] = [3e-3, 1e-3];
/// Bounds of the ratio of differences.
const RATIO: [f64; 2] = [0.3, 0.5];

/// A level of elastic gears on the window.
#[derive(Clone, Debug)]
pub struct RefinedLevel {
    /// How it was run.
    pub candidate: Candidate,
    pub outcome: Outcome,
    /// Set-up [s].
    pub setup_s: f64,
    /// Distance to the next level.
    pub step_up: Option<f64>,
}

/// The hierarchy as far as it was refined.
#[derive(Clone, Debug)]
pub struct Refinement {
    /// Levels that ran to the end, ascending.
    pub levels: Vec<RefinedLevel>,
    /// What the top one is estimated to be off on the window.
    pub remaining: f64,
    /// Factor by which errors grow from the window to the scene.
    pub growth: f64,
    /// The differences became small.
    pub settled: bool,
}

impl Refinement {
    /// The top level.
    pub fn top(&self) -> Option<&RefinedLevel> {
        self.levels.last()
    }
}

/// Refines.
///
/// # Errors
/// [`ChooseError::Hierarchy`] when no elastic gears reach the end of the window.
pub fn refine(
    problem: &Problem,
    prepared: &Prepared,
    window: &Window,
    requirement: &Requirement,
    growth: f64,
    progress: &mut impl FnMut(&str),
) -> Result<Refinement, ChooseError> {
    let steps = (STEPS
        .iter()
        .find(|(limit, _)| requirement.tolerance < *limit))
    .map_or(128.0, |s| s.1);
    let mut levels: Vec<RefinedLevel> = Vec::new();
    let mut failure = String::from("no reason given");
    let mut settled = false;
    // How far histories are apart, for metrics that are single numbers.
    let mut apart: Vec<f64> = Vec::new();
    for modes in std::iter::once(0).chain(MODES) {
        let candidate = prepared.at_steps(problem, modes, steps);
        progress(&format!("{} on the window", candidate.level.name()));
        let (scene, modelling) = (candidate.scene.clone(), candidate.modelling.clone());
        let mut trial = Trial::new(problem, &scene, &modelling)?;
        let outcome = trial.run(&candidate.method, window)?;
        if !outcome.usable() {
            failure = outcome.row.message.clone().unwrap_or(failure);
            continue;
        }
        let setup_s = trial.setup.as_secs_f64();
        if let Some(below) = levels.last_mut() {
            below.step_up = Some(below.outcome.error(requirement.metric, &outcome));
            if is_scalar(requirement.metric) {
                apart.push(below.outcome.error(Metric::ForceL2Aligned, &outcome));
            }
        }
        levels.push(RefinedLevel {
            candidate,
            outcome,
            setup_s,
            step_up: None,
        });
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
    if levels.len() < 2 {
        return Err(ChooseError::Hierarchy(failure));
    }
    let floor = FLOOR[usize::from(is_scalar(requirement.metric))];
    let remaining = remaining(&differences(&levels)).max(floor);
    Ok(Refinement {
        levels,
        remaining,
        growth,
        settled,
    })
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
    use super::remaining;

    #[test]
    fn a_geometric_series_is_summed() {
        // Differences 1, 1/2, 1/4: what is left after them is 1/4.
        assert!((remaining(&[1.0, 0.5, 0.25]) - 0.25).abs() < 1e-12);
        // Differences that grow promise nothing: the bound of the ratio speaks.
        assert!((remaining(&[0.1, 0.2]) - 0.2).abs() < 1e-12);
        // One that vanishes by chance counts as a part of the one before.
        assert!(remaining(&[0.1, 0.0]) > 0.01);
        assert_eq!(remaining(&[0.1]), 0.1);
    }
}
