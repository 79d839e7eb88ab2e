//! `gearbench stiffness SCENE`: static mesh stiffness, load sharing and transmission error of its models.

use super::arguments::Stiffness;
use super::plan::{Entry, Plan, formulas, includes};
use super::run::study;
use super::summary::summarise;
use crate::cli::answer::Answer;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_study};
use crate::experiment::conditions::Conditions;
use crate::experiment::settings::settings;
use crate::models::models;
use crate::scene_file::{self, Selection};
use gearbench_models::spec::effective_radius;
use gearbench_reports::Study;
use gearbench_reports::numbers::{round_quantity, short};
use gearbench_reports::record::Results;

/// Loads the models of a scene over a mesh cycle and writes a folder.
pub fn run(args: &Stiffness, command: &str) -> Result<Answer, Refusal> {
    let scene = scene_file::load_for(&args.scene, Selection::Labels(args.models.as_deref()))?;
    let choices = scene.select(args.models.as_deref())?;
    let mut entries: Vec<Entry> = choices
        .iter()
        .map(|c| Entry {
            label: c.label.clone(),
            includes: includes(&c.modelling, models()),
            spec: scene.spec_for(c),
            modelling: c.modelling.clone(),
            stated: None,
        })
        .collect();
    let first = &entries[0];
    if first.spec.gears.len() != 2 || first.spec.meshes.len() != 1 {
        return Err(Refusal::Input(miette::miette!(
            help = "take a scene with one mesh of two gears",
            "the scene `{}` has {} gears and {} meshes",
            scene.name,
            first.spec.gears.len(),
            first.spec.meshes.len()
        )));
    }
    entries.extend(formulas(&first.spec, &first.modelling));
    let mut told = settings(&scene, &choices, false);
    told.retain(|(what, _)| what != "simulated time");
    let forces: Result<Vec<f64>, Refusal> = entries.iter().map(|e| force_of(args, e)).collect();
    let forces = forces?;
    told.push(("static load".into(), load_of(args, forces[0])));
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: told,
            ..Conditions::of(&scene)
        },
        entries: entries.into_iter().zip(forces).collect(),
        positions: args.positions,
    };
    let mut folder = StudyFolder::of(&args.output, &scene, Study::Stiffness.as_str())?;
    let total = plan.positions * plan.entries.len();
    let made = folder.run(total, |runner| study(&plan, runner));
    let results = made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?;
    folder.finish(results, ended, summarise)
}

/// A model without equilibria could not be solved.
fn ended(results: &Results) -> Exit {
    match results.stiffness().iter().any(|m| m.positions.is_empty()) {
        true => Exit::FailedRun,
        false => Exit::Done,
    }
}

/// The load in words, for the settings of the record.
fn load_of(args: &Stiffness, force: f64) -> String {
    let force = round_quantity(force, "N", 4);
    match args.torque {
        Some(torque) => format!(
            "{force} along the line of action, {} N m on the first gear",
            short(torque, 4)
        ),
        None => format!(
            "{force} along the line of action, {} N/mm",
            short(args.load, 4)
        ),
    }
}

/// The force along the line of action that the command line asks for.
fn force_of(args: &Stiffness, entry: &Entry) -> Result<f64, Refusal> {
    let gears = &entry.spec.gears;
    let [a, b] = entry.spec.meshes[0].gears;
    let layout = gearbench_models::spec::mesh_layout(&gears[a], &gears[b])
        .map_err(|e| Refusal::Failed(e.to_string()))?;
    Ok(match args.torque {
        Some(torque) => torque / effective_radius(&gears[a].body),
        None => 1e3 * args.load * layout.face_width,
    })
}
