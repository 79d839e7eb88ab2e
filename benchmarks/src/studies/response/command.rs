//! `gearbench response SCENE`: frequency response to the passing of teeth.

use super::arguments::Response;
use super::plan::{FrequencyGrid, Plan};
use super::run::study;
use super::summary::summarise;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_study};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::linear_models::selected_models;
use crate::scene_file::{self, SceneError, Selection};
use gearbench_reports::Study;
use gearbench_reports::record::Results;

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &Response, command: &str) -> Result<CommandResult, Refusal> {
    let range = args.from.zip(args.to).map(|(a, b)| [a, b]);
    if let Some([from, to]) = range.filter(|[from, to]| to <= from) {
        return Err(SceneError::plain(
            format!("the range from {from} Hz to {to} Hz is empty"),
            "give the lower frequency as --from",
        )
        .into());
    }
    let scene = scene_file::load_for(
        context,
        &args.scene,
        Selection::Labels(args.models.as_deref()),
    )?;
    let (choices, settings) = selected_models(&scene, args.models.as_deref())?;
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings,
            ..Conditions::of(&scene)
        },
        entries: choices
            .iter()
            .map(|c| Configuration::of(&scene, c))
            .collect(),
        wanted: FrequencyGrid {
            range,
            points: args.points as usize,
            phases: args.phases as usize,
        },
    };
    let mut folder = StudyFolder::of(&args.output, &scene, Study::Response.as_str())?;
    let made = folder.run(plan.entries.len(), |runner| study(&plan, runner));
    let results = made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?;
    folder.finish(results, ended, summarise)
}

/// A model without a response could not be solved.
fn ended(results: &Results) -> Exit {
    match results.responses().iter().any(|r| r.groups.is_empty()) {
        true => Exit::FailedRun,
        false => Exit::Done,
    }
}
