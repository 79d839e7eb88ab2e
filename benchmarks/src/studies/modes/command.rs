//! `gearbench modes SCENE`: natural frequencies and shapes of the whole scene.

use super::arguments::Modes;
use super::plan::Plan;
use super::run::{Wanted, study};
use super::summary::summarise;
use crate::cli::answer::Answer;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_study};
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::run::LEFT_OUT;
use crate::experiment::settings::settings;
use crate::models::models;
use crate::scene_file::{self, ModelChoice, SceneError, Selection};
use gearbench_models::gear::table::properties_of;
use gearbench_reports::Study;
use gearbench_reports::modes::About;
use gearbench_reports::record::Results;

/// The way out for full finite elements.
const TAKE_ELASTIC: &str =
    "take elastic gears: their modes and compliance are reduced from the same mesh";

/// Runs the study and writes its folder.
pub fn run(args: &Modes, command: &str) -> Result<Answer, Refusal> {
    let scene = scene_file::load_for(&args.scene, Selection::Labels(args.models.as_deref()))?;
    let choices = scene.select(args.models.as_deref())?;
    let large = |c: &&ModelChoice| {
        let ids = c.modelling.gears.iter().map(|g| g.id.as_str());
        ids.chain([c.model.as_str()])
            .any(|id| properties_of(models(), id).full_order)
    };
    let (left, taken): (Vec<&ModelChoice>, Vec<&ModelChoice>) =
        choices.into_iter().partition(large);
    if let Some(choice) = left
        .first()
        .filter(|_| args.models.is_some() || taken.is_empty())
    {
        let why = format!(
            "`{}` has all nodes of finite elements as coordinates, too many for its natural frequencies",
            choice.label
        );
        return Err(SceneError::plain(why, TAKE_ELASTIC).into());
    }
    let mut told = settings(&scene, &taken, false);
    told.retain(|(what, _)| {
        let parts = ["gear ", "shaft ", "mesh ", "model ", "odd"];
        parts.iter().any(|p| what.starts_with(p))
    });
    told.extend(left.iter().map(|c| {
        let why = format!("{}: full finite elements; {TAKE_ELASTIC}", c.label);
        (LEFT_OUT.to_owned(), why)
    }));
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: told,
            ..Conditions::of(&scene)
        },
        entries: taken.iter().map(|c| Configuration::of(&scene, c)).collect(),
        wanted: Wanted {
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
    let lost = |v: &gearbench_reports::modes::ModelModes| v.about == About::NotFound;
    match results.vibrations().iter().any(lost) {
        true => Exit::FailedRun,
        false => Exit::Done,
    }
}
