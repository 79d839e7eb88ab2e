//! Coupled runs on several threads, each compared with the run of its model as one system.

use super::exchange::{Bounds, CoupledRun, CouplingScheme, End, exchange};
use super::plan::{ALLOWED, Entry, HOPELESS, Plan};
use super::theory;
use crate::experiment::decimation::decimate_run;
use crate::experiment::error::StudyError;
use crate::experiment::history::History;
use crate::experiment::parallel::{in_parallel, lock};
use crate::experiment::record::time_series;
use crate::experiment::run::{Job, NO_BOUND, RunError, run};
use crate::experiment::runner::Runner;
use crate::experiment::status::{message_of, status_of};
use crate::small_signals::assemble;
use gearbench_integrators::{Resolution, StepError};
use gearbench_models::scene::Scene;
use gearbench_reports::coupling::{Coupling, CouplingCell, CouplingRecord, Extrapolation, Motion};
use gearbench_reports::metrics::compare;
use gearbench_reports::numbers::short;
use gearbench_reports::record::{Ledger, Part, Results, Run, Status, Tolerance, finite};
use gearbench_reports::{FinishedRun, Metric};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Ratio of the smallest step that failed to the largest successful one below it, at which the search for the limit
/// ends.
const BRACKET: f64 = 1.05;

/// Reference id of a model's run as one system.
pub const WHOLE: &str = "one system";

/// A line of the study: place of the model, and how it is coupled.
type ModelCoupling = (usize, Extrapolation, Motion);

fn job<'j>(plan: &'j Plan, entry: &'j Entry, grid: &'j [f64]) -> Job<'j> {
    let of = &entry.configuration;
    Job {
        repeats: 0,
        ..(plan.conditions).job((&of.scene, &of.modelling), &entry.method, grid)
    }
}

/// The runs as one system.
fn runs_as_one_system(
    plan: &Plan,
    runner: &Runner<'_>,
    grid: &[f64],
) -> Result<Vec<Run>, StudyError> {
    let one = |(i, entry): (usize, &Entry)| -> Result<Run, StudyError> {
        let label = &entry.configuration.label;
        runner.report_progress(i, plan.len(), &format!("{label} as one system"));
        let job = job(plan, entry, grid);
        let mut row = runner.row(job.key().and(&WHOLE), &entry.method, || {
            let mut row = run(&job)?;
            let own = row.series.as_ref().zip(row.finished().ok());
            let own = own.map(|(series, run)| compare(run, series, WHOLE));
            row.metrics.extend(own);
            row.contacts = None;
            Ok::<_, RunError>(row)
        })?;
        entry.configuration.sign(&mut row);
        row.end_s = Some(job.t_end);
        Ok(row)
    };
    plan.entries.iter().enumerate().map(one).collect()
}

/// Runs all models, as one system and in two coupled parts, on several threads.
///
/// # Errors
/// [`StudyError`]; runs that fail are cells.
pub fn study(plan: &Plan, runner: &Runner<'_>, threads: usize) -> Result<Results, StudyError> {
    let grid = plan.conditions.grid();
    let mut runs = runs_as_one_system(plan, runner, &grid)?;
    let lines = plan.lines();
    let done = AtomicUsize::new(runs.len());
    let made: Mutex<Vec<Option<Coupling>>> = Mutex::new(vec![None; lines.len()]);
    // Lines of one model on threads side by side: their times are alike.
    let places: Vec<usize> = (0..lines.len()).collect();
    in_parallel(threads, &places, |&place| {
        let (entry, ..) = lines[place];
        let about = SharedData {
            plan,
            runner,
            grid: &grid,
            entry: &plan.entries[entry],
            whole: &runs[entry],
            done: &done,
        };
        let coupling = about.line(lines[place])?;
        lock(&made)[place] = Some(coupling);
        Ok::<_, StudyError>(())
    })?;
    let couplings = std::mem::take(&mut *lock(&made));
    for row in &mut runs {
        decimate_run(row, &[]);
        row.series = None;
    }
    Ok(Results {
        tolerance: Some(Tolerance {
            metric: Metric::ForceL2,
            limit: plan.tolerance,
            against: WHOLE.into(),
            except: Vec::new(),
        }),
        runs,
        ..(plan.conditions).record(Part::Coupling(CouplingRecord {
            couplings: couplings.into_iter().flatten().collect(),
        }))
    })
}

/// Data that the runs of a line share.
struct SharedData<'a> {
    plan: &'a Plan,
    runner: &'a Runner<'a>,
    grid: &'a [f64],
    entry: &'a Entry,
    whole: &'a Run,
    done: &'a AtomicUsize,
}

impl SharedData<'_> {
    fn line(&self, (_, extrapolation, motion): ModelCoupling) -> Result<Coupling, StudyError> {
        let Entry {
            configuration,
            method,
            oscillator,
            ..
        } = self.entry;
        let contact = self.whole.against(WHOLE).and_then(|m| m.duration_s);
        let contact = contact.filter(|t| *t > 0.0);
        let theory = (*oscillator).zip(contact);
        let mut coupling = Coupling {
            model: configuration.model.clone(),
            variant: configuration.variant(),
            residual: super::plan::keeps_residual(configuration),
            extrapolation,
            motion,
            integrator: method.method.to_string(),
            step_s: method.resolution.step(),
            frequency_hz: oscillator.map(|o| o[0] / std::f64::consts::TAU),
            damping_ratio: oscillator.map(|o| o[1]),
            contact_s: contact,
            energy_j: self.scale(),
            theory_s: theory.and_then(|(o, time)| theory::limit(extrapolation, o, time, ALLOWED)),
            cells: Vec::new(),
            refined: Vec::new(),
        };
        // Built when the first run is to be made.
        let mut scene = None;
        for &step in &self.entry.steps {
            let cell = self.made(&mut scene, (extrapolation, motion, step))?;
            coupling.cells.push(cell);
        }
        while let [Some(held), Some(failed)] = coupling.stable()
            && failed > BRACKET * held
        {
            let step = (held * failed).sqrt();
            let cell = self.made(&mut scene, (extrapolation, motion, step))?;
            let stop = cell.status == Status::Interrupted;
            coupling.refined.push(cell);
            if stop {
                break;
            }
        }
        Ok(coupling)
    }

    /// A run in two parts, made now unless it is finished.
    fn made(
        &self,
        scene: &mut Option<Scene>,
        (extrapolation, motion, step): (Extrapolation, Motion, f64),
    ) -> Result<CouplingCell, StudyError> {
        let done = self.done.fetch_add(1, Ordering::Relaxed);
        let label = &self.entry.configuration.label;
        let what = format!("{label}, {extrapolation}, {step:.1e} s");
        self.runner
            .report_progress(done, self.plan.len().max(done), &what);
        let manner = CouplingScheme {
            extrapolation,
            motion,
            step,
        };
        let key = (job(self.plan, self.entry, self.grid).key()).and(&(
            "in two parts",
            manner,
            self.plan.tolerance,
        ));
        self.runner.guarded(
            key,
            || self.cell(scene, manner),
            |status, message| CouplingCell {
                step_s: step,
                status,
                message: Some(message),
                ..CouplingCell::default()
            },
        )
    }

    /// Energy that vibrates and passes through contacts [J].
    fn scale(&self) -> Option<f64> {
        let found = self.whole.ledger.vibrating_j.and_then(finite);
        found.filter(|e| *e > 0.0)
    }

    fn cell(
        &self,
        scene: &mut Option<Scene>,
        manner: CouplingScheme,
    ) -> Result<CouplingCell, StudyError> {
        let job = job(self.plan, self.entry, self.grid);
        let scene = match scene {
            Some(scene) => scene,
            none => none.insert(
                assemble(job.scene, job.modelling, &job.context.models).map_err(RunError::from)?,
            ),
        };
        let mut history = History::whole(scene, self.grid.to_vec(), job.also_steps);
        let bounds = Bounds {
            t_end: job.t_end,
            events: job.events,
            max_steps: job.max_steps,
            cancel: job.context.interruption.flag(),
            timeout: (job.timeout < NO_BOUND).then_some(job.timeout),
            hopeless: self.scale().map_or(f64::MAX, |e| HOPELESS * e),
        };
        let Entry { frames, method, .. } = self.entry;
        let found = exchange(scene, frames, method, manner, bounds, &mut history);
        if job.context.interruption.is_requested() {
            return Err(RunError::Interrupted.into());
        }
        let series = time_series(&job, scene, &history);
        let mut cell = CouplingCell {
            step_s: manner.step,
            energy_error_j: finite(found.energy),
            energy_error_rel: self.scale().and_then(|e| finite(found.energy / e)),
            energy_error_step_rel: self.scale().and_then(|e| finite(found.largest / e)),
            reached_s: finite(found.reached),
            exchanges: found.exchanges,
            ..CouplingCell::default()
        };
        let ledger = Ledger::default();
        let ends = [found.reached, job.t_end];
        if let (Ok(run), Some(whole)) = (
            FinishedRun::reached(&series, &ledger, ends),
            &self.whole.series,
        ) {
            let metrics = compare(run, whole, WHOLE);
            cell.force_l2 = metrics.force_l2;
            cell.rebound_rel = metrics.rebound_rel;
        }
        (cell.status, cell.message) = self.label(&found, &cell);
        Ok(cell)
    }

    /// The label of a run, and why it has it.
    fn label(&self, found: &CoupledRun, cell: &CouplingCell) -> (Status, Option<String>) {
        let fixed = matches!(self.entry.method.resolution, Resolution::Step(_));
        let at = found.reached;
        match &found.end {
            End::Gears(e @ StepError::NonFinite { .. }) => (
                Status::BlowUp,
                Some(format!("{e}, or a smaller communication step")),
            ),
            End::Gears(e) => (status_of(e), Some(message_of(e, fixed))),
            End::RanAway => (
                Status::BlowUp,
                Some(format!(
                    "the motion of hubs and gears diverges by t = {at:.4e} s; use a smaller communication step"
                )),
            ),
            End::Timeout => (
                Status::Timeout,
                Some(format!(
                    "stopped at t = {at:.4e} s at the limit of processor time"
                )),
            ),
            End::Reached => self.judged(cell),
        }
    }

    fn judged(&self, cell: &CouplingCell) -> (Status, Option<String>) {
        let percent = |x: f64| short(100.0 * x, 3);
        if let Some(made_up) = cell.energy_error_rel.filter(|e| *e > ALLOWED) {
            let why = format!(
                "the coupling adds {} % of the vibration energy; use a smaller communication step",
                percent(made_up)
            );
            return (Status::EnergyGrowth, Some(why));
        }
        match cell.force_l2 {
            Some(e) if e <= self.plan.tolerance => (Status::Converged, None),
            Some(e) => (
                Status::Inaccurate,
                Some(format!(
                    "the error of the force against the run without coupling is {} %, above the limit of {} %",
                    percent(e),
                    percent(self.plan.tolerance)
                )),
            ),
            None => (
                Status::Unchecked,
                Some("the run without coupling has no contact force for comparison".into()),
            ),
        }
    }
}
