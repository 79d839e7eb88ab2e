//! `gearbench stability SCENE`: maps of where methods fail.

use super::arguments::Stability;
use super::axis::Axis;
use super::cell::tolerance;
use super::plan::{MapPlan, Plan, PlannedAxis};
use super::run::{Timings, study};
use super::setup::{AxisError, Setup};
use super::summary::summarise;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::files::write_whole;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_run, refuse_study};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::conditions::logarithmic;
use crate::experiment::configuration::Configuration;
use crate::experiment::parallel::thread_count;
use crate::experiment::run::RunError;
use crate::experiment::settings::settings;
use crate::scene_file::{self, ModelChoice, SceneError, SceneFile, Selection};
use crate::studies::stability::scene::{AxisValues, COLUMNS, MAX_STEPS, StabilitySet};
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_integrators::table::{
    DOPRI5, GENERALISED_ALPHA, NEWMARK, RK4, TRIGONOMETRIC, VELOCITY_VERLET,
};
use gearbench_integrators::{MethodSpec, Scheme, Stepping};
use gearbench_models::scene::Scene;
use gearbench_reports::Study;
use gearbench_reports::numbers::short;
use gearbench_reports::stability::Columns;
use std::path::Path;

/// Default integrators of a map: explicit ones, the one that is exact for modes, implicit ones.
const USUAL: [MethodSpec; 6] = [
    VELOCITY_VERLET,
    RK4,
    DOPRI5,
    TRIGONOMETRIC,
    NEWMARK,
    GENERALISED_ALPHA.with_value(0.8),
];
/// Default range of steps, over the characteristic time of the model.
const STEPS: [f64; 2] = [0.05, 20.0];
/// Default range of relative tolerances.
const TOLERANCES: [f64; 2] = [1e-9, 1e-1];
/// Samples of the histories from which errors are computed.
const SAMPLES: usize = 500;

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &Stability, command: &str) -> Result<CommandResult, Refusal> {
    let mut scene = scene_file::load_for(context, &args.scene, Selection::None)?;
    let mut chosen: Vec<String> = Vec::new();
    for set in sets(&scene, args)?.iter() {
        chosen.extend(choices(&scene, set)?.iter().map(|c| c.label.clone()));
    }
    scene.build_selected(&chosen.iter().map(String::as_str).collect::<Vec<_>>())?;
    let plan = plan(&scene, args, command)?;
    let mut folder = StudyFolder::of(&args.run.output, &scene, Study::Stability.as_str())?;
    let threads = thread_count(args.threads);
    let made = folder.run(plan.cells(), |runner| study(&plan, runner, threads));
    let (results, timings) = made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?;
    let answer = folder.finish(results, |_| Exit::Done, summarise)?;
    write_timings(folder.path(), &timings)?;
    Ok(answer)
}

fn write_timings(folder: &Path, timings: &Timings) -> Result<(), Refusal> {
    let table =
        gearbench_reports::stability::timings(timings.iter().map(|(key, s)| (key.clone(), *s)));
    let path = folder.join(&table.file);
    write_whole(&path, table.text()).map_err(|e| Refusal::Files(format!("{}: {e}", path.display())))
}

/// The sets of maps that the scene and the command line ask for.
fn sets(scene: &SceneFile, args: &Stability) -> Result<Vec<StabilitySet>, Refusal> {
    let mut sets = scene.study.stability.clone();
    if sets.is_empty() {
        sets.push(StabilitySet::default());
    }
    if !args.axis.is_empty() {
        if let [a, b, ..] = args.axis.as_slice()
            && (args.axis.len() > 2 || a.axis == b.axis)
        {
            return Err(Refusal::Input(miette::miette!(
                help = "a map has the step and one parameter, small multiples a second one",
                "--axis is given {} times; expected one or two parameters, each once",
                args.axis.len()
            )));
        }
        sets.truncate(1);
        sets[0].axes.clone_from(&args.axis);
        // Models and integrators of the scene's own maps do not apply to axes from the command line.
        sets[0].models = None;
        sets[0].integrators = None;
    }
    for set in &mut sets {
        if set.axes.is_empty() {
            let axis = Axis::ContactStiffness;
            let values = axis.defaults();
            set.axes.push(AxisValues { axis, values });
        }
        if let Some(text) = &args.models {
            let chosen = scene.select(Some(text))?;
            set.models = Some(chosen.iter().map(|c| c.label.clone()).collect());
        }
        if let Some(text) = &args.integrators {
            if text.contains('@') {
                return Err(Refusal::Input(miette::miette!(
                    help = "the steps are the axis of the map: give them with --steps, tolerances with --rtol",
                    "`{text}` names a step or tolerance"
                )));
            }
            let methods = Scheme::list(text, &[])
                .map_err(RunError::from)
                .map_err(refuse_run)?;
            set.integrators = Some(methods.into_iter().map(|m| m.method).collect());
        }
        set.steps = args.steps.or(set.steps);
        set.tolerances = args.rtol.or(set.tolerances);
        set.duration = args.duration.or(set.duration);
        set.max_steps = args.max_steps.or(set.max_steps);
        if let Some([columns, rows]) = args.grid {
            for span in [&mut set.steps, &mut set.tolerances].into_iter().flatten() {
                span.points = columns;
            }
            if let Some(AxisValues { values, .. }) = set.axes.first_mut()
                && let (Some(&from), Some(&to)) = (values.first(), values.last())
                && from > 0.0
            {
                *values = logarithmic(from, to, rows);
            }
        }
    }
    if args.models.is_some() && args.axis.is_empty() {
        // A model named on the command line has a map for every set of axes that applies to it; each pair of model and
        // axes once.
        sets.dedup_by(|a, b| a == b);
    }
    Ok(sets)
}

/// Returns the models of a set: those it names, else those of the study without full finite elements, whose maps take
/// too long.
fn choices<'s>(scene: &'s SceneFile, set: &StabilitySet) -> Result<Vec<&'s ModelChoice>, Refusal> {
    Ok(match &set.models {
        Some(labels) => scene.select(Some(&labels.join(",")))?,
        None => {
            let all = scene.select(None)?;
            (all.into_iter()
                .filter(|c| !scene.properties_of(&c.model).full_order))
            .collect()
        }
    })
}

fn plan(scene: &SceneFile, args: &Stability, command: &str) -> Result<Plan, Refusal> {
    let mut entries: Vec<Configuration> = Vec::new();
    let mut chosen: Vec<&ModelChoice> = Vec::new();
    let mut maps = Vec::new();
    let mut left_out: Vec<(String, String)> = Vec::new();
    for (number, set) in sets(scene, args)?.iter().enumerate() {
        for choice in choices(scene, set)? {
            let known = entries.iter().position(|e| e.label == choice.label);
            let entry = known.unwrap_or_else(|| {
                entries.push(Configuration::of(scene, choice));
                chosen.push(choice);
                entries.len() - 1
            });
            let e = &entries[entry];
            let mut built = Scene::build(&e.scene, &e.modelling, &scene.context.models)
                .map_err(|error| scene.locate_in(&choice.label, &error))?;
            let about = ModelData {
                scene,
                set,
                number,
                entry,
                characteristic_time: built.characteristic_time(built.initial().at()),
                linear_part: built.modal().is_some(),
                columns: args.grid.map_or(COLUMNS, |g| g[0]),
            };
            for &method in set.integrators.as_deref().unwrap_or(&USUAL) {
                match map(&about, e, method)? {
                    Ok(map) => maps.push(map),
                    Err(why) => left_out.push((
                        "left out".into(),
                        format!("{} under {method}: {why}", choice.label),
                    )),
                }
            }
        }
    }
    if maps.is_empty() {
        let why: Vec<String> = left_out.into_iter().map(|(_, why)| why).collect();
        return Err(Refusal::from(SceneError::plain(
            format!("there is no map to make: {}", why.join("; ")),
            "name models and integrators that have the parameters of the axes",
        )));
    }
    let tolerance = tolerance(scene.tolerance.as_ref());
    let mut told = settings(scene, &chosen, false);
    told.retain(|(what, _)| {
        let parts = ["gear ", "mesh ", "model ", "events"];
        parts.iter().any(|p| what.starts_with(p))
    });
    told.push((
        "inaccurate".into(),
        format!(
            "{} above {} against the model's own converged solution at the same parameters",
            tolerance.metric,
            short(tolerance.limit, 3)
        ),
    ));
    told.extend(left_out);
    Ok(Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: told,
            samples: SAMPLES,
            timeout: args.run.timeout(),
            ..Conditions::of(scene)
        },
        entries,
        maps,
        tolerance,
        refine: !args.no_refine,
    })
}

/// Data about a model that its maps need.
struct ModelData<'a> {
    scene: &'a SceneFile,
    set: &'a StabilitySet,
    number: usize,
    entry: usize,
    characteristic_time: f64,
    linear_part: bool,
    columns: usize,
}

/// The map of a model under an integrator, or why there is none.
fn map(
    about: &ModelData<'_>,
    entry: &Configuration,
    method: MethodSpec,
) -> Result<Result<MapPlan, String>, Refusal> {
    let ModelData { set, scene, .. } = about;
    let info = method.info();
    if info.linear_part && !about.linear_part {
        return Ok(Err(
            "it needs gears whose coordinates are oscillators".into()
        ));
    }
    let setup = Setup {
        scene: entry.scene.clone(),
        modelling: entry.modelling.clone(),
        method,
    };
    let mut axes = Vec::new();
    for asked in &set.axes {
        match PlannedAxis::new(asked.axis, &asked.values, &setup) {
            Ok(axis) => axes.push(axis),
            Err(AxisError::Without(why)) => return Ok(Err(why)),
            Err(AxisError::Build(e)) => return Err(scene.locate_in(&entry.label, &e).into()),
        }
    }
    let duration = set.duration.unwrap_or(scene.duration);
    let adaptive = info.stepping == Stepping::Adaptive;
    let at = if adaptive {
        set.tolerances.map_or_else(
            || logarithmic(TOLERANCES[0], TOLERANCES[1], about.columns),
            |s| s.values(),
        )
    } else {
        set.steps.map_or_else(
            || {
                let [from, to] = STEPS.map(|x| x * about.characteristic_time);
                logarithmic(from, to.min(duration).max(2.0 * from), about.columns)
            },
            |s| s.values(),
        )
    };
    if let Some(h) = at.iter().find(|h| !adaptive && **h > duration) {
        return Err(Refusal::Input(miette::miette!(
            help =
                "give smaller steps (--steps, `step_s` of the scene's maps) or a longer --duration",
            "a step of {h:e} s is longer than the {duration:e} s that are simulated"
        )));
    }
    Ok(Ok(MapPlan {
        set: about.number,
        entry: about.entry,
        method,
        implicit: info.implicit,
        columns: if adaptive {
            Columns::Tolerance
        } else {
            Columns::Step
        },
        at,
        axes,
        duration,
        max_steps: set.max_steps.unwrap_or(MAX_STEPS),
    }))
}
