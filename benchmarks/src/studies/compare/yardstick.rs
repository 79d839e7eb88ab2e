//! The yardstick of a comparison: the solution that models are compared with, and the estimate of its own error.
//!
//! | scene | yardstick |
//! |---|---|
//! | has a reference | the reference |
//! | has a tolerance for models, or `--yardstick refined` | refined gears |
//! | has a `reference_model`, or models of several degrees of detail | its most detailed model |
//!
//! **Refined gears** are those that `choose` judges by: elastic gears with twice the elements of the scene's, on half-spaces
//! where flanks may touch so. Further runs give the parts of their own error in the metric `e` of the tolerance, by the functions
//! that `choose` estimates its own yardstick with:
//!
//! ```text
//! integration  e(step 2 h)/3                    second order; where 2 h does not carry all modes, 4/3 e(step h/2)
//! modes        d q/(1 - q)                      d, q: last distance of 50, 75, 100 modes, and its ratio to the one before
//! mesh         e(mesh of the scene) q/(1 - q)   q = 1/4 on half-spaces, 1/2 where elements touch; all of e above 0.2
//! ```
//!
//! Their sum is the error of the yardstick. Each of these runs, with the recording of its history, is bounded by processor time as every other run is
//! (`--timeout`).
//! If refined gears do not reach the end, the most detailed model of the scene is the yardstick instead; if a further run
//! does not, its part of the error is unknown. In both cases the error of the yardstick is unknown, so that no model is
//! adequate or not adequate, and the comparison gives the reason.

use super::Plan;
use crate::experiment::configuration::Configuration;
use crate::experiment::run::{Job, RunError, run};
use crate::experiment::runner::Runner;
use crate::scene_file::SceneFile;
use crate::studies::choose::detail::Details;
use crate::studies::choose::plan::{elastic, fine_step};
use crate::studies::choose::problem::{ElasticSettings, Problem};
use crate::studies::choose::refinement::{
    error_of_mesh, error_of_modes, error_of_step, steps_per_contact,
};
use crate::studies::choose::trial::cannot_run;
use gearbench_integrators::Scheme;
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::spec::ModelSpec;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::comparison::{Kind, Yardstick};
use gearbench_reports::metrics::{Metric, compare};
use gearbench_reports::numbers::quantity;
use gearbench_reports::record::{ReferenceSeries, Run, SELF, Status};
use gearbench_reports::series::TimeSeries;

/// Id of refined gears among the references of a record, and in `tolerance.against` of a scene.
pub const REFINED: &str = "refined";
/// Dynamic modes per gear of refined gears, and of the runs from which their truncation error is estimated.
const MODES: usize = 100;
const FEWER: [usize; 2] = [75, 50];
/// Number of runs for the yardstick and the parts of its error.
const RUNS: usize = 5;
/// Default tolerance for which the step is chosen, for scenes without one.
const USUAL: f64 = 0.05;
/// Tolerance of refined gears whose modes are coupled.
const COUPLED_RTOL: f64 = 1e-6;

/// Kind of yardstick with which a comparison compares its models.
#[derive(Clone, Debug, Default)]
pub enum YardstickChoice {
    /// Stored references of the scene, if it has any.
    #[default]
    Stored,
    /// The most detailed model of the comparison, by its label.
    MostDetailed(String),
    /// A model that the scene or the user names, by its label.
    Named(String),
    /// Refined gears of the scene.
    Refined(Box<Problem>),
}

impl YardstickChoice {
    /// Returns the kind of yardstick of the option `--yardstick`, else of the scene.
    pub fn of(
        scene: &SceneFile,
        entries: &[Configuration],
        option: Option<&str>,
    ) -> YardstickChoice {
        let refined = || YardstickChoice::Refined(Box::new(Problem::of(scene)));
        let against = scene.tolerance.as_ref().map(|t| t.against.as_str());
        match (option, &scene.study.reference_model) {
            (Some(REFINED), _) => refined(),
            (Some(label), _) => YardstickChoice::Named(label.to_owned()),
            (None, Some(label)) => YardstickChoice::Named(label.clone()),
            (None, None) if against == Some(REFINED) => refined(),
            (None, None) if scene.references.iter().any(|r| r.is_of_the_scene()) => {
                YardstickChoice::Stored
            }
            (None, None) => most_detailed(&scene.context.models, entries)
                .map_or(YardstickChoice::Stored, YardstickChoice::MostDetailed),
        }
    }

    /// Returns the label of the model that serves as yardstick.
    pub fn label(&self) -> Option<&str> {
        match self {
            YardstickChoice::MostDetailed(label) | YardstickChoice::Named(label) => Some(label),
            YardstickChoice::Stored | YardstickChoice::Refined(_) => None,
        }
    }
}

/// Returns the label of the most detailed model; `None` where all are equally detailed.
pub fn most_detailed(models: &[Model], entries: &[Configuration]) -> Option<String> {
    let kind = |e: &Configuration| {
        let of_gear = |g: &ModelSpec| match properties_of(models, g.id()) {
            p if p.full_order => 3,
            p if p.modes => 2,
            p if !p.rigid => 1,
            _ => 0,
        };
        e.modelling.gears.iter().map(of_gear).max()
    };
    let rank = |e: &Configuration| {
        let modes = (e.modelling.gears.iter())
            .filter_map(|g| ElasticParameters::of(g)?.modes)
            .max();
        let mut contacts = e.modelling.contacts.iter();
        let on_half_spaces = contacts.all(|c| c.flanks.points().is_none());
        (kind(e), on_half_spaces, modes)
    };
    let most = entries.iter().max_by_key(|e| rank(e))?;
    let least = entries.iter().map(kind).min()?;
    (kind(most) > least).then(|| most.label.clone())
}

/// Refined gears as a reference, with their estimated error.
pub struct Refined {
    /// History of the refined gears.
    pub reference: ReferenceSeries,
    /// Estimated error of the refined gears.
    pub yardstick: Yardstick,
}

/// Variant of the refined gears: elements, modes and step.
#[derive(Clone, Copy)]
struct Variant<'a> {
    flexible: &'a ElasticSettings,
    modes: usize,
    /// Step over that of the finest run.
    coarser: f64,
}

/// Runs refined gears in several ways.
struct YardstickRunner<'a> {
    plan: &'a Plan,
    problem: &'a Problem,
    runner: &'a Runner<'a>,
    step: f64,
    metric: Metric,
    /// Number of runs that were started.
    begun: usize,
}

/// A part of the error of refined gears, or the reason why it is unknown.
type ErrorPart = Result<f64, String>;

/// Runs refined gears of a scene over the whole of it.
///
/// The inner error is the reason why there are none.
///
/// # Errors
/// [`RunError`] where the user interrupts, or the journal fails.
pub fn refined(
    plan: &Plan,
    problem: &Problem,
    runner: &Runner<'_>,
) -> Result<Result<Refined, String>, RunError> {
    let limit = plan.tolerance.as_ref().map_or(USUAL, |t| t.limit);
    let metric = (plan.tolerance.as_ref())
        .filter(|t| t.against == REFINED)
        .map_or(Metric::default(), |t| t.metric);
    let step = match fine_step(problem, steps_per_contact(limit)) {
        Ok(step) => step,
        Err(e) => return Ok(Err(e.to_string())),
    };
    let mut maker = YardstickRunner {
        plan,
        problem,
        runner,
        step,
        metric,
        begun: 0,
    };
    maker.report_progress("mesh and modes of refined gears");
    let details = Details::of(problem, MODES);
    let finest = Variant {
        flexible: details.judge(),
        modes: MODES,
        coarser: 1.0,
    };
    let mut made = match maker.run("refined gears", &finest)? {
        Ok(made) => made,
        Err(why) => return Ok(Err(why)),
    };
    let series = made.series.take().unwrap_or_default();
    let integration = maker.integration(&finest, &made, &series)?;
    let modes = maker.modes(&finest, &series)?;
    let lead = Variant {
        flexible: &details.lead,
        ..finest
    };
    let mesh = match &details.finer {
        Ok(_) => (maker.distance("mesh of the scene", &lead, &series)?)
            .map(|e| error_of_mesh(e, details.on_half_spaces())),
        Err(why) => Err(why.clone()),
    };
    let parts = [&integration, &modes, &mesh];
    let error = parts
        .iter()
        .try_fold(0.0, |sum, e| Some(sum + e.as_ref().ok()?));
    let title = format!(
        "refined elastic gears ({}; {MODES} modes)",
        details.describe_judge()
    );
    let reasons = parts.into_iter().filter_map(|e| e.as_ref().err());
    let notes: Vec<String> = reasons.chain(&details.no_half_spaces).cloned().collect();
    Ok(Ok(Refined {
        reference: ReferenceSeries {
            id: REFINED.into(),
            title: title.clone(),
            source: format!(
                "run of this record: {} coordinates, {}, {} steps",
                made.dofs, made.integrator, made.steps
            ),
            note: notes.join("; "),
            cpu_s: Some(made.cpu_s).filter(|t| *t > 0.0),
            series,
            ..ReferenceSeries::default()
        },
        yardstick: Yardstick {
            id: REFINED.into(),
            kind: Kind::Refined,
            title,
            integration_error: integration.ok(),
            modes_error: modes.ok(),
            mesh_error: mesh.ok(),
            error,
            note: notes.join("; "),
        },
    }))
}

impl YardstickRunner<'_> {
    fn report_progress(&self, what: &str) {
        let what = format!("yardstick: {what}");
        self.runner.report_progress(0, self.plan.len(), &what);
    }

    /// Runs a variant; the inner error is the reason why it does not reach its end.
    fn run(&mut self, what: &str, of: &Variant<'_>) -> Result<Result<Run, String>, RunError> {
        self.begun += 1;
        self.report_progress(&format!("run {} of {RUNS}, {what}", self.begun));
        let modelling = elastic(of.flexible, of.modes, Some(self.step));
        let conditions = &self.plan.conditions;
        let grid = conditions.grid();
        let under = |method: &Scheme| {
            let job = Job {
                repeats: 0,
                // As in `choose`: the characteristic time of modes is far finer than any jump of a dashpot asks for, and
                // recording within steps would take several times as long as the integration.
                also_steps: false,
                ..conditions.job((&self.problem.scene, &modelling), method, &grid)
            };
            let key = job.key().and(&"yardstick");
            self.runner.piece(key, || run(&job))
        };
        let made = match under(&TRIGONOMETRIC.at_step(of.coarser * self.step)) {
            // Where something couples the modes, an adaptive method of the fifth order runs them.
            Err(RunError::NoLinearPart(_)) => {
                under(&DOPRI5.at_tolerance(of.coarser.powi(5) * COUPLED_RTOL))
            }
            other => other,
        };
        match made {
            Err(e) => cannot_run(&e).map(Err).ok_or(e),
            Ok(row) if row.status == Status::Timeout => Ok(Err(format!(
                "{} of processor time are not enough for a run over the {} of the scene and its recording; allow more with --timeout",
                quantity(conditions.timeout.as_secs_f64(), "s", 3),
                quantity(conditions.duration, "s", 3)
            ))),
            Ok(row) if row.status.is_failure() => {
                Ok(Err(row.message.unwrap_or_else(|| row.status.to_string())))
            }
            Ok(row) => Ok(Ok(row)),
        }
    }

    /// Returns the distance of a run to a history.
    fn between(
        &self,
        (what, made): (&str, &Result<Run, String>),
        series: &TimeSeries,
    ) -> ErrorPart {
        let found = made.as_ref().map_err(Clone::clone).and_then(|run| {
            let run = run.finished().map_err(|e| e.to_string())?;
            let found = compare(run, series, REFINED).get(self.metric).map(f64::abs);
            let finite = found.filter(|d| d.is_finite());
            finite.ok_or_else(|| "the metric has no value".to_owned())
        });
        found.map_err(|why| {
            format!("their error is unknown, because the run with {what} has no result: {why}")
        })
    }

    /// Runs a variant and returns its distance to refined gears.
    fn distance(
        &mut self,
        what: &str,
        of: &Variant<'_>,
        series: &TimeSeries,
    ) -> Result<ErrorPart, RunError> {
        let made = self.run(what, of)?;
        Ok(self.between((what, &made), series))
    }

    /// Estimates the integration error of the refined gears.
    fn integration(
        &mut self,
        finest: &Variant<'_>,
        made: &Run,
        series: &TimeSeries,
    ) -> Result<ErrorPart, RunError> {
        if made.step.is_none() {
            // The order of an adaptive method gives no estimate: the whole difference counts as its error.
            let looser = Variant {
                coarser: 2.0,
                ..*finest
            };
            return self.distance("a looser tolerance", &looser, series);
        }
        let highest = made.highest_hz.unwrap_or(0.0);
        let mut reasons = Vec::new();
        let found = error_of_step((self.step, highest), |step| {
            let coarser = step / self.step;
            let other = Variant { coarser, ..*finest };
            let found = self.distance(&format!("{coarser} times the step"), &other, series)?;
            Ok::<_, RunError>(found.unwrap_or_else(|why| {
                reasons.push(why);
                f64::INFINITY
            }))
        })?;
        Ok(found.ok_or_else(|| reasons.join("; ")))
    }

    /// Estimates the truncation error of the refined gears from runs with fewer modes.
    fn modes(&mut self, finest: &Variant<'_>, series: &TimeSeries) -> Result<ErrorPart, RunError> {
        let mut distances = Vec::new();
        let mut next = series.clone();
        for modes in FEWER {
            let what = format!("{modes} modes");
            let made = self.run(&what, &Variant { modes, ..*finest })?;
            match self.between((&what, &made), &next) {
                Ok(distance) => distances.insert(0, distance),
                Err(why) => return Ok(Err(why)),
            }
            next = made.ok().and_then(|m| m.series).unwrap_or_default();
        }
        Ok(Ok(error_of_modes(&distances, self.metric)))
    }
}

/// Returns a model of the comparison as the yardstick: only the integration part of its own error is known.
pub fn of_entry((id, kind): (&str, Kind), row: &Run, metric: Metric, note: &str) -> Yardstick {
    Yardstick {
        id: id.to_owned(),
        kind,
        title: row.model_label(),
        integration_error: (row.against(SELF))
            .and_then(|m| m.get(metric.of_integration()))
            .map(f64::abs),
        note: note.to_owned(),
        ..Yardstick::default()
    }
}

/// Returns a stored reference as the yardstick.
pub fn of_stored(reference: &ReferenceSeries) -> Yardstick {
    Yardstick {
        id: reference.id.clone(),
        kind: Kind::Stored,
        title: match reference.title.as_str() {
            "" => reference.id.clone(),
            title => title.to_owned(),
        },
        error: reference.own_error,
        ..Yardstick::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::test_scene::coarse;
    use gearbench_reports::Adequacy;
    use std::time::Duration;

    /// Refined gears are bounded by processor time as all runs are. If they do not reach the end there is no yardstick;
    /// if a further run fails, their error is unknown and nothing is decided. Both are reported.
    #[test]
    fn refined_gears_that_do_not_end_are_told() {
        let scene = coarse(&[("modes", 10.0.into())]);
        let choices: Vec<_> = scene.models.iter().collect();
        let mut plan = Plan::of(&scene, &choices, &[]);
        let problem = Problem::of(&scene);
        let runner = Runner::default();
        let made = refined(&plan, &problem, &runner).unwrap().ok().unwrap();
        assert_eq!(made.yardstick.note.matches("unknown").count(), 0);
        let parts = [
            made.yardstick.integration_error,
            made.yardstick.modes_error,
            made.yardstick.mesh_error,
        ];
        assert!(
            parts.iter().all(|e| e.is_some_and(|e| e > 0.0)),
            "{parts:?}"
        );
        let maker = YardstickRunner {
            plan: &plan,
            problem: &problem,
            runner: &runner,
            step: 1e-7,
            metric: Metric::default(),
            begun: 0,
        };
        let ended_early = Err("it got to half of the end".to_owned());
        let series = &made.reference.series;
        let why = maker
            .between(("75 modes", &ended_early), series)
            .unwrap_err();
        assert!(
            why.contains("75 modes") && why.contains("half of the end"),
            "{why}"
        );
        let without = Yardstick {
            error: None,
            ..made.yardstick
        };
        assert_eq!(without.verdict(1e-9, 0.5), Adequacy::NotDecided);

        // No run ends within a nanosecond.
        plan.conditions.timeout = Duration::from_nanos(1);
        let why = refined(&plan, &problem, &runner).unwrap().err().unwrap();
        assert!(
            why.contains("--timeout") && why.contains("not enough"),
            "{why}"
        );
    }
}
