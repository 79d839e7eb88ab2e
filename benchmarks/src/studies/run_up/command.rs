//! `gearbench run-up SCENE`: orders and spectra over the speed.

use super::arguments::RunUp;
use super::plan::{EvaluationSettings, Plan, Ramp};
use super::run::study;
use super::summary::summarise;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_study};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::run::LEFT_OUT;
use crate::experiment::run::NO_BOUND;
use crate::experiment::settings::settings;
use crate::scene_file::{self, ModelChoice, SceneError, SceneFile, Selection};
use gearbench_integrators::table::VELOCITY_VERLET;
use gearbench_models::spec::{Body, Mount};
use gearbench_reports::Study;
use gearbench_reports::record::Results;
use std::time::Duration;

/// Default part of the run before the start of the evaluation.
const BEFORE: f64 = 0.02;

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &RunUp, command: &str) -> Result<CommandResult, Refusal> {
    let scene = scene_file::load_for(
        context,
        &args.scene,
        Selection::Labels(args.models.as_deref()),
    )?;
    let choices = scene.select(args.models.as_deref())?;
    // Full finite elements need hours for the revolutions of a run-up.
    let full = |c: &&ModelChoice| scene.properties_of(&c.model).full_order;
    let (left, taken): (Vec<&ModelChoice>, Vec<&ModelChoice>) = choices.into_iter().partition(full);
    if let Some(choice) = left.first().filter(|_| taken.is_empty()) {
        let why = format!("a run-up of `{}` would take hours", choice.label);
        let way_out = "use rigid gears, movable teeth or elastic gears with few modes";
        return Err(SceneError::plain(why, way_out).into());
    }
    let ramp = match (args.from, args.to) {
        (Some(from), Some(to)) => Some(Ramp {
            from,
            to,
            over: args.over.unwrap_or(scene.duration),
        }),
        _ => None,
    };
    let duration = ramp.map_or(scene.duration, |r| r.over);
    let look = EvaluationSettings {
        gear: gear_of(&scene, args.gear.as_deref())?,
        multiples: args.multiples as usize,
        turns: args.turns,
        onset: args.onset.unwrap_or(BEFORE * duration),
        samples: args.samples as usize,
    };
    if look.onset >= duration {
        let why = format!(
            "the onset at {} s is after the end of the run at {duration} s",
            look.onset
        );
        return Err(SceneError::plain(why, "give an earlier --onset").into());
    }
    let mut told = settings(&scene, &taken, false);
    told.extend(left.iter().map(|c| {
        let why = format!("{}: a run-up of full finite elements takes hours", c.label);
        (LEFT_OUT.to_owned(), why)
    }));
    if let Some(Ramp { from, to, over }) = &ramp {
        let gear = &scene.spec.gears[look.gear].name;
        let what = format!("{gear} from {from} to {to} rad/s over {over} s");
        told.push(("run-up".into(), what));
    }
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: told,
            duration,
            repeats: 0,
            timeout: args.timeout.map_or(NO_BOUND, Duration::from_secs_f64),
            ..Conditions::of(&scene)
        },
        entries: taken.iter().map(|c| Configuration::of(&scene, c)).collect(),
        method: (scene.study.integrators.first().cloned()).unwrap_or(VELOCITY_VERLET.at_step(2e-7)),
        ramp,
        look,
    };
    let mut folder = StudyFolder::of(&args.output, &scene, Study::RunUp.as_str())?;
    let made = folder.run(plan.entries.len(), |runner| study(&plan, runner));
    let results = made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?;
    folder.finish(results, ended, summarise)
}

/// Returns the index of the reference gear.
fn gear_of(scene: &SceneFile, asked: Option<&str>) -> Result<usize, SceneError> {
    let turns = |g: &gearbench_models::spec::GearSpec| {
        matches!(g.body, Body::Gear(_)) && !matches!(g.mount, Mount::Fixed)
    };
    let gears = &scene.spec.gears;
    let names = || {
        let turning = gears.iter().filter(|g| turns(g));
        let names: Vec<&str> = turning.map(|g| g.name.as_str()).collect();
        names.join(", ")
    };
    let found = match asked {
        Some(name) => gears.iter().position(|g| g.name == name && turns(g)),
        None => gears.iter().position(turns),
    };
    found.ok_or_else(|| match asked {
        Some(name) => SceneError::plain(
            format!("the scene `{}` has no rotating gear `{name}`", scene.name),
            format!("the rotating gears are {}", names()),
        ),
        None => SceneError::plain(
            format!("no gear of the scene `{}` rotates", scene.name),
            "a run-up needs a rotating gear",
        ),
    })
}

/// Returns the exit code; a run without evaluation counts as failed.
fn ended(results: &Results) -> Exit {
    match results.run_ups().iter().any(|r| !r.message.is_empty()) {
        true => Exit::FailedRun,
        false => Exit::of_every_run(results),
    }
}
