//! Selection of the cheapest candidate: each integrator on each adequate level at its longest adequate step.
//!
//! A candidate is run on the window and compared with the top level, the yardstick, so that errors of model and integrator
//! count as they come together. It is adequate where its error and the yardstick's own error together keep the tolerance
//! ([`Adequacy`]). Candidates of an integrator are tried from the longest step on; the first adequate one counts. On a window
//! that is not the whole scene the next shorter step must be adequate as well: one that is right by chance there may not be
//! so later.
//!
//! The cost of a candidate is the processor time of one set-up and of all runs that the user plans. Of those whose costs
//! differ by no more than a tenth the simplest model is chosen.

use super::detail::Detail;
use super::level::Level;
use super::pilot::{self, Sensitivity, Window};
use super::plan::{Candidate, CandidateData, InelasticLevel};
use super::problem::Problem;
use super::refinement::{RefinedLevel, Refinement};
use super::requirement::{Requirement, is_scalar};
use super::run::{CandidateResult, Choice, ChooseError, LevelResult, Parts};
use super::trial::{Outcome, WindowModel, cannot_run};
use gearbench_integrators::modal::resonance::SAFE;
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_reports::record::Status;
use gearbench_reports::{Adequacy, ForceStatistics, Verdict};

/// Ratio of costs up to which two candidates cost the same.
pub(super) const SAME_COST: f64 = 1.1;
/// Steps per contact time at which rigid gears and movable teeth have no error of integration worth speaking of.
const FINE: f64 = 512.0;
/// Most repeats of a timed run.
const REPEATS: usize = 9;

/// A level with its own fine solution.
struct LevelSolution {
    tried: LevelResult,
    fine: Option<Outcome>,
}

/// Data that all steps of the selection share.
struct Selector<'a, 'p> {
    problem: &'a Problem,
    window: &'a Window,
    requirement: &'a Requirement,
    refinement: &'a Refinement,
    top: &'a Outcome,
    /// Estimated error of the top level itself over the whole scene; infinite where it is not known.
    own_error: f64,
    progress: &'p mut dyn FnMut(&str),
    /// Cost of the cheapest adequate candidate so far, set-up and all runs [s].
    cheapest: f64,
    /// The history does not repeat, and its statistics are described.
    describes_statistics: bool,
    /// Least cost of elastic gears times their step [s^2].
    per_step: Option<f64>,
    /// Levels and candidates for which no processor time was left.
    not_tried: Vec<String>,
}

impl Selector<'_, '_> {
    /// Estimated error against the top level over the whole scene of something at a distance from it on the window.
    fn error(&self, distance: f64) -> f64 {
        self.refinement.growth * distance
    }

    /// True if the processor time is used up; the item is then listed as not tried.
    fn budget_is_spent(&mut self, name: impl FnOnce() -> String) -> bool {
        let spent = self.problem.runner.budget().is_spent();
        if spent {
            self.not_tried.push(name());
        }
        spent
    }

    fn adequate(&self, error: f64) -> Adequacy {
        let tolerance = self.requirement.tolerance;
        Adequacy::of_grown((error, self.own_error), self.refinement.growth, tolerance)
    }

    /// Processor time of all runs that are planned, with one set-up [s].
    fn total(&self, setup: f64, cost: f64) -> f64 {
        setup + self.problem.runs as f64 * cost
    }

    /// A level without a usable run, for a reason.
    fn refused(&self, of: &Candidate, why: &str) -> LevelSolution {
        LevelSolution {
            tried: LevelResult {
                level: of.level.clone(),
                method: of.method,
                distance: f64::INFINITY,
                step_up: None,
                error: f64::INFINITY,
                adequate: self.adequate(f64::INFINITY),
                statistics: None,
                cheapest: None,
                setup_s: f64::NAN,
                failure: Some(format!("{}: {why}", Status::Refused)),
            },
            fine: None,
        }
    }

    /// Statistics of a run whose history does not repeat.
    fn statistics(&self, run: &Outcome) -> Option<ForceStatistics> {
        (self.describes_statistics && run.usable()).then(|| pilot::statistics(run))
    }

    /// Compares a level that is not elastic with the top one.
    fn evaluate_level(
        &mut self,
        fixed: &InelasticLevel,
        contact_time: f64,
    ) -> Result<LevelSolution, ChooseError> {
        (self.progress)(&format!("{} on the window", fixed.level.name()));
        let method = match fixed.level {
            Level::MovableTeeth(_) => DOPRI5.at_tolerance(1e-5),
            _ => TRIGONOMETRIC.at_step(contact_time / FINE),
        };
        let ran = WindowModel::new(self.problem, &fixed.scene, &fixed.modelling)
            .and_then(|mut trial| Ok((trial.run(&method, self.window)?, trial.setup)));
        let (fine, setup) = match ran {
            Ok(ran) => ran,
            Err(e) => {
                let why = cannot_run(&e).ok_or(e)?;
                let candidate = Candidate {
                    level: fixed.level.clone(),
                    scene: fixed.scene.clone(),
                    modelling: fixed.modelling.clone(),
                    method,
                };
                return Ok(self.refused(&candidate, &why));
            }
        };
        let distance = fine.error(self.requirement.metric, self.top);
        let error = self.error(distance);
        Ok(LevelSolution {
            tried: LevelResult {
                level: fixed.level.clone(),
                method,
                distance,
                step_up: None,
                error,
                adequate: self.adequate(error),
                statistics: self.statistics(&fine),
                cheapest: None,
                setup_s: setup.as_secs_f64(),
                failure: failure(&fine),
            },
            fine: fine.usable().then_some(fine),
        })
    }

    /// Compares elastic gears that were run with the top level.
    fn elastic(&self, refined: &RefinedLevel, prepared: &CandidateData) -> LevelSolution {
        let distance = refined.outcome.error(self.requirement.metric, self.top);
        let error = self.error(distance);
        let detail = refined.candidate.level.detail();
        let detail_s = detail.map_or(0.0, |d| prepared.details.setup_s(d));
        LevelSolution {
            tried: LevelResult {
                level: refined.candidate.level.clone(),
                method: refined.candidate.method,
                distance,
                step_up: refined.step_up,
                error,
                adequate: self.adequate(error),
                statistics: self.statistics(&refined.outcome),
                cheapest: None,
                setup_s: detail_s + refined.setup_s,
                failure: None,
            },
            fine: Some(refined.outcome.clone()),
        }
    }

    /// Estimates the error of the contact of the scene itself, with the modes of the top level, where half-spaces have
    /// replaced it. The result is reported, not a candidate: half-spaces cost no more.
    fn as_given(&mut self, prepared: &CandidateData) -> Result<Option<LevelSolution>, ChooseError> {
        let given = &self.problem.flexible;
        let top = self.refinement.levels.last();
        let Some(modes) = top.and_then(|l| l.candidate.level.modes()) else {
            return Ok(None);
        };
        if prepared.details.lead.detail == given.detail
            || self.budget_is_spent(|| Level::elastic(modes, given.detail).name())
        {
            return Ok(None);
        }
        (self.progress)(&format!(
            "{} on the window",
            Level::elastic(modes, given.detail).name()
        ));
        let what = (self.problem, prepared, self.window);
        Ok(Some(match self.refinement.further(what, given, modes)? {
            Ok(level) => self.elastic(&level, prepared),
            Err(why) => {
                let candidate = prepared.at_steps(self.problem, given, modes, FINE);
                self.refused(&candidate, &why)
            }
        }))
    }

    /// Predicts the cost over the whole scene from `cost` on the window; a method that is exact for the linear part
    /// pays for contact only.
    fn whole_cost(&self, candidate: &Candidate, cost: f64) -> f64 {
        let flies = candidate.method.method.info().linear_part;
        cost * if flies {
            self.window.contact_ratio
        } else {
            self.window.time_ratio
        }
    }

    /// Searches the cheapest adequate candidate of an adequate level.
    fn search_cheapest(
        &mut self,
        level: &mut LevelResult,
        fine: Option<&RefinedLevel>,
        all: &[Candidate],
        tried: &mut Vec<CandidateResult>,
    ) -> Result<(), ChooseError> {
        if level.adequate != Adequacy::Adequate {
            return Ok(());
        }
        let own: Vec<Candidate> = (all.iter().filter(|c| c.level == level.level))
            .cloned()
            .collect();
        let fine = fine.map(|l| (&l.candidate, l.outcome.row.highest_hz.unwrap_or(0.0)));
        level.cheapest = self.search((&own, level.setup_s), fine, tried)?;
        Ok(())
    }

    /// Tries the candidates of a level with its set-up [s], whose own fine run has modes up to `highest` [Hz] and is `fine`;
    /// the cheapest adequate one comes back.
    fn search(
        &mut self,
        (candidates, setup): (&[Candidate], f64),
        fine: Option<(&Candidate, f64)>,
        tried: &mut Vec<CandidateResult>,
    ) -> Result<Option<(Candidate, f64)>, ChooseError> {
        let mut best: Option<(Candidate, f64)> = None;
        let same = |a: &Candidate, b: &Candidate| {
            let by_step = |c: &Candidate| c.method.resolution.step().is_some();
            a.method.method == b.method.method && by_step(a) == by_step(b)
        };
        let mut kept = match fine {
            Some((c, _)) => Some(WindowModel::new(self.problem, &c.scene, &c.modelling)?),
            None => None,
        };
        for row in candidates.chunk_by(same) {
            let mut pending: Option<(&Candidate, f64)> = None;
            for (i, candidate) in row.iter().enumerate() {
                if self.exceeds_cheapest(candidate, setup)
                    || self.budget_is_spent(|| candidate.name())
                {
                    break;
                }
                (self.progress)(&candidate.name());
                // A step that carries all modes of the fine run leaves the model as it is.
                let step = candidate.method.resolution.step();
                let carries = |hz: f64| step.is_some_and(|h| SAFE / (2.0 * h) > hz);
                let reused = fine.is_some_and(|(_, hz)| carries(hz));
                let mut own;
                let trial = match kept.as_mut().filter(|_| reused) {
                    Some(trial) => trial,
                    None => {
                        own = match WindowModel::new(
                            self.problem,
                            &candidate.scene,
                            &candidate.modelling,
                        ) {
                            Ok(own) => own,
                            Err(e) => {
                                tried.push(self.not_run(candidate, cannot_run(&e).ok_or(e)?));
                                break;
                            }
                        };
                        &mut own
                    }
                };
                let outcome = match trial.run(&candidate.method, self.window) {
                    Ok(outcome) => outcome,
                    Err(e) => {
                        tried.push(self.not_run(candidate, cannot_run(&e).ok_or(e)?));
                        break;
                    }
                };
                let error = self.error(outcome.error(self.requirement.metric, self.top));
                let adequate = self.adequate(error);
                let mut cost = f64::NAN;
                if outcome.usable() {
                    // The cost of inadequate candidates is used in the chart only.
                    let repeats = match adequate {
                        Adequacy::Adequate => REPEATS,
                        _ => 1,
                    };
                    let end = self.window.end;
                    let on_window = trial.cost(&candidate.method, end, repeats)?;
                    cost = self.whole_cost(candidate, on_window);
                    self.record_step_cost(candidate, cost);
                }
                tried.push(CandidateResult {
                    candidate: candidate.clone(),
                    error,
                    cost_s: cost,
                    adequate,
                    work: [outcome.row.steps, outcome.row.force_evaluations],
                    failure: failure(&outcome),
                });
                if adequate != Adequacy::Adequate {
                    pending = None;
                    continue;
                }
                // A candidate that was run over the whole scene needs no confirmation.
                let last = self.window.whole || i + 1 == row.len();
                if let Some((c, cost)) = pending.or(last.then_some((candidate, cost))) {
                    if best.as_ref().is_none_or(|(_, b)| cost < *b) {
                        best = Some((c.clone(), cost));
                    }
                    self.cheapest = self.cheapest.min(self.total(setup, cost));
                    break;
                }
                pending = Some((candidate, cost));
            }
        }
        Ok(best)
    }

    /// A candidate that cannot run.
    fn not_run(&self, candidate: &Candidate, why: String) -> CandidateResult {
        CandidateResult {
            candidate: candidate.clone(),
            error: f64::INFINITY,
            cost_s: f64::NAN,
            adequate: self.adequate(f64::INFINITY),
            work: [0, 0],
            failure: Some(format!("{}: {why}", Status::Refused)),
        }
    }

    /// Records the cost of a step of elastic gears.
    fn record_step_cost(&mut self, candidate: &Candidate, cost: f64) {
        if let (Some(_), Some(h)) = (candidate.level.modes(), candidate.method.resolution.step()) {
            let per_step = cost * h;
            self.per_step = Some(self.per_step.map_or(per_step, |p: f64| p.min(per_step)));
        }
    }

    /// Elastic gears whose set-up and steps alone cost more than the cheapest that is known to be adequate: the confirming
    /// next shorter step of something cheaper may still run.
    fn exceeds_cheapest(&self, candidate: &Candidate, setup: f64) -> bool {
        let Some(h) =
            (candidate.method.resolution.step()).filter(|_| candidate.level.modes().is_some())
        else {
            return false;
        };
        let run = self.per_step.map_or(0.0, |p| p / (2.0 * h));
        self.total(setup, run) > self.cheapest
    }
}

/// The place of the cheapest of some costs, simplest model first: of those that cost the same the simplest.
fn simplest_of_cheapest(costs: &[Option<f64>]) -> Option<usize> {
    let least = (costs.iter().flatten()).fold(f64::INFINITY, |a, b| a.min(*b));
    let same = |cost: &Option<f64>| cost.is_some_and(|c| c <= SAME_COST * least);
    costs.iter().position(same)
}

/// Returns the verdict from all that was tried: levels, each with its candidates. No model is adequate if no level is,
/// and if the candidates that were tried of an adequate level are not.
fn verdict(chosen: bool, levels: impl IntoIterator<Item = (Adequacy, Vec<Adequacy>)>) -> Verdict {
    let not = |a: &Adequacy| *a == Adequacy::NotAdequate;
    let none = |(level, candidates): (Adequacy, Vec<Adequacy>)| {
        not(&level) || !candidates.is_empty() && candidates.iter().all(not)
    };
    match (chosen, levels.into_iter().all(none)) {
        (true, _) => Verdict::Adequate,
        (false, true) => Verdict::NoneAdequate,
        (false, false) => Verdict::NotDecided,
    }
}

fn failure(outcome: &Outcome) -> Option<String> {
    (!outcome.usable()).then(|| {
        let message = outcome.row.message.clone().unwrap_or_default();
        format!("{}: {message}", outcome.row.status)
    })
}

/// Selects; window and domain are the caller's.
///
/// # Errors
/// [`ChooseError`] when something that was to run could not start.
pub fn select(
    problem: &Problem,
    prepared: &CandidateData,
    window: &Window,
    requirement: &Requirement,
    (refinement, sensitivity): (Refinement, &Sensitivity),
    progress: &mut dyn FnMut(&str),
) -> Result<Choice, ChooseError> {
    let Some(top) = refinement.top() else {
        return Err(ChooseError::Hierarchy("no level ran".into()));
    };
    // A single number of a history that does not repeat has a meaning to its scatter; the history itself has none.
    let why = (sensitivity.not_repeatable.as_ref()).or(refinement.not_convergent.as_ref());
    let judged = sensitivity.not_repeatable.is_none() || is_scalar(requirement.metric);
    let own_error = (refinement.own_error())
        .map(|e| e + sensitivity.scatter)
        .filter(|e| judged && e.is_finite());
    let mut selector = Selector {
        own_error: own_error.unwrap_or(f64::INFINITY),
        describes_statistics: why.is_some(),
        problem,
        window,
        requirement,
        refinement: &refinement,
        top: &top.outcome,
        progress,
        cheapest: f64::INFINITY,
        per_step: None,
        not_tried: refinement.not_tried.clone(),
    };
    let all = prepared.candidates(problem);
    let (mut standings, mut tried) = (Vec::new(), Vec::new());
    for fixed in &prepared.fixed {
        // Movable teeth never cost less than rigid ones.
        if matches!(fixed.level, Level::MovableTeeth(_)) && selector.cheapest.is_finite() {
            continue;
        }
        if selector.budget_is_spent(|| fixed.level.name()) {
            continue;
        }
        let mut standing = selector.evaluate_level(fixed, prepared.oscillator.contact_time())?;
        selector.search_cheapest(&mut standing.tried, None, &all, &mut tried)?;
        standings.push(standing);
    }
    for (candidate, why) in &refinement.refused {
        standings.push(selector.refused(candidate, why));
    }
    let finer = refinement.finer.as_ref().ok();
    for refined in refinement.levels.iter().chain(finer) {
        let mut standing = selector.elastic(refined, prepared);
        selector.search_cheapest(&mut standing.tried, Some(refined), &all, &mut tried)?;
        standings.push(standing);
    }
    // Where nothing on the mesh of the scene will do, fewer modes on the finer one may.
    let found = standings.iter().any(|s| s.tried.cheapest.is_some());
    let on_scene = (standings.iter())
        .any(|s| s.tried.cheapest.is_some() && s.tried.level.detail() != Some(Detail::Finer));
    if found
        && !on_scene
        && let Ok(of) = &prepared.details.finer
    {
        for modes in refinement.levels.split_last().map_or(&[][..], |x| x.1) {
            let modes = modes.candidate.level.modes().unwrap_or(0);
            if selector.budget_is_spent(|| Level::elastic(modes, of.detail).name()) {
                continue;
            }
            (selector.progress)(&format!(
                "{} on the window",
                Level::elastic(modes, of.detail).name()
            ));
            let Ok(further) = refinement.further((problem, prepared, window), of, modes)? else {
                continue;
            };
            let mut standing = selector.elastic(&further, prepared);
            selector.search_cheapest(&mut standing.tried, Some(&further), &all, &mut tried)?;
            standings.push(standing);
        }
    }
    if let Some(standing) = selector.as_given(prepared)? {
        standings.push(standing);
    }
    // By mesh and contact, of each by modes.
    standings.sort_by_key(|s| {
        (
            s.tried.level.detail().map(Detail::rank),
            s.tried.level.modes(),
        )
    });
    let total = |s: &LevelSolution| {
        let (_, cost) = s.tried.cheapest.as_ref()?;
        Some(selector.total(s.tried.setup_s, *cost))
    };
    let totals: Vec<Option<f64>> = standings.iter().map(total).collect();
    let best = simplest_of_cheapest(&totals).and_then(|i| {
        let (candidate, cost) = standings[i].tried.cheapest.clone()?;
        Some((i, candidate, cost))
    });
    let mut choice = Choice {
        candidate: None,
        predicted_error: standings
            .iter()
            .map(|s| s.tried.error)
            .fold(f64::INFINITY, f64::min),
        verdict: Verdict::NotDecided,
        yardstick: top.candidate.clone(),
        own_error,
        scatter: sensitivity.scatter,
        not_repeatable: why.cloned(),
        references: Vec::new(),
        runs: problem.runs,
        total_cost_s: f64::NAN,
        parts: Parts {
            top: refinement.remaining,
            top_integration: refinement.integration,
            mesh: refinement.of_finer,
            growth: refinement.growth,
            ..Parts::default()
        },
        predicted_cost_s: f64::NAN,
        setup_s: f64::NAN,
        reason: Vec::new(),
        levels: Vec::new(),
        tried,
        window: window.clone(),
        outside: Vec::new(),
        details: prepared.details.clone(),
        not_tried: selector.not_tried,
    };
    if let Some((i, candidate, cost)) = best {
        let standing = &standings[i];
        let found = (choice.tried.iter()).find(|t| {
            t.candidate.level == candidate.level && t.candidate.method == candidate.method
        });
        choice.predicted_error = found.map_or(f64::NAN, |t| t.error);
        choice.predicted_cost_s = cost;
        choice.setup_s = standing.tried.setup_s;
        choice.total_cost_s = totals[i].unwrap_or(f64::NAN);
        choice.parts.model = standing.tried.distance;
        if let Some(fine) = &standing.fine {
            let (scene, modelling) = (candidate.scene.clone(), candidate.modelling.clone());
            let outcome =
                WindowModel::new(problem, &scene, &modelling)?.run(&candidate.method, window)?;
            choice.parts.integration = outcome.error(requirement.metric, fine);
        }
        choice.candidate = Some(candidate);
    }
    choice.levels = standings.into_iter().map(|s| s.tried).collect();
    let of = |level: &LevelResult| {
        let own = (choice.tried.iter()).filter(|t| t.candidate.level == level.level);
        (level.adequate, own.map(|t| t.adequate).collect())
    };
    choice.verdict = verdict(choice.candidate.is_some(), choice.levels.iter().map(of));
    choice.reason = super::reasons::reason(&choice, requirement, &refinement);
    Ok(choice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Adequacy::{Adequate, NotAdequate, NotDecided};

    /// Costs from the simplest model to the most detailed one.
    #[test]
    fn of_two_that_cost_the_same_the_simpler_is_chosen() {
        let chosen = |costs: &[Option<f64>]| simplest_of_cheapest(costs);
        // 12.3 us against 12.2 us are the same.
        assert_eq!(chosen(&[Some(12.3e-6), Some(12.2e-6)]), Some(0));
        assert_eq!(chosen(&[Some(2.0), None, Some(1.05), Some(1.0)]), Some(2));
        assert_eq!(chosen(&[Some(1.2), Some(1.0)]), Some(1));
        assert_eq!(chosen(&[None, None]), None);
        assert_eq!(chosen(&[]), None);
    }

    /// The verdict that no model is adequate requires a decision on every level and candidate.
    #[test]
    fn the_answer_follows_from_levels_and_candidates() {
        let of = |levels: &[(Adequacy, &[Adequacy])]| {
            let owned = levels.iter().map(|(l, c)| (*l, c.to_vec()));
            verdict(false, owned)
        };
        assert_eq!(
            of(&[(NotAdequate, &[]), (NotDecided, &[])]),
            Verdict::NotDecided
        );
        assert_eq!(
            of(&[(NotAdequate, &[]), (Adequate, &[NotAdequate, NotAdequate])]),
            Verdict::NoneAdequate
        );
        assert_eq!(
            of(&[(Adequate, &[NotAdequate, NotDecided])]),
            Verdict::NotDecided
        );
        // A level that was not tried leaves the choice undecided.
        assert_eq!(of(&[(Adequate, &[])]), Verdict::NotDecided);
        assert_eq!(verdict(true, [(NotDecided, Vec::new())]), Verdict::Adequate);
    }
}
