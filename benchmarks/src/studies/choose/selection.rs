//! The selection: of every level that is near enough to the top one each integrator is taken to its longest adequate step, and
//! the cheapest of all is chosen.
//!
//! A candidate is run on the window and held against the top level, so that errors of model and integrator count as
//! they come together. Candidates of an integrator are tried from the longest step on; the first one that keeps the
//! tolerance with a margin counts. On a window that is not the whole scene the next shorter step must keep it as well:
//! one that is right by chance there may not be so later.

use super::detail::Detail;
use super::level::Level;
use super::pilot::Window;
use super::plan::{Candidate, Fixed, Prepared};
use super::problem::Problem;
use super::refinement::{RefinedLevel, Refinement};
use super::requirement::Requirement;
use super::run::{Choice, ChooseError, LevelTried, Parts, Tried};
use super::trial::{Outcome, Trial};
use gearbench_integrators::modal::resonance::SAFE;
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};

/// Part of the tolerance that an estimate may use up.
const MARGIN: f64 = 0.9;
/// Steps per contact time at which rigid gears and movable teeth have no error of integration worth speaking of.
const FINE: f64 = 512.0;
/// A level whose own fine solution is beyond this many tolerances is not tried further.
const HOPE: f64 = 1.0;

/// Most repeats of a timed run.
const REPEATS: usize = 9;

/// A level with its own fine solution.
struct Standing {
    tried: LevelTried,
    fine: Option<Outcome>,
}

/// What all steps of the selection need.
struct Selector<'a, 'p> {
    problem: &'a Problem,
    window: &'a Window,
    requirement: &'a Requirement,
    refinement: &'a Refinement,
    top: &'a Outcome,
    progress: &'p mut dyn FnMut(&str),
    /// Cost of the cheapest adequate candidate so far [s].
    cheapest: f64,
    /// Least cost of elastic gears times their step [s^2].
    per_step: Option<f64>,
    /// Levels and candidates for which no processor time was left.
    not_tried: Vec<String>,
}

impl Selector<'_, '_> {
    /// Estimated error over the whole scene of something at a distance from the top level.
    fn error(&self, distance: f64) -> f64 {
        self.refinement.growth * (distance + self.refinement.remaining)
    }

    /// Whether there is no processor time left for something, which is then listed.
    fn leaves(&mut self, name: impl FnOnce() -> String) -> bool {
        let spent = self.problem.runner.budget().is_spent();
        if spent {
            self.not_tried.push(name());
        }
        spent
    }

    fn adequate(&self, error: f64) -> bool {
        error <= MARGIN * self.requirement.tolerance
    }

    /// Holds a level that is not elastic against the top one.
    fn stand(&mut self, fixed: &Fixed, contact_time: f64) -> Result<Standing, ChooseError> {
        (self.progress)(&format!("{} on the window", fixed.level.name()));
        let method = match fixed.level {
            Level::MovableTeeth(_) => DOPRI5.at_tolerance(1e-5),
            _ => TRIGONOMETRIC.at_step(contact_time / FINE),
        };
        let mut trial = Trial::new(self.problem, &fixed.scene, &fixed.modelling)?;
        let fine = trial.run(&method, self.window)?;
        let distance = fine.error(self.requirement.metric, self.top);
        let error = self.error(distance);
        Ok(Standing {
            tried: LevelTried {
                level: fixed.level.clone(),
                method,
                distance,
                step_up: None,
                error,
                adequate: self.adequate(error),
                cheapest: None,
                setup_s: trial.setup.as_secs_f64(),
                failure: failure(&fine),
            },
            fine: fine.usable().then_some(fine),
        })
    }

    /// Holds elastic gears that were run against the top level.
    fn elastic(&self, refined: &RefinedLevel, prepared: &Prepared) -> Standing {
        let distance = refined.outcome.error(self.requirement.metric, self.top);
        let error = self.error(distance);
        let detail = refined.candidate.level.detail();
        let detail_s = detail.map_or(0.0, |d| prepared.details.setup_s(d));
        Standing {
            tried: LevelTried {
                level: refined.candidate.level.clone(),
                method: refined.candidate.method,
                distance,
                step_up: refined.step_up,
                error,
                adequate: self.adequate(error),
                cheapest: None,
                setup_s: detail_s + refined.setup_s,
                failure: None,
            },
            fine: Some(refined.outcome.clone()),
        }
    }

    /// What the contact of the scene itself is off, with the modes of the top level, where another has taken its place. It
    /// is told, not taken: half-spaces cost no more.
    fn as_given(&mut self, prepared: &Prepared) -> Result<Option<Standing>, ChooseError> {
        let given = &self.problem.flexible;
        let top = self.refinement.levels.last();
        let Some(modes) = top.and_then(|l| l.candidate.level.modes()) else {
            return Ok(None);
        };
        if prepared.details.lead.detail == given.detail
            || self.leaves(|| Level::elastic(modes, given.detail).name())
        {
            return Ok(None);
        }
        (self.progress)(&format!(
            "{} on the window",
            Level::elastic(modes, given.detail).name()
        ));
        let what = (self.problem, prepared, self.window);
        let run = self.refinement.further(what, given, modes)?;
        Ok(run.ok().map(|level| self.elastic(&level, prepared)))
    }

    /// Predicted cost over the whole scene of a candidate that takes `cost` on the window: a method that flies pays for
    /// contact only.
    fn whole_cost(&self, candidate: &Candidate, cost: f64) -> f64 {
        let flies = candidate.method.method.info().linear_part;
        cost * if flies {
            self.window.contact_ratio
        } else {
            self.window.time_ratio
        }
    }

    /// Looks for the cheapest adequate candidate of a level, where there is hope.
    fn look(
        &mut self,
        level: &mut LevelTried,
        fine: Option<&RefinedLevel>,
        all: &[Candidate],
        tried: &mut Vec<Tried>,
    ) -> Result<(), ChooseError> {
        if level.error > HOPE * self.requirement.tolerance {
            return Ok(());
        }
        let own: Vec<Candidate> = (all.iter().filter(|c| c.level == level.level))
            .cloned()
            .collect();
        let fine = fine.map(|l| (&l.candidate, l.outcome.row.highest_hz.unwrap_or(0.0)));
        level.cheapest = self.search(&own, fine, tried)?;
        Ok(())
    }

    /// Tries the candidates of a level, whose own fine run has modes up to `highest` [Hz] and is `fine`; the cheapest
    /// adequate one comes back.
    fn search(
        &mut self,
        candidates: &[Candidate],
        fine: Option<(&Candidate, f64)>,
        tried: &mut Vec<Tried>,
    ) -> Result<Option<(Candidate, f64)>, ChooseError> {
        let mut best: Option<(Candidate, f64)> = None;
        let same = |a: &Candidate, b: &Candidate| {
            let by_step = |c: &Candidate| c.method.resolution.step().is_some();
            a.method.method == b.method.method && by_step(a) == by_step(b)
        };
        let mut kept = match fine {
            Some((c, _)) => Some(Trial::new(self.problem, &c.scene, &c.modelling)?),
            None => None,
        };
        for row in candidates.chunk_by(same) {
            let mut pending: Option<(&Candidate, f64)> = None;
            for (i, candidate) in row.iter().enumerate() {
                if self.too_dear(candidate) || self.leaves(|| candidate.name()) {
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
                        own = Trial::new(self.problem, &candidate.scene, &candidate.modelling)?;
                        &mut own
                    }
                };
                let outcome = trial.run(&candidate.method, self.window)?;
                let error = self.error(outcome.error(self.requirement.metric, self.top));
                let adequate = self.adequate(error);
                let mut cost = f64::NAN;
                if outcome.usable() {
                    // The cost of what does not do is for the picture only.
                    let repeats = if adequate { REPEATS } else { 1 };
                    let end = self.window.end;
                    let on_window = trial.cost(&candidate.method, end, repeats)?;
                    cost = self.whole_cost(candidate, on_window);
                    self.learn(candidate, cost);
                }
                tried.push(Tried {
                    candidate: candidate.clone(),
                    error,
                    cost_s: cost,
                    adequate,
                    work: [outcome.row.steps, outcome.row.force_evaluations],
                    failure: failure(&outcome),
                });
                if !adequate {
                    pending = None;
                    continue;
                }
                // What was run over the whole scene needs nothing to confirm it.
                let last = self.window.whole || i + 1 == row.len();
                if let Some((c, cost)) = pending.or(last.then_some((candidate, cost))) {
                    if best.as_ref().is_none_or(|(_, b)| cost < *b) {
                        best = Some((c.clone(), cost));
                    }
                    self.cheapest = self.cheapest.min(cost);
                    break;
                }
                pending = Some((candidate, cost));
            }
        }
        Ok(best)
    }

    /// Keeps what a step of elastic gears costs.
    fn learn(&mut self, candidate: &Candidate, cost: f64) {
        if let (Some(_), Some(h)) = (candidate.level.modes(), candidate.method.resolution.step()) {
            let per_step = cost * h;
            self.per_step = Some(self.per_step.map_or(per_step, |p: f64| p.min(per_step)));
        }
    }

    /// Elastic gears whose steps alone cost more than the cheapest that is known to do: the confirming next shorter step
    /// of something cheaper may still run.
    fn too_dear(&self, candidate: &Candidate) -> bool {
        let step =
            (candidate.method.resolution.step()).filter(|_| candidate.level.modes().is_some());
        step.is_some_and(|h| self.per_step.is_some_and(|p| p / (2.0 * h) > self.cheapest))
    }
}

/// The cheapest that keeps the tolerance without a margin, for when nothing keeps it with one: its standing, itself,
/// its cost.
fn within(
    standings: &[Standing],
    tried: &[Tried],
    tolerance: f64,
) -> Option<(usize, Candidate, f64)> {
    let keeps = |t: &&Tried| t.error <= tolerance && t.cost_s.is_finite();
    let least = (tried.iter().filter(keeps)).min_by(|a, b| a.cost_s.total_cmp(&b.cost_s))?;
    let level = |s: &Standing| s.tried.level == least.candidate.level;
    let i = standings.iter().position(level)?;
    Some((i, least.candidate.clone(), least.cost_s))
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
    prepared: &Prepared,
    window: &Window,
    requirement: &Requirement,
    refinement: Refinement,
    progress: &mut dyn FnMut(&str),
) -> Result<Choice, ChooseError> {
    let Some(top) = refinement.top() else {
        return Err(ChooseError::Hierarchy("no level ran".into()));
    };
    let mut selector = Selector {
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
        if selector.leaves(|| fixed.level.name()) {
            continue;
        }
        let mut standing = selector.stand(fixed, prepared.oscillator.contact_time())?;
        selector.look(&mut standing.tried, None, &all, &mut tried)?;
        standings.push(standing);
    }
    let finer = refinement.finer.as_ref().ok();
    for refined in refinement.levels.iter().chain(finer) {
        let mut standing = selector.elastic(refined, prepared);
        selector.look(&mut standing.tried, Some(refined), &all, &mut tried)?;
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
            if selector.leaves(|| Level::elastic(modes, of.detail).name()) {
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
            selector.look(&mut standing.tried, Some(&further), &all, &mut tried)?;
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
    let best = (standings.iter().enumerate())
        .filter_map(|(i, s)| s.tried.cheapest.clone().map(|(c, cost)| (i, c, cost)))
        .min_by(|a, b| a.2.total_cmp(&b.2))
        .or_else(|| within(&standings, &tried, requirement.tolerance));
    if let Some((i, candidate, cost)) = &best {
        let level = &mut standings[*i].tried;
        level
            .cheapest
            .get_or_insert_with(|| (candidate.clone(), *cost));
    }
    let mut choice = Choice {
        candidate: None,
        predicted_error: standings
            .iter()
            .map(|s| s.tried.error)
            .fold(f64::INFINITY, f64::min),
        parts: Parts {
            top: refinement.remaining,
            mesh: refinement.of_finer.map(|e| refinement.growth * e),
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
        choice.parts.model = standing.tried.distance;
        if let Some(fine) = &standing.fine {
            let (scene, modelling) = (candidate.scene.clone(), candidate.modelling.clone());
            let outcome =
                Trial::new(problem, &scene, &modelling)?.run(&candidate.method, window)?;
            choice.parts.integration = outcome.error(requirement.metric, fine);
        }
        choice.candidate = Some(candidate);
    }
    choice.levels = standings.into_iter().map(|s| s.tried).collect();
    choice.reason = super::reason::reason(&choice, requirement, &refinement);
    Ok(choice)
}
