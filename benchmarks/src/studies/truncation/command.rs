//! `gearbench truncation SCENE`: error of the elastic model by number of modes.

use super::arguments::Truncation;
use super::plan::{Plan, sides};
use super::run::study;
use super::summary::summarise;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, references_of, refuse_run};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::reference_series::recorded;
use crate::experiment::settings::settings;
use crate::scene_file;
use gearbench_reports::Study;

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &Truncation, command: &str) -> Result<CommandResult, Refusal> {
    let mut scene = scene_file::load(context, &args.scene)?;
    let references = references_of(&mut scene, &args.insist)?;
    let (elastic, full) = sides(&scene, args)?;
    let conditions = Conditions {
        command: command.to_string(),
        settings: settings(&scene, &[elastic, full], false),
        events: true,
        repeats: args.run.repeats,
        timeout: args.run.bounded.timeout(),
        ..Conditions::of(&scene).compared_with(&scene.spec, &references)
    };
    let plan = Plan {
        external: (references.iter())
            .map(|r| recorded(r, &scene.spec))
            .collect(),
        ..Plan::of(&scene, (elastic, full), args, conditions)?
    };
    let output = &args.run.bounded.output;
    let mut folder = StudyFolder::of(output, &scene, Study::Truncation.as_str())?;
    let made = folder.run(1, |runner| study(&plan, runner));
    folder.finish(
        made.map_err(|e| folder.refuse(refuse_run(e)))?,
        Exit::of_any_run,
        summarise,
    )
}
