//! Validation of model choices on random scenes: every candidate is compared with a refined model over the whole scene.
//!
//! For each scene the reference and then every candidate is run, for cost and error. The cheapest candidate within the
//! tolerance is the best possible choice. Candidates that cannot be the cheapest are not run to the end: those that
//! cost more than the cheapest adequate one so far need no error, and if a candidate costs three times that, the same
//! integrator with shorter steps, or with more modes, is not run at all. At the end the choice and the cheapest
//! candidate are timed alternately.

mod full_order;
mod measure;
mod reference;
#[cfg(test)]
mod tests;

use crate::choices::{Outcome, ValidatedCandidate, ValidatedChoice};
use crate::sampling::{Sample, SampleError};
pub use full_order::against_full;
use gearbench::experiment::journal::JournalError;
use gearbench::experiment::machine::cpu_time;
use gearbench::experiment::run::RunError;
use gearbench::studies::choose::detail::{Detail, Details};
use gearbench::studies::choose::level::Level;
use gearbench::studies::choose::plan::{Candidate, CandidateData, DENSEST};
use gearbench::studies::choose::problem::Problem;
use gearbench::studies::choose::requirement::Requirement;
use gearbench::studies::choose::run::{ChooseError, choose};
use gearbench::studies::choose::trial::{Outcome as Seen, WindowModel};
use gearbench_integrators::Resolution;
use gearbench_models::spec::Body;
use gearbench_reports::Verdict;
use gearbench_reports::record::Status;
use measure::{error, side_by_side, time};
pub use measure::{grid, outcome};
use std::time::{Duration, Instant};

/// Cost, relative to the cheapest adequate candidate, above which a more expensive variant of a candidate is not run.
const DEARER: f64 = 3.0;
/// Cost, relative to the cheapest adequate candidate, up to which errors are evaluated: the first measured times are
/// rough.
const NEAR: f64 = 1.3;
/// Error of the scene's mesh, as share of the tolerance, up to which candidates on the finer mesh are left out.
const OF_MESH: f64 = 0.25;
/// Upper bound on the time of any timed run.
const LONGEST: Duration = Duration::from_secs(20);
/// Time bound relative to the cheapest adequate candidate, and clock error of a busy machine [s]; see [`LONGEST`].
const TIMES_CHEAPEST: (f64, f64) = (5.0, 0.05);

/// Reason why a scene could not be validated, or a set not be completed.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// A run could not start, or was stopped by the user.
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Choose(#[from] ChooseError),
    /// The reference did not reach the end.
    #[error("the reference under {method} did not complete the run: {why}")]
    Reference { method: String, why: String },
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The requested subject does not exist, or a fit failed.
    #[error("{0}")]
    Other(String),
}

/// Validates the choice for a sampled scene.
///
/// # Errors
/// An interruption: that is no finding.
pub fn validate(sample: &Sample) -> Result<ValidatedChoice, ValidationError> {
    let mut row = ValidatedChoice {
        scene: sample.scene.name.clone(),
        number: sample.number,
        kind: sample.kind.as_str().into(),
        gears: gears(sample),
        duration_s: sample.scene.duration,
        metric: sample.metric,
        tolerance: sample.tolerance,
        reference: reference::NAME.into(),
        rejected: sample.rejected,
        ..ValidatedChoice::default()
    };
    if let Err(e) = validate_into(&mut row, sample) {
        if sample.scene.context.interruption.is_requested() {
            return Err(e);
        }
        row.outcome = Outcome::NotValidated;
        row.note = Some(e.to_string());
    }
    Ok(row)
}

fn gears(sample: &Sample) -> String {
    let teeth: Vec<String> = (sample.scene.spec.gears.iter())
        .map(|g| match &g.body {
            Body::Gear(g) => g.teeth().to_string(),
            Body::Rack(r) => format!("rack of {}", r.teeth()),
        })
        .collect();
    let module = sample.scene.spec.gears[0].body.module();
    format!("{}, m = {:.1} mm", teeth.join("/"), 1e3 * module)
}

/// The cheapest candidate within the tolerance so far.
struct CheapestCandidate {
    index: usize,
    cost: f64,
    error: f64,
}

fn validate_into(row: &mut ValidatedChoice, sample: &Sample) -> Result<(), ValidationError> {
    let metric = sample.metric;
    // Costs are those of runs alone, as they are compared below: set-up is distributed over as many as there may be.
    let problem = Problem {
        runs: u64::MAX,
        ..Problem::of(&sample.scene)
    };
    let times = grid(problem.duration, sample.contact_time);

    let requirement = Requirement {
        metric,
        tolerance: sample.tolerance,
    };
    // All modes are computed at once, and the choice and the candidates use subsets of them. The cost of the finer mesh
    // is recorded.
    let details = Details::of(&problem, DENSEST);
    row.refining_s = Some(details.setup_s(Detail::Finer));
    let prepared = CandidateData::with(&problem, details)?;
    let (begin, start) = (Instant::now(), cpu_time());
    let choice = choose(&problem, &requirement, |_| {});
    row.choosing_s = match (start, cpu_time()) {
        (Some(a), Some(b)) => Some(b - a),
        _ => Some(begin.elapsed().as_secs_f64()),
    };
    let choice = match choice {
        Ok(choice) => Some(choice),
        // An error is recorded as a choice without a candidate.
        Err(e) => {
            row.note = Some(e.to_string());
            None
        }
    };

    // What the choice had to do without candidates and judge do without as well.
    let judged = choice.as_ref().map(|c| c.details.clone());
    let prepared = match judged {
        Some(details) => CandidateData::with(&problem, details)?,
        None => prepared,
    };
    let truth = match reference::reference((&problem, &prepared), metric, &times) {
        Err(ValidationError::Reference { why, .. })
            if prepared.details.lead.detail == Detail::HalfSpaces =>
        {
            row.reference = reference::MESH_NAME.into();
            let given = Details::as_given(&problem, why);
            let given = CandidateData::with(&problem, given)?;
            reference::reference((&problem, &given), metric, &times)?
        }
        other => other?,
    };
    if prepared.details.lead.detail == Detail::Given {
        row.reference = reference::MESH_NAME.into();
    }
    row.reference_error = truth.own_error;
    row.mesh_error = truth.mesh_error;
    row.given_error = truth.given_error;

    let mut all = prepared.candidates(&problem);
    let chosen = choice.as_ref().and_then(|c| c.candidate.as_ref());
    // A step on the finer mesh costs what one on the scene's does: where that is near enough, no candidate on the finer
    // one is the cheapest.
    let finer = |c: &Candidate| c.level.detail() == Some(Detail::Finer);
    if truth
        .mesh_error
        .is_some_and(|e| e < OF_MESH * sample.tolerance)
        && !chosen.is_some_and(finer)
    {
        all.retain(|c| !finer(c));
    }
    all.sort_by(|a, b| effort(a).total_cmp(&effort(b)));
    row.candidates = all.len();
    let mut best: Option<CheapestCandidate> = None;
    for index in 0..all.len() {
        let tried = try_one(
            (&problem, &all, index),
            &row.tried,
            (&mut best, sample.tolerance),
            |seen| error(seen, metric, &truth.run),
            &times,
        )?;
        row.tried.push(tried);
    }
    let with = |status: &[&str]| {
        (row.tried.iter())
            .filter(|t| status.contains(&t.status.as_str()))
            .count()
    };
    row.cut_short = with(&[DEAR, SKIPPED]);
    row.failed = row.tried.len() - with(&[DEAR, SKIPPED, ADEQUATE, INADEQUATE]);
    row.least_error = (row.tried.iter())
        .filter_map(|t| t.error)
        .min_by(f64::total_cmp);

    if let Some(c) = &choice {
        row.predicted_error = Some(c.predicted_error).filter(|e| e.is_finite());
        row.outside.clone_from(&c.outside);
    }
    let Some(chosen) = chosen else {
        let undecided = (choice.as_ref()).filter(|c| c.verdict == Verdict::NotDecided);
        row.outcome = match (&best, undecided) {
            (_, Some(_)) => Outcome::NotDecided,
            (Some(_), None) => Outcome::WronglyNone,
            (None, None) => Outcome::RightlyNone,
        };
        if let Some(own) = undecided.map(|c| c.own_error.unwrap_or(f64::INFINITY)) {
            row.note = Some(format!("own error of the yardstick {:.2} %", 100.0 * own));
        }
        if let Some(b) = &best {
            put_cheapest(row, &all[b.index], b.error, Some(b.cost));
        }
        return Ok(());
    };
    row.chosen = Some(chosen.name());
    row.predicted_cost_s = choice
        .as_ref()
        .map(|c| c.predicted_cost_s)
        .filter(|c| c.is_finite());
    let mut trial = WindowModel::new(&problem, &chosen.scene, &chosen.modelling)?;
    let whole = (problem.duration, &times[..]);
    let seen = trial.observe(&chosen.method, whole, false, LONGEST)?;
    row.error = error(&seen, metric, &truth.run);
    let adequate = row.error.is_some_and(|e| e <= sample.tolerance);
    row.outcome = if adequate {
        Outcome::Adequate
    } else {
        Outcome::Inadequate
    };
    if row.error.is_none() {
        row.note = (seen.row.message).or_else(|| Some(seen.row.status.to_string()));
    }
    match &best {
        Some(b) if all[b.index].name() != chosen.name() => {
            let cheapest = &all[b.index];
            let mut other = WindowModel::new(&problem, &cheapest.scene, &cheapest.modelling)?;
            let [own, least] = side_by_side(
                (&mut trial, &chosen.method),
                (&mut other, &cheapest.method),
                problem.duration,
            );
            row.cost_s = own;
            // Timed in turn the choice may turn out to be the cheapest itself.
            match (own, least) {
                (Some(a), Some(b)) if adequate && a <= b => {
                    put_cheapest(row, chosen, row.error.unwrap_or_default(), own);
                }
                _ => put_cheapest(row, cheapest, b.error, least),
            }
        }
        _ => {
            row.cost_s = time(&mut trial, &chosen.method, problem.duration, LONGEST);
            if adequate {
                put_cheapest(row, chosen, row.error.unwrap_or_default(), row.cost_s);
            }
        }
    }
    Ok(())
}

fn put_cheapest(row: &mut ValidatedChoice, c: &Candidate, error: f64, cost: Option<f64>) {
    row.cheapest = Some(c.name());
    row.cheapest_error = Some(error);
    row.cheapest_cost_s = cost;
}

/// Verdicts on candidates in the table.
const ADEQUATE: &str = "adequate";
const INADEQUATE: &str = "inadequate";
/// Verdict on a candidate that costs more than the cheapest adequate one.
const DEAR: &str = "dearer";
/// Verdict on a candidate with a variant that is far more expensive than the cheapest adequate one.
const SKIPPED: &str = "skipped";

/// Runs one candidate and updates the best one.
fn try_one(
    (problem, all, index): (&Problem, &[Candidate], usize),
    before: &[ValidatedCandidate],
    (best, tolerance): (&mut Option<CheapestCandidate>, f64),
    error: impl Fn(&Seen) -> Option<f64>,
    times: &[f64],
) -> Result<ValidatedCandidate, ValidationError> {
    let candidate = &all[index];
    let mut tried = ValidatedCandidate {
        name: candidate.name(),
        ..ValidatedCandidate::default()
    };
    let least = best.as_ref().map(|b| b.cost);
    if let Some(least) = least
        && (before.iter().zip(all)).any(|(t, other)| {
            t.cost_s.is_some_and(|c| c > DEARER * least) && is_dearer_kin(candidate, other)
        })
    {
        tried.status = SKIPPED.into();
        return Ok(tried);
    }
    let mut trial = match WindowModel::new(problem, &candidate.scene, &candidate.modelling) {
        Ok(trial) => trial,
        Err(e) => {
            tried.status = e.to_string();
            return Ok(tried);
        }
    };
    // What is adequate has a cost to compare; before anything is, errors come first.
    if let Some(least) = least {
        let (factor, slack) = TIMES_CHEAPEST;
        let limit = Duration::from_secs_f64(slack + factor * least).min(LONGEST);
        let begin = Instant::now();
        match time(&mut trial, &candidate.method, problem.duration, limit) {
            Some(cost) => {
                tried.cost_s = Some(cost);
                if cost > NEAR * least {
                    tried.status = DEAR.into();
                    return Ok(tried);
                }
            }
            None if begin.elapsed() >= limit => {
                tried.cost_s = Some(factor * least);
                tried.status = DEAR.into();
                return Ok(tried);
            }
            // A failed run has no speeds; the observed run has the reason.
            None => {}
        }
    }
    let whole = (problem.duration, times);
    let seen = match trial.observe(&candidate.method, whole, false, LONGEST) {
        Ok(seen) => seen,
        Err(e @ (RunError::NoLinearPart(_) | RunError::Unsupported(_))) => {
            tried.status = e.to_string();
            return Ok(tried);
        }
        Err(e) => return Err(e.into()),
    };
    tried.error = error(&seen);
    let Some(e) = tried.error else {
        tried.status = seen.row.status.to_string();
        return Ok(tried);
    };
    if e > tolerance {
        tried.status = INADEQUATE.into();
        return Ok(tried);
    }
    // Also a second look at what may be the cheapest.
    let Some(cost) = time(&mut trial, &candidate.method, problem.duration, LONGEST) else {
        tried.status = Status::Timeout.to_string();
        return Ok(tried);
    };
    let cost = tried.cost_s.map_or(cost, |c| c.min(cost));
    tried.status = ADEQUATE.into();
    tried.cost_s = Some(cost);
    if least.is_none_or(|c| cost < c) {
        *best = Some(CheapestCandidate {
            index,
            cost,
            error: e,
        });
    }
    Ok(tried)
}

/// Estimated cost of a candidate, number of steps times cost per step, by which candidates are ordered so that cheap
/// ones come first. Results do not depend on it.
fn effort(c: &Candidate) -> f64 {
    // A step of rigid gears, of movable teeth (which swing faster than steps say), of elastic gears, of each of their
    // modes.
    let (rigid, teeth, elastic, mode) = (1.0, 100.0, 30.0, 0.5);
    let step = match &c.level {
        Level::Rigid(_) => rigid,
        Level::MovableTeeth(_) => teeth,
        other => elastic + mode * other.modes().unwrap_or(0) as f64,
    };
    match c.method.resolution {
        Resolution::Step(h) => step / h,
        // As many steps as some microseconds would give: tolerances of one scene are not comparable with steps.
        Resolution::Tolerance(r) => step / (5e-6 * r.powf(0.25)),
    }
}

/// True if a candidate cannot be cheaper than another: same integrator with steps no longer, on the same level or with
/// no fewer modes.
fn is_dearer_kin(c: &Candidate, other: &Candidate) -> bool {
    let same_level = match (c.level.modes(), other.level.modes()) {
        (Some(a), Some(b)) => a >= b && c.level.detail() == other.level.detail(),
        _ => c.level == other.level,
    };
    let finer = match (c.method.resolution, other.method.resolution) {
        (Resolution::Step(a), Resolution::Step(b)) => a <= b,
        (Resolution::Tolerance(a), Resolution::Tolerance(b)) => a <= b,
        _ => false,
    };
    same_level && finer && c.method.method == other.method.method
}
