//! `gearbench choose SCENE`.

use super::arguments::Choose;
use super::problem::Problem;
use super::reason::{per_cent, seconds};
use super::requirement::Requirement;
use super::run::{Choice, ChooseError, choose};
use super::summary::summarise;
use super::{chosen, held, record};
use crate::cli::answer::Answer;
use crate::cli::arguments::Insist;
use crate::cli::exit::Exit;
use crate::cli::files::write_whole;
use crate::cli::progress::Display;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, absolute, all_references_of, refuse_run, say};
use crate::experiment::conditions::silent;
use crate::experiment::interruption;
use crate::experiment::run::RunError;
use crate::scene_file::{self, SceneFile};
use gearbench_reports::Study;
use std::sync::Arc;

/// Runs the study and writes its folder.
pub fn run(args: &Choose, command: &str) -> Result<Answer, Refusal> {
    // Models are built when they are tried: many a scene has full finite elements beside.
    let mut scene = scene_file::load_for(&args.scene, scene_file::Selection::None)?;
    let references = match args.references {
        true => all_references_of(&mut scene, &Insist::default())?,
        false => Vec::new(),
    };
    if args.references && references.is_empty() {
        return Err(Refusal::Input(miette::miette!(
            help = "give it a line `reference = ..` or tables [[references]], or leave out --references",
            "the scene `{}` has no reference",
            scene.name
        )));
    }
    let mut folder = StudyFolder::of(&args.run.output, &scene, Study::Choose.as_str())?;
    let problem = Problem {
        runner: Arc::new(folder.runner(&silent).within(args.budget.budget())),
        timeout: args.run.timeout(),
        ..Problem::of(&scene)
    };
    let requirement = Requirement {
        metric: args.metric,
        tolerance: args.tolerance,
    };
    let display = Display::new(0);
    let choice = choose(&problem, &requirement, |what| display.message(what));
    drop(display);
    if interruption::requested() {
        return Err(folder.interrupted());
    }
    let choice = choice.map_err(|e| folder.refuse(refuse(&scene, &problem, e)))?;
    let mut results = record::results(&problem, (&scene.title, command), &requirement, &choice);
    let dir = folder.path().to_owned();
    let io = |e: std::io::Error| Refusal::Files(format!("{}: {e}", dir.display()));
    if let Some(candidate) = &choice.candidate {
        let remarks = remarks(&choice, &requirement, command);
        let text = chosen::text(&scene, candidate, &remarks)?;
        write_whole(&dir.join("chosen.toml"), text).map_err(io)?;
    }
    let mut beyond = Vec::new();
    if let Some(candidate) = choice.candidate.as_ref().filter(|_| !references.is_empty()) {
        let found = held::against(candidate, &references, &requirement);
        let found = found.map_err(refuse_run)?;
        results.settings.extend(found.settings);
        beyond = found.beyond;
    }
    let held: Vec<(String, String)> = (results.settings.iter())
        .filter(|(what, _)| what.starts_with(held::AGAINST))
        .cloned()
        .collect();
    let exit = match choice.candidate {
        Some(_) if beyond.is_empty() => Exit::Done,
        Some(_) => Exit::FellShort,
        None => Exit::FellShort,
    };
    let answer = folder.finish(
        results,
        |_| exit,
        |_| {
            summarise(&choice, &requirement);
            held.iter()
                .for_each(|(what, found)| say(&format!("{what}: {found}")));
        },
    )?;
    if choice.candidate.is_some() {
        let path = absolute(dir.join("chosen.toml"));
        say(&format!("scene:  {}", path.display()));
        Ok(answer.with("scene", path))
    } else {
        Ok(answer)
    }
}

/// An error of assembly at its line, where it is about a model of the scene.
fn refuse(scene: &SceneFile, problem: &Problem, e: ChooseError) -> Refusal {
    match (e, &problem.flexible.label) {
        (ChooseError::Build(e) | ChooseError::Run(RunError::Build(e)), Some(label)) => {
            scene.locate_in(label, &e).into()
        }
        (ChooseError::Run(e), _) => refuse_run(e),
        (e @ (ChooseError::NoContact { .. } | ChooseError::Build(_)), _) => {
            Refusal::Input(miette::miette!("{e}"))
        }
        (e @ (ChooseError::Hierarchy(_) | ChooseError::Budget(_)), _) => {
            Refusal::Failed(e.to_string())
        }
    }
}

/// What heads the scene file.
fn remarks(choice: &Choice, requirement: &Requirement, command: &str) -> Vec<String> {
    let mut all = vec![
        format!("Chosen by `{command}`:"),
        format!(
            "estimated error of the {} {}, of {} allowed; {} on the machine where it was chosen.",
            requirement.title(),
            per_cent(choice.predicted_error),
            per_cent(requirement.tolerance),
            seconds(choice.predicted_cost_s)
        ),
    ];
    all.extend(choice.reason.iter().cloned());
    all
}
