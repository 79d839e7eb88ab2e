//! Runs of the maps on several threads, and the record put together from their journal.

use super::cell::Reference;
use super::journal::{Journal, Line, Outcome};
use super::plan::{MapPlan, Plan};
use super::setup::Setup;
use crate::experiment::conditions::Progress;
use crate::experiment::error::StudyError;
use crate::experiment::parallel::{in_parallel, lock};
use crate::experiment::run::RunError;
use gearbench_models::scene::Scene;
use gearbench_reports::record::{Part, Results};
use gearbench_reports::stability::{Columns, Map, MapAxis, MapLine, StabilityRecord};
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

#[cfg(test)]
mod tests;

/// Runs that close in on the largest stable step of one map, at most.
const MOST_REFINED: usize = 24;

/// Wall time of a run by its name in the journal [s].
pub type Timings = Vec<(String, f64)>;

/// What a study needs beside its plan.
pub struct Means<'a> {
    /// Finished runs, with those of an earlier start.
    pub journal: Journal,
    pub threads: usize,
    /// Told the runs done, all that are known of, and the name of the last.
    pub progress: Progress<'a>,
}

/// A converged solution that at most one thread computes.
type Slot = Arc<Mutex<Option<Arc<Reference>>>>;

struct Work<'a> {
    plan: &'a Plan<'a>,
    journal: Mutex<Journal>,
    references: Mutex<HashMap<String, Slot>>,
    total: AtomicUsize,
    done: AtomicUsize,
    progress: Progress<'a>,
}

/// Name of a cell in the journal.
fn cell_key(map: usize, cell: usize) -> String {
    format!("m{map}/c{cell}")
}

/// Name of a run that closes in on a limit.
fn refined_key(map: usize, step: f64) -> String {
    format!("m{map}/h{step:e}")
}

/// Runs the study.
///
/// # Errors
/// [`StudyError`]; runs that fail are cells.
pub fn study(plan: &Plan<'_>, means: Means<'_>) -> Result<(Results, Timings), StudyError> {
    let Means {
        journal,
        threads,
        progress,
    } = means;
    let pending: Vec<(usize, usize)> = (plan.maps.iter().enumerate())
        .flat_map(|(m, map)| (0..map.len()).map(move |c| (m, c)))
        .filter(|(m, c)| journal.cell(&cell_key(*m, *c)).is_none())
        .collect();
    let work = Work {
        plan,
        total: AtomicUsize::new(plan.cells()),
        done: AtomicUsize::new(plan.cells() - pending.len()),
        journal: Mutex::new(journal),
        references: Mutex::new(HashMap::new()),
        progress,
    };
    work.tell("");
    reduce_once(plan)?;
    // Converged solutions first, each once: threads that share one would wait for each other.
    let mut needed: Vec<(usize, usize)> = Vec::new();
    for (m, c) in &pending {
        let at = (*m, c / plan.maps[*m].at.len());
        let key = |(m, row): (usize, usize)| plan.maps[m].reference_key(row);
        if !needed.iter().any(|other| key(*other) == key(at)) {
            needed.push(at);
        }
    }
    in_parallel(threads, &needed, |(m, row)| {
        work.reference(*m, *row).map(|_| ())
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
    let journal = work
        .journal
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    let mut timings = Timings::new();
    let maps = (0..plan.maps.len())
        .map(|m| {
            let mut map = assemble(plan, m, &journal, &mut timings);
            map.lines = lines.remove(&m).unwrap_or_default();
            map
        })
        .collect();
    Ok((
        Results {
            tolerance: Some(plan.tolerance.clone()),
            ..plan
                .conditions
                .record(Part::Stability(StabilityRecord { maps }))
        },
        timings,
    ))
}

/// Builds the gears that keep most modes first: reductions are kept in the process by what was asked for, and one with
/// more modes serves those with fewer.
fn reduce_once(plan: &Plan<'_>) -> Result<(), StudyError> {
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
            Scene::build(&setup.scene, &setup.modelling, plan.conditions.models)
                .map_err(RunError::from)?;
        }
    }
    Ok(())
}

fn setup(plan: &Plan<'_>, map: &MapPlan, row: usize) -> Result<Setup, StudyError> {
    plan.setup(map, row).map_err(|e| {
        let why = format!("{}: {e}", plan.entries[map.entry].label);
        StudyError::Scene(why, "leave the parameter out for this model")
    })
}

impl Work<'_> {
    fn tell(&self, what: &str) {
        (self.progress)(
            self.done.load(Ordering::Relaxed),
            self.total.load(Ordering::Relaxed),
            what,
        );
    }

    fn store(&self, key: String, outcome: Outcome, wall_s: f64) -> Result<(), StudyError> {
        let line = Line {
            key,
            outcome,
            wall_s,
        };
        Ok(lock(&self.journal).store(&line)?)
    }

    /// The converged solution of a row, computed by the first who asks.
    fn reference(&self, m: usize, row: usize) -> Result<Arc<Reference>, StudyError> {
        let map = &self.plan.maps[m];
        let key = map.reference_key(row);
        let slot = lock(&self.references)
            .entry(key.clone())
            .or_default()
            .clone();
        let mut slot = lock(&slot);
        if let Some(found) = &*slot {
            return Ok(found.clone());
        }
        let label = &self.plan.entries[map.entry].label;
        self.tell(&format!("{label}, converged solution"));
        let setup = setup(self.plan, map, row)?;
        let begin = Instant::now();
        let found = Arc::new(super::cell::reference(self.plan, map, &setup)?);
        *slot = Some(found.clone());
        if lock(&self.journal).get(&key).is_none() {
            let told = Outcome::Reference(found.told.clone());
            self.store(key, told, begin.elapsed().as_secs_f64())?;
        }
        Ok(found)
    }

    fn run(&self, m: usize, row: usize, at: f64, key: String) -> Result<(), StudyError> {
        let map = &self.plan.maps[m];
        let setup = setup(self.plan, map, row)?;
        let reference = self.reference(m, row)?;
        let (cell, wall) = super::cell::cell(self.plan, map, &setup, at, &reference)?;
        self.store(key, Outcome::Cell(cell), wall.as_secs_f64())?;
        self.done.fetch_add(1, Ordering::Relaxed);
        let label = &self.plan.entries[map.entry].label;
        self.tell(&format!("{label}, {}", map.method));
        Ok(())
    }

    fn cell(&self, m: usize, c: usize) -> Result<(), StudyError> {
        let map = &self.plan.maps[m];
        let (row, column) = (c / map.at.len(), c % map.at.len());
        self.run(m, row, map.at[column], cell_key(m, c))
    }

    /// Halves the distance, over the decades, between the largest stable step and the next that failed.
    fn refine(&self, m: usize) -> Result<(), StudyError> {
        for _ in 0..MOST_REFINED {
            let map = assemble(self.plan, m, &lock(&self.journal), &mut Timings::new());
            let Some(step) = map.limit().and_then(|l| l.next()) else {
                break;
            };
            let key = refined_key(m, step);
            if lock(&self.journal).cell(&key).is_none() {
                self.total.fetch_add(1, Ordering::Relaxed);
                self.run(m, self.plan.maps[m].own_row(), step, key)?;
            }
        }
        Ok(())
    }
}

/// A map as the journal has it, with the names and wall times of its runs in order.
fn assemble(plan: &Plan<'_>, m: usize, journal: &Journal, timings: &mut Timings) -> Map {
    let map = &plan.maps[m];
    let entry = &plan.entries[map.entry];
    let mut take = |key: String| {
        let cell = journal.cell(&key)?.clone();
        timings.push((key.clone(), journal.get(&key)?.wall_s));
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
            .filter_map(|c| take(cell_key(m, c)))
            .collect(),
        ..Map::default()
    };
    // The runs that closed in follow from each other: the first from the cells, each next from all before it.
    while map.columns == Columns::Step && found.cells.len() == map.len() {
        let Some(step) = found.limit().and_then(|l| l.next()) else {
            break;
        };
        let Some(cell) = take(refined_key(m, step)) else {
            break;
        };
        found.refined.push(cell);
    }
    found.references = (0..map.rows())
        .map(|row| {
            let key = map.reference_key(row);
            journal.reference(&key).cloned().unwrap_or_default()
        })
        .collect();
    found
}
