//! Runs of a model over the contact penalty.

use super::plan::Plan;
use crate::experiment::configuration::Configuration;
use crate::experiment::decimation::decimate_run;
use crate::experiment::error::StudyError;
use crate::experiment::run::{Job, run};
use crate::experiment::runner::Runner;
use gearbench_reference::statics::{Load, LoadedPair, MeshCycle};
use gearbench_reports::metrics::compare as measure;
use gearbench_reports::record::{Part, ReferenceSeries, Results, Run, SELF};
use gearbench_reports::series::TimeSeries;

/// Advice for a model without a penalty.
pub(super) const TAKE_POINTS: &str =
    "use a model with contact at flank points: `contact = { penalty_pa_per_m = .. }`";

/// The entry with another penalty in all its meshes.
fn with_penalty(entry: &Configuration, penalty: f64) -> Result<Configuration, StudyError> {
    let mut entry = entry.clone();
    let mut any = false;
    for contact in &mut entry.modelling.contacts {
        if let Some(points) = &mut contact.points {
            points.penalty = penalty;
            any = true;
        }
    }
    if any {
        Ok(entry)
    } else {
        let why = format!("the contact of `{}` has no penalty", entry.label);
        Err(StudyError::Scene(why, TAKE_POINTS))
    }
}

/// Mean static transmission error over one base pitch [m].
fn static_error(plan: &Plan, entry: &Configuration) -> Result<Option<f64>, StudyError> {
    let Some(force) = plan.load else {
        return Ok(None);
    };
    let fail = |e| StudyError::Statics(entry.label.clone(), e);
    let mut pair = LoadedPair::new(
        &entry.scene,
        &entry.modelling,
        &plan.conditions.context.models,
    )
    .map_err(fail)?;
    let cycle = MeshCycle::solve(&mut pair, Load::Force(force), plan.positions, |_| {});
    Ok(Some(cycle.map_err(fail)?.mean_error()))
}

/// Runs the model at every penalty, and with hard contact where it is planned.
///
/// # Errors
/// [`StudyError`]; runs that fail are rows.
pub fn study(plan: &Plan, runner: &Runner<'_>) -> Result<Results, StudyError> {
    let grid = plan.conditions.grid();
    let total = plan.penalties.len() + usize::from(plan.hard.is_some());
    let one = |entry: &Configuration, done: usize, what: &str| -> Result<Run, StudyError> {
        runner.report_progress(done, total, what);
        let method = (entry.methods.as_ref())
            .and_then(|m| m.first())
            .unwrap_or(&plan.method);
        let job = Job {
            histories: true,
            ..(plan.conditions).job((&entry.scene, &entry.modelling), method, &grid)
        };
        let key = job.key().and(&(plan.load, plan.positions));
        let mut row = runner.row(key, method, || {
            let mut row = run(&job)?;
            row.static_error_m = static_error(plan, entry)?;
            row.contacts = None;
            Ok::<_, StudyError>(row)
        })?;
        row.end_s = Some(job.t_end);
        // One name for soft and hard contact: they are one model.
        row.model.clone_from(&plan.entry.model);
        row.variant = plan.entry.variant();
        runner.reserve_memory(&row);
        Ok(row)
    };
    let mut references = Vec::new();
    let mut last = None;
    if let Some(hard) = &plan.hard {
        let mut row = one(hard, 0, "hard contact")?;
        row.hard = Some(true);
        if let Some(series) = row.series.as_ref().filter(|_| !row.status.is_failure()) {
            // The outputs alone: this run is the reference.
            let none = TimeSeries::default();
            let metrics = row.finished().map(|run| measure(run, &none, "hard"));
            references.push(ReferenceSeries {
                id: "hard".into(),
                title: "hard contact".into(),
                source: format!("the last run of this record: {}", hard.label),
                series: series.clone(),
                ..ReferenceSeries::default()
            });
            row.metrics.extend(metrics);
        }
        last = Some(row);
    }
    let mut runs = Vec::new();
    for &penalty in &plan.penalties {
        let entry = with_penalty(&plan.entry, penalty)?;
        let what = format!("{}, {penalty:.1e} Pa/m", entry.label);
        let mut row = one(&entry, runs.len() + usize::from(last.is_some()), &what)?;
        row.penalty_pa_per_m = Some(penalty);
        if let Ok(run) = row.finished() {
            // Without a limit to refer to, the outputs alone.
            let none = TimeSeries::default();
            let (target, id) = match references.first() {
                Some(r) => (&r.series, "hard"),
                None => (&none, SELF),
            };
            let metrics = measure(run, target, id);
            row.metrics.push(metrics);
        }
        runs.push(row);
    }
    runs.extend(last);
    for row in &mut runs {
        decimate_run(row);
    }
    runner.report_progress(runs.len(), total, "report");
    Ok(Results {
        references,
        runs,
        ..plan.conditions.record(Part::Penalty)
    })
}
