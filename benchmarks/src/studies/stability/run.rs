//! Runs of the maps on several threads, and the record put together from them.

use super::cell::Reference;
use super::plan::{MapPlan, Plan};
use super::setup::Setup;
use crate::experiment::error::StudyError;
use crate::experiment::key::Key;
use crate::experiment::linear_models::mesh_modes;
use crate::experiment::parallel::{in_parallel, lock};
use crate::experiment::run::RunError;
use crate::experiment::runner::Runner;
use gearbench_models::scene::Scene;
use gearbench_reports::record::{Part, Results, Status};
use gearbench_reports::stability::{Cell, Columns, Map, MapAxis, MapLine, StabilityRecord};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

#[cfg(test)]
mod tests;

/// Runs that close in on the largest stable step of one map, at most.
const MOST_REFINED: usize = 24;

/// Wall time of a run by its name [s].
pub type Timings = Vec<(String, f64)>;

/// A finished run with its wall time.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct FinishedRun {
    cell: Cell,
    /// Wall time [s]: the only part that differs when the run is made again.
    wall_s: f64,
}

/// A converged solution that at most one thread computes.
type ReferenceSlot = Arc<Mutex<Option<Arc<Reference>>>>;

struct StudyState<'a> {
    plan: &'a Plan,
    runner: &'a Runner<'a>,
    /// Finished runs by the name of their cell.
    done: Mutex<HashMap<String, FinishedRun>>,
    references: Mutex<HashMap<Key, ReferenceSlot>>,
    total: AtomicUsize,
}

/// Returns the name of a cell of a map.
fn cell_name(map: usize, cell: usize) -> String {
    format!("m{map}/c{cell}")
}

/// Name of a run that closes in on a limit.
fn refined_name(map: usize, step: f64) -> String {
    format!("m{map}/h{step:e}")
}

/// Runs the maps of the study on several threads.
///
/// # Errors
/// [`StudyError`]; runs that fail are cells.
pub fn study(
    plan: &Plan,
    runner: &Runner<'_>,
    threads: usize,
) -> Result<(Results, Timings), StudyError> {
    let work = StudyState {
        plan,
        runner,
        done: Mutex::default(),
        references: Mutex::default(),
        total: AtomicUsize::new(plan.cells()),
    };
    let mut pending: Vec<(usize, usize)> = Vec::new();
    for (m, map) in plan.maps.iter().enumerate() {
        for c in 0..map.len() {
            let (row, at) = (c / map.at.len(), map.at[c % map.at.len()]);
            let setup = setup(plan, map, row)?;
            match runner.finished(run_key(plan, map, &setup, at))? {
                Some(done) => work.store(cell_name(m, c), done),
                None => pending.push((m, c)),
            }
        }
    }
    work.report_progress("");
    reduce_once(plan)?;
    // Converged solutions first, each once: threads that share one would wait for each other.
    let mut needed: Vec<(Key, usize, usize)> = Vec::new();
    for (m, c) in &pending {
        let (map, row) = (&plan.maps[*m], c / plan.maps[*m].at.len());
        let key = reference_key(plan, map, &setup(plan, map, row)?);
        if !needed.iter().any(|(other, ..)| *other == key) {
            needed.push((key, *m, row));
        }
    }
    in_parallel(threads, &needed, |(_, m, row)| {
        if runner.is_interrupted() {
            return Ok(());
        }
        work.reference(*m, *row).map(|_| ())
    })
    .or_else(|e| match runner.is_interrupted() {
        // The runs concerned are cells that were not computed.
        true => Ok(()),
        false => Err(e),
    })?;
    in_parallel(threads, &pending, |(m, c)| work.cell(*m, *c))?;
    if plan.refine {
        let all: Vec<usize> = (0..plan.maps.len()).collect();
        in_parallel(threads, &all, |m| work.refine(*m))?;
    }
    let lines: Mutex<HashMap<usize, Vec<MapLine>>> = Mutex::new(HashMap::new());
    in_parallel(threads, &super::theory::shared(plan), |maps| {
        let found = super::theory::lines(plan, maps);
        lock(&lines).extend(found);
        Ok::<(), StudyError>(())
    })?;
    let mut lines = lines.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut timings = Timings::new();
    let mut maps = Vec::new();
    for m in 0..plan.maps.len() {
        let mut map = work.assemble(m, &mut timings);
        map.lines = lines.remove(&m).unwrap_or_default();
        for row in 0..plan.maps[m].rows() {
            let setup = setup(plan, &plan.maps[m], row)?;
            let key = reference_key(plan, &plan.maps[m], &setup);
            map.references.push(work.converged_description(key)?);
        }
        maps.push(map);
    }
    Ok((
        Results {
            tolerance: Some(plan.tolerance.clone()),
            mesh_modes: mesh_modes(&plan.entries, &plan.conditions.context.models, runner, true)?,
            ..plan
                .conditions
                .record(Part::Stability(StabilityRecord { maps }))
        },
        timings,
    ))
}

/// Name of what a run and its converged solution depend on.
fn key(kind: &str, plan: &Plan, map: &MapPlan, setup: &Setup) -> Key {
    let conditions = &plan.conditions;
    Key::new(kind)
        .and_scene(&setup.scene, &setup.modelling)
        .and(&(map.duration, map.max_steps, conditions.timeout))
        .and(&(conditions.samples, conditions.events, &plan.tolerance))
}

/// Name of a converged solution: rows that differ in parameters of the integrator alone share it, and so do all
/// integrators of a model.
fn reference_key(plan: &Plan, map: &MapPlan, setup: &Setup) -> Key {
    key("converged solution", plan, map, setup)
}

/// Name of a run at a step or tolerance.
fn run_key(plan: &Plan, map: &MapPlan, setup: &Setup, at: f64) -> Key {
    key("cell", plan, map, setup).and(&(setup.method.to_string(), map.columns, at))
}

/// Builds the gears with most modes first: reductions stay in the process, and one with more modes serves those with
/// fewer.
fn reduce_once(plan: &Plan) -> Result<(), StudyError> {
    let mut seen: Vec<(usize, usize)> = Vec::new();
    for map in &plan.maps {
        if seen.contains(&(map.set, map.entry)) {
            continue;
        }
        seen.push((map.set, map.entry));
        let places = |row: &usize| map.values(*row).iter().map(|v| v.1).sum::<f64>();
        let last = (0..map.rows()).max_by(|a, b| places(a).total_cmp(&places(b)));
        for row in last.into_iter().chain([0]) {
            let setup = setup(plan, map, row)?;
            Scene::build(
                &setup.scene,
                &setup.modelling,
                &plan.conditions.context.models,
            )
            .map_err(RunError::from)?;
        }
    }
    Ok(())
}

fn setup(plan: &Plan, map: &MapPlan, row: usize) -> Result<Setup, StudyError> {
    plan.setup(map, row).map_err(|e| {
        let why = format!("{}: {e}", plan.entries[map.entry].label);
        StudyError::Scene(why, "leave the parameter out for this model")
    })
}

impl StudyState<'_> {
    fn report_progress(&self, what: &str) {
        let done = lock(&self.done).len();
        (self.runner).report_progress(done, self.total.load(Ordering::Relaxed), what);
    }

    fn store(&self, name: String, done: FinishedRun) {
        lock(&self.done).insert(name, done);
    }

    /// Returns the converged solution of a row; the first thread that needs it computes it.
    fn reference(&self, m: usize, row: usize) -> Result<Arc<Reference>, StudyError> {
        let map = &self.plan.maps[m];
        let setup = setup(self.plan, map, row)?;
        let key = reference_key(self.plan, map, &setup);
        let slot = lock(&self.references).entry(key).or_default().clone();
        let mut slot = lock(&slot);
        if let Some(found) = &*slot {
            return Ok(found.clone());
        }
        let label = &self.plan.entries[map.entry].label;
        self.report_progress(&format!("{label}, converged solution"));
        let found: Reference = (self.runner).piece(key, || {
            super::cell::reference(self.plan, map, &setup).map_err(StudyError::from)
        })?;
        Ok(slot.insert(Arc::new(found)).clone())
    }

    /// Returns the description of a converged solution; empty if an interruption prevented its computation.
    fn converged_description(
        &self,
        key: Key,
    ) -> Result<gearbench_reports::stability::SelfReference, StudyError> {
        let slot = lock(&self.references).get(&key).cloned();
        if let Some(found) = slot.and_then(|slot| lock(&slot).clone()) {
            return Ok(found.told.clone());
        }
        let kept: Option<Reference> = self.runner.finished(key)?;
        Ok(kept.map(|r| r.told).unwrap_or_default())
    }

    fn run(&self, m: usize, row: usize, at: f64, name: String) -> Result<(), StudyError> {
        let map = &self.plan.maps[m];
        let setup = setup(self.plan, map, row)?;
        let made = if self.runner.is_interrupted() {
            Err(StudyError::Run(RunError::Interrupted))
        } else {
            (self.runner).piece(run_key(self.plan, map, &setup, at), || {
                let reference = self.reference(m, row)?;
                let (cell, wall) = super::cell::cell(self.plan, map, &setup, at, &reference)?;
                let wall_s = wall.as_secs_f64();
                Ok(FinishedRun { cell, wall_s })
            })
        };
        let done = match made {
            Err(_) if self.runner.is_interrupted() => FinishedRun {
                cell: Cell {
                    at,
                    status: Status::Interrupted,
                    message: Some("not run: the study was interrupted".into()),
                    ..Cell::default()
                },
                wall_s: 0.0,
            },
            made => made?,
        };
        self.store(name, done);
        let label = &self.plan.entries[map.entry].label;
        self.report_progress(&format!("{label}, {}", map.method));
        Ok(())
    }

    fn cell(&self, m: usize, c: usize) -> Result<(), StudyError> {
        let map = &self.plan.maps[m];
        let (row, column) = (c / map.at.len(), c % map.at.len());
        self.run(m, row, map.at[column], cell_name(m, c))
    }

    /// Halves the distance, over the decades, between the largest stable step and the next that failed.
    fn refine(&self, m: usize) -> Result<(), StudyError> {
        for _ in 0..MOST_REFINED {
            let map = self.assemble(m, &mut Timings::new());
            let next = map.limit().and_then(|l| l.next());
            let Some(step) = next.filter(|_| !self.runner.is_interrupted()) else {
                break;
            };
            self.total.fetch_add(1, Ordering::Relaxed);
            let own = self.plan.maps[m].own_row();
            self.run(m, own, step, refined_name(m, step))?;
        }
        Ok(())
    }

    /// A map of the finished runs, with their names and wall times in order; without its converged solutions.
    fn assemble(&self, m: usize, timings: &mut Timings) -> Map {
        let map = &self.plan.maps[m];
        let entry = &self.plan.entries[map.entry];
        let done = lock(&self.done);
        let mut take = |name: String| {
            let FinishedRun { cell, wall_s } = done.get(&name)?.clone();
            timings.push((name, wall_s));
            Some(cell)
        };
        let mut found = Map {
            set: map.set,
            model: entry.model.clone(),
            variant: entry.variant(),
            integrator: map.method.to_string(),
            implicit: map.implicit,
            duration_s: map.duration,
            columns: map.columns,
            at: map.at.clone(),
            axes: (map.axes.iter())
                .map(|a| MapAxis {
                    id: a.axis.id().into(),
                    name: a.axis.name().into(),
                    unit: a.axis.unit().into(),
                    values: a.values.clone(),
                    own: a.own,
                })
                .collect(),
            cells: (0..map.len())
                .filter_map(|c| take(cell_name(m, c)))
                .collect(),
            ..Map::default()
        };
        // The runs that closed in follow from each other: the first from the cells, each next from all before it.
        while map.columns == Columns::Step && found.cells.len() == map.len() {
            let Some(step) = found.limit().and_then(|l| l.next()) else {
                break;
            };
            let Some(cell) = take(refined_name(m, step)) else {
                break;
            };
            found.refined.push(cell);
        }
        found
    }
}
