//! `gearbench coupling SCENE`: the hubs of the gears in a host, over the communication step.

use super::arguments::Coupling;
use super::frames::frames;
use super::plan::{ALLOWED, Entry, Plan, default_steps, keeps_residual, truncated};
use super::run::study;
use super::stiffness::oscillator;
use super::summary::summarise;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_run, refuse_study};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::parallel::thread_count;
use crate::experiment::run::{LEFT_OUT, RunError};
use crate::experiment::settings::settings;
use crate::scene_file::{self, ModelChoice, SceneError, SceneFile, Selection};
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_integrators::table::{RK4, VELOCITY_VERLET};
use gearbench_integrators::{Resolution, Scheme};
use gearbench_models::scene::Scene;
use gearbench_reports::Study;
use gearbench_reports::coupling::Extrapolation;
use gearbench_reports::numbers::short;

/// Step of a model without an integrator of its own, over its characteristic time.
const FINE: f64 = 0.05;
/// Step of gears with plain truncation, whose contact is stiff [s].
const TRUNCATED_STEP: f64 = 2e-8;

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &Coupling, command: &str) -> Result<CommandResult, Refusal> {
    let mut scene = scene_file::load_for(context, &args.scene, Selection::None)?;
    let chosen: Vec<String> = (choices(&scene, args)?.iter())
        .map(|c| c.label.clone())
        .collect();
    scene.build_selected(&chosen.iter().map(String::as_str).collect::<Vec<_>>())?;
    let plan = plan(&scene, args, command)?;
    let mut folder = StudyFolder::of(&args.run.output, &scene, Study::Coupling.as_str())?;
    let threads = thread_count(args.threads);
    let made = folder.run(plan.len(), |runner| study(&plan, runner, threads));
    folder.finish(
        made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?,
        Exit::of_every_run,
        summarise,
    )
}

/// Models by label, those of the study but for full finite elements where none are named.
fn choices<'s>(scene: &'s SceneFile, args: &Coupling) -> Result<Vec<&'s ModelChoice>, SceneError> {
    let all = scene.select(args.models.as_deref())?;
    let named = args.models.is_some();
    let full = |c: &&ModelChoice| scene.properties_of(&c.model).full_order;
    Ok(all.into_iter().filter(|c| named || !full(c)).collect())
}

/// Returns the models, and after an elastic one its counterpart with plain truncation if the scene has none and no
/// models are named; with the index of the counterpart.
fn configurations(
    scene: &SceneFile,
    chosen: &[&ModelChoice],
    named: bool,
) -> (Vec<Configuration>, Option<usize>) {
    let mut all: Vec<Configuration> = (chosen.iter())
        .map(|c| Configuration::of(scene, c))
        .collect();
    let of = |residual: bool| all.iter().position(|c| keeps_residual(c) == Some(residual));
    if let (false, Some(i), None) = (named, of(true), of(false)) {
        let method = VELOCITY_VERLET.at_step(TRUNCATED_STEP);
        let twin = truncated(&all[i], method, TRUNCATED_STEP);
        all.insert(i + 1, twin);
        return (all, Some(i + 1));
    }
    (all, None)
}

/// The integrator of the gears.
fn method(
    scene: &SceneFile,
    entry: &Configuration,
    asked: Option<&str>,
    characteristic_time: f64,
) -> Result<Scheme, Refusal> {
    if let Some(text) = asked {
        let found = Scheme::list(text, &scene.study.integrators).map_err(RunError::from);
        return match found.map_err(refuse_run)?.as_slice() {
            [one] => Ok(*one),
            _ => Err(Refusal::Input(miette::miette!(
                help = "name one, for example --integrator rk4@200ns",
                "`{text}` names more than one integrator for the gears"
            ))),
        };
    }
    let fits = |s: &&Scheme| {
        !s.method.info().implicit
            && s.method.info().order > 1
            && matches!(s.resolution, Resolution::Step(_))
    };
    let own = entry.methods.iter().flatten().find(fits);
    let usual = || {
        let fine = FINE * characteristic_time.min(scene.duration);
        // A round step.
        let decade = 10f64.powf(fine.log10().floor());
        let round = [5.0, 2.0, 1.0].into_iter().map(|x| x * decade);
        RK4.at_step(round.into_iter().find(|h| *h <= fine).unwrap_or(fine))
    };
    Ok(own.copied().unwrap_or_else(usual))
}

fn plan(scene: &SceneFile, args: &Coupling, command: &str) -> Result<Plan, Refusal> {
    let chosen = choices(scene, args)?;
    let duration = args.duration.unwrap_or(scene.duration);
    let mut entries = Vec::new();
    let mut left_out: Vec<(String, String, &'static str)> = Vec::new();
    let (all, twin) = configurations(scene, &chosen, args.models.is_some());
    for (i, configuration) in all.into_iter().enumerate() {
        let label = &configuration.label;
        let of = (&configuration.scene, &configuration.modelling);
        let mut built = match Scene::build(of.0, of.1, &scene.context.models) {
            Ok(built) => built,
            // The truncated twin was not requested, and contact on half-spaces has none.
            Err(e) if twin == Some(i) => {
                left_out.push((label.clone(), e.to_string(), ""));
                continue;
            }
            Err(e) => return Err(scene.locate_in(label, &e).into()),
        };
        let frames = match frames(of.0, &mut built) {
            Ok(frames) => frames,
            Err(why) => {
                left_out.push((label.clone(), why.to_string(), why.help()));
                continue;
            }
        };
        let time = built.characteristic_time(built.initial().at());
        let method = method(scene, &configuration, args.integrator.as_deref(), time)?;
        if method.method.info().linear_part && built.modal().is_none() {
            let refused = RunError::no_linear_part(method.method.id(), &built, of.0);
            return Err(refuse_run(refused));
        }
        // Without theory the runs are there all the same.
        let oscillator = oscillator(of.0, of.1, &scene.context.models, &frames)
            .ok()
            .flatten();
        let steps = match &args.steps {
            Some(steps) => steps.0.clone(),
            None => default_steps(&method, oscillator, duration),
        };
        if let Some(h) = steps.iter().find(|h| **h > duration) {
            return Err(Refusal::Input(miette::miette!(
                help = "give smaller steps (--steps), or a longer --duration",
                "a communication step of {h:e} s is longer than the {duration:e} s that are simulated"
            )));
        }
        entries.push(Entry {
            configuration,
            frames,
            method,
            oscillator,
            steps,
        });
    }
    if entries.is_empty() {
        let (why, help) = match left_out.first() {
            Some((_, why, help)) => (why.clone(), *help),
            None => (
                "it has only full finite elements".into(),
                "name the models with --models, or add a reduced one",
            ),
        };
        let why = format!(
            "the scene `{}` cannot be coupled to a host: {why}",
            scene.name
        );
        return Err(SceneError::plain(why, help).into());
    }
    let mut told = settings(scene, &chosen, false);
    told.retain(|(what, _)| what != "simulated time");
    told.insert(
        0,
        (
            "simulated time".into(),
            format!("{} ms", short(1e3 * duration, 4)),
        ),
    );
    told.push((
        "host".into(),
        "hubs that are free to move, with their inertia and loads, on extrapolated forces; the gears follow on interpolated motion"
            .into(),
    ));
    told.push((
        "labels".into(),
        format!(
            "converged: the force within {} % (relative L2) of the same model as one system; energy growth: the coupling makes up more than {} % of the energy that vibrates and passes through contacts",
            short(100.0 * args.tolerance, 3),
            short(100.0 * ALLOWED, 2)
        ),
    ));
    for (label, why, _) in left_out {
        told.push((LEFT_OUT.into(), format!("{label}: {why}")));
    }
    let once = |mut all: Vec<_>| {
        let mut seen = Vec::new();
        all.retain(|x| {
            !seen.contains(x) && {
                seen.push(*x);
                true
            }
        });
        all
    };
    Ok(Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: told,
            duration,
            timeout: args.run.timeout(),
            ..Conditions::of(scene)
        },
        entries,
        extrapolations: match args.extrapolations.as_slice() {
            [] => Extrapolation::ALL.to_vec(),
            asked => once(asked.to_vec()),
        },
        motions: {
            let mut all = args.motions.clone();
            all.dedup();
            all
        },
        tolerance: args.tolerance,
    })
}
