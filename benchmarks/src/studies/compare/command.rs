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
use crate::scene_file::{self, Selection};
use gearbench_reports::Study;

/// Runs the comparison and writes its folder.
pub fn run(context: &Context, args: &Compare, command: &str) -> Result<CommandResult, Refusal> {
    let mut scene = scene_file::load_for(
        context,
        &args.scene,
        Selection::Labels(args.models.as_deref()),
    )?;
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
    let window = window(&args.vtu_window, scene.duration)?;
    let output = &args.run.bounded.output;
    let mut folder = StudyFolder::of(output, &scene, Study::Compare.as_str())?;
    let pictures = args.vtu.map(|frames| FramePlan {
        folder: folder.path().join("vtu"),
        frames: frames as usize,
        window,
    });
    let frames = pictures.as_ref().map(|p| p.folder.clone());
    let plan = Plan { pictures, ..plan };
    let made = folder.run(plan.len(), |runner| compare(&plan, runner));
    folder.finish(
        made.map_err(|e| folder.refuse(refuse_run(e)))?,
        Exit::of_comparison,
        |messages, results| {
            summarise(messages, results);
            if let Some(frames) = frames.filter(|f| f.exists()) {
                messages.print_line(&format!(
                    "frames for ParaView: {}",
                    absolute(frames).display()
                ));
            }
        },
    )
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
