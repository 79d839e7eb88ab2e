//! Runs of the cells of a scan on several threads.
//!
//! Cells are computed in lanes of consecutive cells, a lane by one thread at a time. The journal keeps the cells that a
//! thread has finished about three times a second: a piece begins at a known cell, and says where it ends. An interrupted scan
//! takes up the pieces of each lane, one behind the other, and goes on behind the last.

use super::output::Output;
use super::plan::Plan;
use super::table::{CellRun, TableError, TableWriter, header};
use crate::experiment::conditions::{Conditions, even};
use crate::experiment::configuration::Configuration;
use crate::experiment::journal::JournalError;
use crate::experiment::key::Key;
use crate::experiment::parallel::{in_parallel, lock};
use crate::experiment::run::{Job, RunError, run};
use crate::experiment::runner::{Runner, WorkError};
use crate::scene_file::{SceneError, SceneFile};
use gearbench_integrators::Scheme;
use gearbench_reports::metrics::compare;
use gearbench_reports::record::{Run, Status};
use gearbench_reports::series::TimeSeries;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Number of lanes, if there are enough cells.
const LANES: u64 = 64;
/// Largest number of cells of a lane.
const LONGEST_LANE: u64 = 256;
/// Wall time after which finished cells are stored.
const STORED_AFTER: Duration = Duration::from_millis(300);

/// Results of the runs of each cell, by the first cell of their lane.
pub struct FinishedCells(BTreeMap<u64, Vec<Vec<CellRun>>>);

impl FinishedCells {
    /// Number of cells.
    pub fn len(&self) -> u64 {
        self.0.values().map(|lane| lane.len() as u64).sum()
    }
}

/// Runs the cells of a scan; an interruption leaves cells out.
///
/// # Errors
/// [`JournalError`]; runs that fail and scenes that are refused are results.
pub fn study(
    plan: &Plan<'_>,
    runner: &Runner<'_>,
    threads: usize,
) -> Result<FinishedCells, JournalError> {
    let cells = plan.cells();
    let total = cells.end - cells.start;
    let length = (total / LANES).clamp(1, LONGEST_LANE);
    let lanes: Vec<Range<u64>> = (cells.start..cells.end)
        .step_by(length as usize)
        .map(|begin| begin..(begin + length).min(cells.end))
        .collect();
    let done: Mutex<BTreeMap<u64, Vec<Vec<CellRun>>>> = Mutex::default();
    let count = Mutex::new(0);
    let advance = |more: usize| {
        let mut count = lock(&count);
        *count += more;
        runner.report_progress(*count, total as usize, "");
    };
    in_parallel(threads, &lanes, |lane| {
        let mut finished: Vec<Vec<CellRun>> = Vec::new();
        loop {
            let next = lane.start + finished.len() as u64;
            if next >= lane.end {
                break;
            }
            let key = Key::new("cells of a scan").and(&plan.identity).and(&next);
            let known: Option<Vec<Vec<CellRun>>> = runner.finished(key)?;
            let piece = match known.filter(|known| !known.is_empty()) {
                Some(known) => known,
                None => {
                    let made = piece(plan, runner, next..lane.end);
                    if made.is_empty() {
                        break;
                    }
                    runner.store(key, made)?
                }
            };
            advance(piece.len());
            finished.extend(piece);
        }
        lock(&done).insert(lane.start, finished);
        Ok::<(), JournalError>(())
    })?;
    let done = done.into_inner();
    Ok(FinishedCells(done.unwrap_or_else(PoisonError::into_inner)))
}

/// Runs cells one after the other for a part of a second, at least one; none after an interruption.
fn piece(plan: &Plan<'_>, runner: &Runner<'_>, cells: Range<u64>) -> Vec<Vec<CellRun>> {
    let begin = Instant::now();
    let mut made = Vec::new();
    for cell in cells {
        match runs(plan, runner, cell) {
            Some(runs) => made.push(runs),
            None => break,
        }
        if begin.elapsed() > STORED_AFTER {
            break;
        }
    }
    made
}

/// Runs all models in the scene of a cell; `None` after an interruption.
fn runs(plan: &Plan<'_>, runner: &Runner<'_>, cell: u64) -> Option<Vec<CellRun>> {
    let without_scene = |status: Status, message: String| {
        let run = CellRun::without_result(status, message, plan.outputs.len());
        Some(vec![run; plan.runs.len()])
    };
    let labels: Vec<&str> = plan.runs.iter().map(|(label, _)| label.as_str()).collect();
    let damped = || {
        let mut scene = plan.scene_of(cell)?;
        scene.damp_unbuilt(&labels)?;
        Ok::<SceneFile, SceneError>(scene)
    };
    let scene = match runner.attempt(damped) {
        Ok(scene) => scene,
        Err(WorkError::Interrupted) => return None,
        Err(WorkError::Error(e)) => return without_scene(Status::Refused, e.to_text()),
        Err(WorkError::Panic(why)) => return without_scene(Status::Aborted, why),
    };
    let mut yardstick: Option<TimeSeries> = None;
    let mut all = Vec::with_capacity(plan.runs.len());
    for (i, (label, method)) in plan.runs.iter().enumerate() {
        let is_yardstick = i == 0 && plan.has_yardstick;
        let none = TimeSeries::default();
        let target = match plan.has_yardstick && !is_yardstick {
            true => yardstick.as_ref(),
            false => Some(&none),
        };
        let (result, series) = one((plan, runner), &scene, (label, method), target)?;
        if is_yardstick {
            yardstick = series;
        }
        all.push(result);
    }
    Some(all)
}

/// Runs a model in a scene; returns the history of a run that reached its end. `None` after an interruption.
fn one(
    (plan, runner): (&Plan<'_>, &Runner<'_>),
    scene: &SceneFile,
    (label, method): (&str, &Scheme),
    target: Option<&TimeSeries>,
) -> Option<(CellRun, Option<TimeSeries>)> {
    let failed = |status: Status, message: String| {
        let run = CellRun::without_result(status, message, plan.outputs.len());
        Some((run, None))
    };
    let Some(choice) = scene.model(label) else {
        return failed(Status::Refused, format!("the scene has no model `{label}`"));
    };
    let entry = Configuration::of(scene, choice);
    let conditions = Conditions {
        timeout: plan.timeout,
        repeats: 0,
        ..Conditions::of(scene)
    };
    let grid = even(conditions.samples, conditions.duration);
    let job = Job {
        paths: plan.outputs.contains(&Output::Efficiency),
        ..conditions.job((&entry.scene, &entry.modelling), method, &grid)
    };
    let mut row: Run = match runner.attempt(|| run(&job)) {
        Ok(row) => row,
        Err(WorkError::Interrupted | WorkError::Error(RunError::Interrupted)) => return None,
        Err(WorkError::Error(RunError::Build(e))) => {
            return failed(Status::Refused, scene.locate_in(label, &e).to_text());
        }
        Err(WorkError::Error(e)) => return failed(Status::Refused, e.to_string()),
        Err(WorkError::Panic(why)) => return failed(Status::Aborted, why),
    };
    // An interruption ends a run early.
    if runner.is_interrupted() {
        return None;
    }
    row.end_s = Some(job.t_end);
    let finished = row.finished().ok().filter(|_| !row.status.is_failure());
    let metrics = finished
        .zip(target)
        .map(|(run, target)| compare(run, target, "yardstick"));
    row.metrics = metrics.into_iter().collect();
    let outputs = match row.status.is_failure() {
        true => vec![None; plan.outputs.len()],
        false => (plan.outputs.iter())
            .map(|o| o.of(&row).filter(|x| x.is_finite()))
            .collect(),
    };
    let remark = scene
        .odd
        .iter()
        .find(|odd| !plan.scene.odd.iter().any(|o| o.message() == odd.message()));
    let result = CellRun {
        status: row.status,
        outputs,
        message: (row.message.take())
            .or_else(|| remark.map(SceneError::to_text))
            .unwrap_or_default(),
        cpu_s: row.cost_s(),
    };
    let series = row.series.take().filter(|_| !row.status.is_failure());
    Some((result, series))
}

/// Writes the tables of finished cells into a folder.
///
/// # Errors
/// [`TableError`] when the folder cannot be written.
pub fn write_tables(
    plan: &Plan<'_>,
    folder: &Path,
    finished: FinishedCells,
) -> Result<(), TableError> {
    let configurations = plan.configurations();
    let mut writer = TableWriter::begin(folder, &header(&plan.design, &plan.output_keys()))?;
    for (begin, lane) in finished.0 {
        for (cell, runs) in (begin..).zip(lane) {
            writer.write(cell, &plan.design.texts(cell), &configurations, &runs)?;
        }
    }
    writer.commit()
}
