//! `gearbench modes SCENE`: natural frequencies and shapes of the whole scene.

use super::arguments::Modes;
use super::plan::Plan;
use super::run::{ModesSettings, study};
use super::summary::summarise;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_study};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::linear_models::selected_models;
use crate::scene_file::{self, Selection};
use gearbench_reports::Study;
use gearbench_reports::modes::LinearisedState;
use gearbench_reports::record::Results;

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &Modes, command: &str) -> Result<CommandResult, Refusal> {
    let scene = scene_file::load_for(
        context,
        &args.scene,
        Selection::Labels(args.models.as_deref()),
    )?;
    let (taken, told) = selected_models(&scene, args.models.as_deref())?;
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: told,
            ..Conditions::of(&scene)
        },
        entries: taken.iter().map(|c| Configuration::of(&scene, c)).collect(),
        wanted: ModesSettings {
            most: args.count as usize,
            up_to: args.up_to.unwrap_or(f64::INFINITY),
            group: args.group,
        },
    };
    let mut folder = StudyFolder::of(&args.output, &scene, Study::Modes.as_str())?;
    let made = folder.run(plan.entries.len(), |runner| study(&plan, runner));
    let results = made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?;
    folder.finish(results, ended, summarise)
}

/// A model without an equilibrium could not be solved.
fn ended(results: &Results) -> Exit {
    let lost = |v: &gearbench_reports::modes::ModelModes| v.about == LinearisedState::NotFound;
    match results.vibrations().iter().any(lost) {
        true => Exit::FailedRun,
        false => Exit::Done,
    }
}
