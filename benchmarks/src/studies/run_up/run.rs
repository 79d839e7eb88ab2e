//! Runs of the run-up study, one for each model.

use super::analysis::analyse;
use super::channels::ChannelLayout;
use super::drive::{RampError, run_up};
use super::plan::Plan;
use super::recorder::Recorder;
use crate::experiment::configuration::Configuration;
use crate::experiment::error::{ModelRefusal, StudyError};
use crate::experiment::run::{Job, RunError, run_with_observer};
use crate::experiment::runner::Runner;
use crate::studies::modes::{ModesSettings, vibrations};
use gearbench_integrators::SecondOrderSystem as _;
use gearbench_models::scene::Scene;
use gearbench_models::spec::SceneSpec;
use gearbench_reports::Part;
use gearbench_reports::modes::LinearisedState;
use gearbench_reports::record::{Results, Run};
use gearbench_reports::run_up::{ModelRunUp, NaturalFrequency, RunUpRecord};
use std::time::Instant;

/// Largest number of coordinates for which natural frequencies are cheap compared with the run.
const FEW: usize = 300;
/// Natural frequencies that are marked at most.
const MARKED: usize = 12;

/// Runs and evaluates the run-up of every model.
///
/// # Errors
/// [`StudyError`]; runs that fail are rows.
pub fn study(plan: &Plan, runner: &Runner<'_>) -> Result<Results, StudyError> {
    let (mut runs, mut run_ups) = (Vec::new(), Vec::new());
    for (done, entry) in plan.entries.iter().enumerate() {
        runner.report_progress(done, plan.entries.len(), &entry.label);
        let made = one(plan, runner, entry);
        let (row, found) = match made.as_ref().err().and_then(ModelRefusal::refusal) {
            Some(message) => (
                entry.refused(message.clone()),
                ModelRunUp {
                    label: entry.model_label(),
                    message,
                    ..ModelRunUp::default()
                },
            ),
            None => made?,
        };
        runs.push(row);
        run_ups.push(found);
    }
    runner.report_progress(plan.entries.len(), plan.entries.len(), "report");
    Ok(Results {
        runs,
        ..plan.conditions.record(Part::RunUp(RunUpRecord { run_ups }))
    })
}

/// The scene that a model runs.
fn scene_of(plan: &Plan, entry: &Configuration) -> Result<SceneSpec, StudyError> {
    let Some(ramp) = &plan.ramp else {
        return Ok(entry.scene.clone());
    };
    let scene = (&entry.scene, &entry.modelling);
    let made = run_up(scene, &plan.conditions.context.models, plan.look.gear, ramp);
    let made = made.map_err(RunError::from)?;
    made.map_err(|RampError(why, way_out)| StudyError::Scene(why, way_out))
}

fn one(
    plan: &Plan,
    runner: &Runner<'_>,
    entry: &Configuration,
) -> Result<(Run, ModelRunUp), StudyError> {
    let spec = scene_of(plan, entry)?;
    let own = entry.methods.as_ref().and_then(|m| m.first());
    let method = own.unwrap_or(&plan.method);
    let grid = plan.conditions.grid();
    let job = Job {
        also_steps: false,
        repeats: 0,
        ..(plan.conditions).job((&spec, &entry.modelling), method, &grid)
    };
    let key = job.key().and(&plan.look);
    let made = runner.row_with(key, method, || {
        let started = Instant::now();
        let mut scene = job.assemble().map_err(RunError::from)?;
        let recorded = ChannelLayout::of(&spec);
        let range = [plan.look.onset, job.t_end];
        let mut recorder = Recorder::new(recorded.channels(&scene), range, plan.look.samples);
        let mut row = run_with_observer(&job, &mut scene, started.elapsed(), &mut recorder)?;
        let mut found = match row.status.is_failure() {
            true => Err(row.message.clone().unwrap_or_default()),
            false => analyse(
                &spec,
                &recorded,
                &recorder,
                (&plan.look, plan.ramp.as_ref()),
            ),
        }
        .unwrap_or_else(|message| ModelRunUp {
            message,
            ..ModelRunUp::default()
        });
        found.label = entry.model_label();
        found.natural = natural(plan, (entry, &spec), &found)?;
        // The report shows the windows only, so histories are not stored.
        (row.contacts, row.series) = (None, None);
        Ok::<_, StudyError>((row, found))
    });
    let (mut row, mut found) = made?;
    entry.sign(&mut row);
    if found.label.is_empty() {
        found.label = entry.model_label();
        found.message = row.message.clone().unwrap_or_default();
    }
    Ok((row, found))
}

/// Natural frequencies of the scene under its loads, within what is shown.
fn natural(
    plan: &Plan,
    (entry, spec): (&Configuration, &SceneSpec),
    found: &ModelRunUp,
) -> Result<Vec<NaturalFrequency>, StudyError> {
    let Some(top) = found.by_time.lines.last() else {
        return Ok(Vec::new());
    };
    let scene = (spec, &entry.modelling);
    let models = &*plan.conditions.context.models;
    let built = Scene::build(spec, &entry.modelling, models).map_err(RunError::from)?;
    if built.layout().n > FEW {
        return Ok(Vec::new());
    }
    let wanted = ModesSettings {
        most: MARKED,
        up_to: *top,
        ..ModesSettings::default()
    };
    let modes = vibrations(&entry.label, scene, models, &wanted).map_err(RunError::from)?;
    if !matches!(
        modes.about,
        LinearisedState::Loaded | LinearisedState::Preloaded
    ) {
        return Ok(Vec::new());
    }
    let swings = modes.modes.into_iter().filter(|m| m.frequency_hz > 0.0);
    Ok(swings
        .map(|m| NaturalFrequency {
            frequency_hz: m.frequency_hz,
            name: m.name,
        })
        .collect())
}
