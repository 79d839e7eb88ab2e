//! Implements `gearbench compare SCENE`: runs models and integrators of a scene and compares them with a yardstick.

use super::arguments::Compare;
use super::summary::summarise;
use super::{FramePlan, Plan, REFINED, compare};
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, absolute, integrators_of, references_of, refuse_run};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::settings::settings;
use crate::scene_file::{self, SceneFile, Selection};
use gearbench_reports::Study;
use gearbench_reports::record::Results;

/// Runs the comparison of one or several scenes and writes its folder.
pub fn run(context: &Context, args: &Compare, command: &str) -> Result<CommandResult, Refusal> {
    let names = std::iter::once(&args.scene).chain(&args.further);
    let prepared: Vec<(SceneFile, Plan)> = names
        .map(|name| prepare(context, name, args, command))
        .collect::<Result<_, _>>()?;
    let output = &args.run.bounded.output;
    let scenes: Vec<&SceneFile> = prepared.iter().map(|(scene, _)| scene).collect();
    let mut folder = StudyFolder::of_scenes(output, &scenes, Study::Compare.as_str())?;
    let frames = args.vtu.map(|_| folder.path().join("vtu"));
    let mut plans = Vec::with_capacity(prepared.len());
    for (scene, plan) in &prepared {
        let window = window(&args.vtu_window, scene.duration)?;
        let pictures = args
            .vtu
            .zip(frames.as_ref())
            .map(|(count, path)| FramePlan {
                folder: match prepared.len() {
                    1 => path.clone(),
                    _ => path.join(&scene.name),
                },
                frames: count as usize,
                window,
            });
        let plan = plan.clone();
        plans.push(Plan { pictures, ..plan });
    }
    let made = folder.run(plans.iter().map(Plan::len).sum(), |runner| {
        let records = plans.iter().map(|plan| compare(plan, runner));
        Ok(Results::joined(records.collect::<Result<Vec<_>, _>>()?))
    });
    let made = made.map_err(|e| folder.refuse(refuse_run(e)))?;
    folder.finish(
        made.unwrap_or_default(),
        Exit::of_comparison,
        |messages, results| {
            summarise(messages, results);
            if let Some(frames) = frames.clone().filter(|f| f.exists()) {
                messages.print_line(&format!(
                    "frames for ParaView: {}",
                    absolute(frames).display()
                ));
            }
        },
    )
}

/// Reads a scene and plans its comparison, without frames.
fn prepare(
    context: &Context,
    name: &str,
    args: &Compare,
    command: &str,
) -> Result<(SceneFile, Plan), Refusal> {
    let mut scene = scene_file::load_for(context, name, Selection::Labels(args.models.as_deref()))?;
    let references = references_of(&mut scene, &args.insist)?;
    if let Some(yardstick) = args.yardstick.as_deref().filter(|name| *name != REFINED) {
        scene.damp_unbuilt(&[yardstick])?;
    }
    let choices = scene.select(args.models.as_deref())?;
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: settings(&scene, &choices, args.no_events),
            repeats: args.run.repeats,
            events: scene.study.events && !args.no_events,
            timeout: args.run.bounded.timeout(),
            ..Conditions::of(&scene).compared_with(&scene.spec, &references)
        },
        ..Plan::of(&scene, &choices, &references)
    };
    let plan = plan.compared_with(&scene, args.yardstick.as_deref())?;
    // Integrators on the command line apply to all models.
    let plan = match integrators_of(&scene, args.integrators.as_deref())? {
        Some(methods) => plan.with_methods(methods),
        None => plan,
    };
    Ok((scene, plan))
}

/// Returns the first and last time of frames [s]: the given ones, else those of the whole run.
fn window(given: &[f64], end: f64) -> Result<[f64; 2], Refusal> {
    match *given {
        [] => Ok([0.0, end]),
        [from, to] if (0.0..to).contains(&from) && to <= end => Ok([from, to]),
        _ => Err(Refusal::Input(miette::miette!(
            help = format!("for example --vtu-window 0,{end}"),
            "--vtu-window: expected two ascending times of the run, which ends at {end} s"
        ))),
    }
}
