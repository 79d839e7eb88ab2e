//! `gearbench precision SCENE`: accuracy against cost.

use super::arguments::Precision;
use super::summary::summarise;
use super::{Plan, study};
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, references_of, refuse_run};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::settings::settings;
use crate::scene_file::{self, SceneError, Selection};
use gearbench_reports::Study;
use gearbench_reports::numbers::short;
use std::time::Duration;

/// Short runs are timed until their repeats together take this long.
const TIMED: Duration = Duration::from_millis(25);

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &Precision, command: &str) -> Result<CommandResult, Refusal> {
    let refused = |reason: String| {
        Refusal::from(SceneError::plain(
            reason,
            "`gearbench precision --help` shows all options",
        ))
    };
    let mut scene = scene_file::load_for(
        context,
        &args.scene,
        Selection::Precision(args.models.as_deref()),
    )?;
    let references = references_of(&mut scene, &args.insist)?;
    let against: Vec<&str> = args.asked.against.iter().map(String::as_str).collect();
    scene.damp_unbuilt(&against)?;
    let choices = scene.select_precision(args.models.as_deref())?;
    let plan = Plan::of(&scene, &choices, &references, &args.asked).map_err(refused)?;
    // The settings list the simulated model first, then the references.
    let mut told = settings(&scene, &choices, false);
    told.retain(|(what, _)| {
        what != "integrators of the scene" && what != "converged solution (self)"
    });
    for row in told.iter_mut().filter(|(what, _)| what == "simulated time") {
        row.1 = format!("{} ms", short(plan.conditions.duration * 1e3, 4));
    }
    let plan = Plan {
        timed: TIMED,
        conditions: Conditions {
            command: command.to_string(),
            settings: [told, plan.conditions.settings].concat(),
            repeats: args.repeats,
            timeout: Duration::from_secs_f64(args.timeout),
            ..plan.conditions
        },
        ..plan
    };
    let mut folder = StudyFolder::of(&args.output, &scene, Study::Precision.as_str())?;
    let made = folder.run_within(args.budget.budget(), plan.len(), |runner| {
        study(&plan, runner)
    });
    folder.finish(
        made.map_err(|e| folder.refuse(refuse_run(e)))?,
        Exit::of_any_run,
        summarise,
    )
}
