//! Runs of a sweep over the speed, branch by branch.

use super::end_state::EndState;
use super::pair::Pair;
use super::plan::Plan;
use super::steady::{Histories, measure};
use crate::experiment::configuration::Configuration;
use crate::experiment::error::{ModelRefusal, StudyError};
use crate::experiment::key::Key;
use crate::experiment::linear_models::mesh_modes;
use crate::experiment::run::{Job, RunError, run_from};
use crate::experiment::runner::Runner;
use crate::small_signals;
use crate::small_signals::mesh_mode::{FEW, resonances};
use gearbench_integrators::Scheme;
use gearbench_models::gear::table::properties_of;
use gearbench_models::scene::Scene;
use gearbench_models::spec::SceneSpec;
use gearbench_reference::statics::{Load as StaticLoad, LoadedPair, MeshCycle};
use gearbench_reports::Part;
use gearbench_reports::record::{self, Results, Run, StaticCycle, Status};
use gearbench_reports::series::{SPEED, TimeSeries};
use gearbench_reports::sweep::{Branch, SweepRecord};
use std::time::Instant;

#[cfg(test)]
mod tests;

/// Samples of a mesh cycle in the histories at least, twice those that are measured.
const SAMPLES: f64 = 256.0;
/// Samples of a period of the mesh resonance at least: what the gears do by themselves within a slow mesh cycle.
const OF_RESONANCE: f64 = 16.0;
/// Samples of a mesh cycle at most.
const MOST_SAMPLES: f64 = 65_536.0;
/// Part of the settling time in which the loads rise.
const RISE: f64 = 1.0 / 3.0;
/// Parts of the settling time, after each of which the speed of free gears is brought back.
const GOVERNED: usize = 3;
/// Mesh cycles of settling at least.
const LEAST_CYCLES: f64 = 4.0;
/// Ratio of the non-periodic to the periodic part beyond which a run counts as unsettled [-].
const UNSETTLED: f64 = 0.2;

impl Pair {
    /// Evaluates the steady state of a run.
    fn steady(
        &self,
        gears: [(&str, bool); 2],
        series: &TimeSeries,
        counts: [usize; 2],
    ) -> Option<record::Steady> {
        let column = |name: String| series.column(&name);
        let displacement = |k: usize| column(format!("hub_angle_{}_rad", gears[k].0));
        let (first, second) = (displacement(0)?, displacement(1)?);
        let [ra, rb] = self.base_radii;
        let error: Vec<f64> = (first.iter().zip(second))
            .map(|(a, b)| self.sign * (ra * a + rb * b))
            .collect();
        let pitch = self.layout.base_pitch;
        let position: Vec<f64> = (second.iter())
            .map(|b| (self.start - self.sign * rb * b - self.layout.pitch_point) / pitch)
            .collect();
        let bearings = gears
            .iter()
            .filter_map(|(name, vibrates)| {
                let own = |d: &str| column(format!("bearing_{name}_{d}_n"));
                let (x, y, inertia) = match (own("x"), own("y")) {
                    (Some(x), Some(y)) => (x, y, *vibrates),
                    _ => {
                        let (mesh, _) = series.most_loaded_mesh()?;
                        let of_mesh = |d: &str| column(format!("force_{d}_{mesh}_n"));
                        (of_mesh("x")?, of_mesh("y")?, false)
                    }
                };
                Some(((*name).to_string(), inertia, x, y))
            })
            .collect();
        measure(
            &Histories {
                time: &series.time_s,
                position: &position,
                error: &error,
                force: series.contact_force(),
                pieces: series.forces.first(),
                gears: [0, 1].map(|k| (gears[k].0, self.teeth[k])),
                speed: series.of(SPEED, gears[0].0)?,
                bearings,
            },
            counts,
        )
    }
}

/// Equilibria over one base pitch under the force of the loads.
fn static_cycle(plan: &Plan, entry: &Configuration) -> Result<StaticCycle, StudyError> {
    let fail = |e| StudyError::Statics(entry.label.clone(), e);
    let pair = Pair::of_entry(plan, entry)?;
    let mut loaded = LoadedPair::new(
        &entry.scene,
        &entry.modelling,
        &plan.conditions.context.models,
    )
    .map_err(fail)?;
    // What a viscous load adds at speed is not there at rest: the limit is that of the slowest speed.
    let slowest = plan.frequencies.iter().copied().reduce(f64::min);
    let force = slowest.map_or_else(|| pair.own_force(), |f| pair.force(f));
    let load = StaticLoad::Force(force);
    let cycle = MeshCycle::solve(&mut loaded, load, plan.positions, |_| {}).map_err(fail)?;
    let tangent = cycle.mesh_tangent() * cycle.face_width;
    let spec = small_signals::settled(&entry.scene);
    let resonance = (Scene::build(&spec, &entry.modelling, &plan.conditions.context.models).ok())
        .and_then(|mut scene| resonances(&mut scene, &spec, FEW).into_iter().next());
    Ok(StaticCycle {
        label: entry.model_label(),
        force_n: force,
        position: (cycle.positions.iter())
            .map(|p| (p.s - cycle.pitch_point) / cycle.base_pitch)
            .collect(),
        error_m: cycle.positions.iter().map(|p| p.approach).collect(),
        error_mean_m: cycle.mean_error(),
        error_peak_to_peak_m: cycle.peak_to_peak(),
        tangent_n_per_m: tangent,
        resonance_hz: resonance.map(|r| r.frequency),
        resonance_range_hz: resonance.map(|r| r.range),
    })
}

/// Checks that a scene can be swept, before any of its models is built.
///
/// # Errors
/// [`StudyError`] when it is no loaded pair.
pub fn check(name: &str, spec: &SceneSpec) -> Result<(), StudyError> {
    Pair::in_scene(name, spec).map(|_| ())
}

/// Computes the mesh resonance of a model at the loads of its scene [Hz], for the choice of speeds.
///
/// # Errors
/// [`StudyError`] when there is no static contact.
pub fn mesh_resonance(plan: &Plan, entry: &Configuration) -> Result<Option<f64>, StudyError> {
    Ok(static_cycle(plan, entry)?.resonance_hz)
}

/// Runs all models at all mesh frequencies, branch by branch.
///
/// # Errors
/// [`StudyError`] when the scene is no loaded pair, a model cannot be built, or the user interrupts. Runs that fail
/// are rows.
pub fn sweep(plan: &Plan, runner: &Runner<'_>) -> Result<Results, StudyError> {
    let (mut statics, mut refused) = (Vec::new(), Vec::new());
    let total = plan.count();
    let ends = [0, plan.frequencies.len().saturating_sub(1)].map(|i| plan.frequencies.get(i));
    for entry in plan.entries.iter().chain(&plan.standing) {
        runner.report_progress(0, total, &format!("{}, at rest", entry.label));
        let pair = Pair::of_entry(plan, entry)?;
        pair.check_speeds(&plan.conditions.name, ends.into_iter().flatten().copied())?;
        let key = Key::new("static cycle")
            .and_scene(&entry.scene, &entry.modelling)
            .and(&(plan.positions, ends));
        let found = runner.piece(key, || static_cycle(plan, entry));
        match found.as_ref().err().and_then(ModelRefusal::refusal) {
            Some(why) => refused.push(entry.refused(why)),
            None => statics.push(found?),
        }
    }
    let mut runs = Vec::new();
    for entry in &plan.entries {
        let own = |s: &&StaticCycle| s.label == entry.model_label();
        let Some(statics) = statics.iter().find(own) else {
            continue;
        };
        let branch = Branches {
            plan,
            runner,
            entry,
            pair: Pair::of_entry(plan, entry)?,
            method: (entry.methods.as_ref())
                .and_then(|m| m.first())
                .unwrap_or(&plan.method),
            resonance: statics.resonance_hz.unwrap_or(0.0),
            total,
        };
        // The way down begins where the way up ended.
        let mut turned = None;
        for &way in &plan.branches {
            let top = branch.run(
                way,
                turned.take().filter(|_| way == Branch::Down),
                &mut runs,
            )?;
            turned = top.filter(|_| way == Branch::Up);
        }
    }
    runner.report_progress(runs.len(), total, "report");
    runs.extend(refused);
    let entries = plan.entries.iter().chain(&plan.standing);
    let mesh_modes = mesh_modes(entries, &plan.conditions.context.models, runner, true)?;
    Ok(Results {
        mesh_modes,
        runs,
        ..plan.conditions.record(Part::Sweep(SweepRecord { statics }))
    })
}

/// The runs of a model.
struct Branches<'a> {
    plan: &'a Plan,
    runner: &'a Runner<'a>,
    entry: &'a Configuration,
    pair: Pair,
    method: &'a Scheme,
    /// Mesh resonance from the static cycle [Hz].
    resonance: f64,
    total: usize,
}

impl Branches<'_> {
    /// Runs all speeds of a branch from the end state of the branch before, and returns the end state at the last
    /// speed.
    fn run(
        &self,
        branch: Branch,
        mut from: Option<EndState>,
        runs: &mut Vec<Run>,
    ) -> Result<Option<EndState>, StudyError> {
        let mut frequencies = self.plan.frequencies.clone();
        if branch == Branch::Down {
            frequencies.reverse();
        }
        for frequency in frequencies {
            let what = format!(
                "{}, {branch}, mesh frequency {frequency:.0} Hz",
                self.entry.label
            );
            self.runner.report_progress(runs.len(), self.total, &what);
            let (row, end) = self.one(branch, frequency, from.as_ref())?;
            runs.push(row);
            // A run that failed leaves nothing: the branch goes on from the last that did.
            if branch != Branch::Fresh {
                from = end.or(from);
            }
        }
        Ok(from)
    }

    fn one(
        &self,
        branch: Branch,
        frequency: f64,
        from: Option<&EndState>,
    ) -> Result<(Run, Option<EndState>), StudyError> {
        let Branches {
            plan, entry, pair, ..
        } = self;
        let period = frequency.recip();
        let begin = from.map_or(0.0, EndState::time);
        // Whole cycles, because the common rotation oscillates within each.
        let settle = (plan.settle / period).max(LEAST_CYCLES).ceil() * period;
        let measured = begin + settle;
        // One cycle more: whole cycles begin where a pair's do.
        let t_end = measured + (plan.cycles as f64 + 1.2) * period;
        let scene = pair.scene(&entry.scene, frequency, RISE * settle, from);
        let per_cycle = (2.0 * OF_RESONANCE * self.resonance * period).clamp(SAMPLES, MOST_SAMPLES);
        let per_cycle = per_cycle.log2().ceil().exp2();
        let count = (per_cycle * (t_end - measured) / period).ceil();
        let grid: Vec<f64> = (0..=count as usize)
            .map(|i| measured + (t_end - measured) * i as f64 / count)
            .collect();
        let job = Job {
            t_end,
            also_steps: false,
            forces: true,
            repeats: 0,
            ..plan
                .conditions
                .job((&scene, &entry.modelling), self.method, &grid)
        };
        let key = job.key().and(&(plan.cycles, branch, from, GOVERNED));
        let made = self.runner.row_with(key, self.method, || {
            let build = |spec: &SceneSpec| {
                let models = &*plan.conditions.context.models;
                Scene::build(spec, &entry.modelling, models).map_err(RunError::from)
            };
            let mut started = Instant::now();
            let mut built = build(&scene)?;
            let mut state = pair.start(&built, frequency, from);
            let mut drive = from.map_or(0.0, EndState::drive);
            // What a part of the settling loses is given to the next, and the lost speed back.
            let parts = if pair.is_free() { GOVERNED } else { 0 };
            let mut spent = Run::default();
            for part in 1..=parts {
                let spec = pair.driven_by(&scene, &built, drive);
                let mut settling = build(&spec)?;
                // None ends where the loads have risen: no step would be left before that kink.
                let part = RISE + (1.0 - RISE) * part as f64 / parts as f64;
                let until = begin + (settle * part / period).round() * period;
                let job = Job {
                    t_end: until,
                    grid: &[until - period, until],
                    forces: false,
                    scene: &spec,
                    ..job
                };
                let since = state.t;
                let row = run_from(&job, &mut settling, &mut state, started.elapsed())?;
                if row.status.is_failure() {
                    let way = (branch, frequency, settle, 0);
                    return Ok::<_, StudyError>((settled(plan, entry, pair, way, row), None));
                }
                let turned = angles(&row, &entry.scene);
                let off = pair.correct_speed(&settling, &mut state, frequency, turned, period);
                drive -= off / (until - since);
                spent.steps += row.steps;
                spent.wall_s = spent.wall_s.max(0.0) + row.wall_s;
                started = Instant::now();
            }
            let spec = pair.driven_by(&scene, &built, drive);
            if parts > 0 {
                built = build(&spec)?;
            }
            let job = Job {
                scene: &spec,
                ..job
            };
            let mut row = run_from(&job, &mut built, &mut state, started.elapsed())?;
            row.steps += spent.steps;
            row.wall_s += spent.wall_s.max(0.0);
            row.simulated_s -= begin;
            row.end_s = row.end_s.map(|t| t - begin);
            let whole = !row.status.is_failure();
            let end = whole
                .then(|| EndState::of(&state, &spec, frequency, drive))
                .flatten();
            let per_cycle = (0.5 * per_cycle) as usize;
            let way = (branch, frequency, settle, per_cycle);
            Ok::<_, StudyError>((settled(plan, entry, pair, way, row), end))
        });
        let (mut row, end) = made?;
        entry.sign(&mut row);
        Ok((row, end))
    }
}

/// Angles of both hubs [rad] at the first and the last time of a run's histories.
fn angles(row: &Run, scene: &SceneSpec) -> [[f64; 2]; 2] {
    let at = |end: fn(&[f64]) -> Option<&f64>| {
        [0, 1].map(|i| {
            let name = format!("hub_angle_{}_rad", scene.gears[i].name);
            let columns = row.series.iter().flat_map(|s| &s.columns);
            let column = columns.into_iter().find(|c| c.name == name);
            column.and_then(|c| end(&c.values)).copied().unwrap_or(0.0)
        })
    };
    [at(|x| x.first()), at(|x| x.last())]
}

/// The row of a run with what it settled to in place of its histories.
fn settled(
    plan: &Plan,
    entry: &Configuration,
    pair: &Pair,
    (branch, frequency, settle, per_cycle): (Branch, f64, f64, usize),
    mut row: Run,
) -> Run {
    row.contacts = None;
    // Rigid gears hand the contact force on; others have inertia of their own vibration.
    let gears = [0, 1].map(|i| {
        let vibrates = !properties_of(
            &plan.conditions.context.models,
            entry.modelling.gears[i].id(),
        )
        .rigid;
        (entry.scene.gears[i].name.as_str(), vibrates)
    });
    let series = row.series.take().unwrap_or_default();
    match pair.steady(gears, &series, [plan.cycles, per_cycle]) {
        Some(mut steady) if !row.status.is_failure() => {
            if steady.irregular > UNSETTLED {
                row.status = Status::Inaccurate;
                row.message = Some(format!(
                    "{:.0} % of the transmission error at a mesh frequency of {frequency:.0} Hz differs from cycle to cycle: the motion is subharmonic, or not steady after {:.1} ms",
                    100.0 * steady.irregular,
                    1e3 * settle
                ));
            }
            steady.branch = branch;
            row.steady = Some(steady);
        }
        // The place on the axis, for the failures.
        _ => {
            if !row.status.is_failure() {
                row.status = Status::Timeout;
                row.message = Some("too few whole mesh cycles to measure".into());
            }
            row.steady = Some(record::Steady {
                branch,
                mesh_frequency_hz: frequency,
                ..record::Steady::default()
            });
        }
    }
    row
}
