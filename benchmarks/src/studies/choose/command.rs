//! Implements `gearbench choose SCENE`: selects the cheapest model and integrator within an error tolerance.

use super::arguments::Choose;
use super::plan::Candidate;
use super::problem::Problem;
use super::reasons::{per_cent, seconds};
use super::reference_comparison::ComparedModel;
use super::requirement::Requirement;
use super::run::{Choice, ChooseError, choose};
use super::summary::summarise;
use super::{chosen_scene, record, reference_comparison};
use crate::cli::arguments::AnyReference;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::files::write_whole;
use crate::cli::progress::Display;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, absolute, all_references_of, refuse_run};
use crate::context::Context;
use crate::experiment::conditions::silent;
use crate::experiment::configuration::Configuration;
use crate::experiment::linear_models::mesh_modes;
use crate::experiment::run::RunError;
use crate::scene_file::references::LoadedReference;
use crate::scene_file::{self, ModelChoice, SceneFile};
use gearbench_reports::record::MeshMode;
use gearbench_reports::{Part, ReferenceDistance, Study, Verdict};
use std::sync::Arc;

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &Choose, command: &str) -> Result<CommandResult, Refusal> {
    // Models are built when they are tried: many a scene has full finite elements beside.
    let mut scene = scene_file::load_for(context, &args.scene, scene_file::Selection::None)?;
    let references = match args.references {
        true => all_references_of(&mut scene, &AnyReference::default())?,
        false => references_of_the_scene(&mut scene),
    };
    if args.references && references.is_empty() {
        return Err(Refusal::Input(miette::miette!(
            help = "give it a line `reference = ..` or tables [[references]], or leave out --references",
            "the scene `{}` has no reference",
            scene.name
        )));
    }
    let reduced = |m: &&ModelChoice| !scene.properties_of(&m.model).full_order;
    let labels: Vec<String> = (scene.models.iter().filter(reduced))
        .map(|m| m.label.clone())
        .collect();
    scene.damp_unbuilt(&labels.iter().map(String::as_str).collect::<Vec<_>>())?;
    let mut folder = StudyFolder::of(&args.run.output, &scene, Study::Choose.as_str())?;
    let problem = Problem {
        runner: Arc::new(folder.runner(&silent).within(args.budget.budget())),
        runs: args.runs,
        timeout: args.run.timeout(),
        ..Problem::of(&scene)
    };
    let requirement = Requirement {
        metric: args.metric,
        tolerance: args.tolerance,
    };
    let display = Display::of(context, 0);
    let choice = choose(&problem, &requirement, |what| display.message(what));
    drop(display);
    if context.interruption.is_requested() {
        return Err(folder.interrupted());
    }
    let mut choice = choice.map_err(|e| folder.refuse(refuse(&scene, &problem, e)))?;
    let settings = compare_with(&mut choice, &references, &requirement, args.references)?;
    let mut results = record::results(&problem, (&scene.title, command), &requirement, &choice);
    results.settings.extend(settings.iter().cloned());
    results.mesh_modes = damping_of(&scene, &choice, &problem)?;
    let file = folder.path().join("chosen.toml");
    let io = |e: std::io::Error| Refusal::Files(format!("{}: {e}", file.display()));
    match &choice.candidate {
        Some(candidate) => {
            let remarks = remarks(&choice, &requirement, command);
            let text = chosen_scene::text(&scene, candidate, &remarks)?;
            write_whole(&file, text).map_err(io)?;
        }
        // The scene file of an earlier start does not answer the present question.
        None => match std::fs::remove_file(&file) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(io(e)),
            _ => {}
        },
    }
    let exit = match choice.verdict {
        Verdict::Adequate => Exit::Done,
        Verdict::NotDecided | Verdict::NoneAdequate => Exit::FellShort,
    };
    let answer = folder.finish(
        results,
        |_| exit,
        |messages, results| {
            if let Part::Choose(part) = &results.part {
                summarise(messages, &part.choice, &choice);
            }
            (settings.iter())
                .for_each(|(what, found)| context.messages.print_line(&format!("{what}: {found}")));
        },
    )?;
    if choice.candidate.is_some() {
        let path = absolute(file);
        context
            .messages
            .print_line(&format!("scene:  {}", path.display()));
        Ok(answer.with("scene", path))
    } else {
        Ok(answer)
    }
}

/// The mesh modes of the yardstick and of the choice: two models are alike under load only where their damping is.
fn damping_of(
    scene: &SceneFile,
    choice: &Choice,
    problem: &Problem,
) -> Result<Vec<MeshMode>, Refusal> {
    let Some(any) = scene.models.first() else {
        return Ok(Vec::new());
    };
    let chosen = choice.candidate.iter().chain([&choice.yardstick]);
    let entries: Vec<Configuration> = chosen
        .map(|c| Configuration {
            label: c.level.name(),
            scene: (*c.scene).clone(),
            modelling: (*c.modelling).clone(),
            ..Configuration::of(scene, any)
        })
        .collect();
    mesh_modes(&entries, &problem.context.models, &problem.runner, false).map_err(Refusal::from)
}

/// Returns the references under the scene's own conditions, with which the yardstick is compared. If they cannot be
/// read the result is empty, with a warning: the choice does not need them.
fn references_of_the_scene(scene: &mut SceneFile) -> Vec<LoadedReference> {
    match scene.load_references(false) {
        Ok(all) => {
            let own = |r: &LoadedReference| r.named.is_of_the_scene();
            all.into_iter().filter(own).collect()
        }
        Err(e) => {
            scene.context.messages.warn(&format!(
                "the yardstick is not compared with references: {e}"
            ));
            Vec::new()
        }
    }
}

/// Compares the yardstick with the references, and the choice if `asked`: a choice beyond the tolerance against a
/// reference is withdrawn. Otherwise the yardstick is run for them only where the window is the whole scene.
fn compare_with(
    choice: &mut Choice,
    references: &[LoadedReference],
    requirement: &Requirement,
    asked: bool,
) -> Result<Vec<(String, String)>, Refusal> {
    if references.is_empty() || !(asked || choice.window.whole) {
        return Ok(Vec::new());
    }
    let against = |subject, candidate: &Candidate| {
        reference_comparison::against((subject, candidate), references, requirement)
            .map_err(refuse_run)
    };
    let mut found = against(ComparedModel::Yardstick, &choice.yardstick)?;
    choice.references = (found.distances.drain(..))
        .map(|(reference, yardstick)| ReferenceDistance {
            reference,
            yardstick,
            choice: None,
        })
        .collect();
    for r in &choice.references {
        if let Some(distance) = r.yardstick {
            choice.reason.push(format!(
                "The scene has the reference `{}`, another yardstick: this one is {} away from it in the {} over the whole scene.",
                r.reference,
                per_cent(distance),
                requirement.title()
            ));
        }
    }
    let Some(candidate) = choice.candidate.as_ref().filter(|_| asked) else {
        return Ok(found.settings);
    };
    let of_choice = against(ComparedModel::Choice, candidate)?;
    for (r, (_, distance)) in choice.references.iter_mut().zip(of_choice.distances) {
        r.choice = distance;
    }
    found.settings.extend(of_choice.settings);
    if !of_choice.beyond.is_empty() {
        choice.reason.push(format!(
            "{} is adequate by the yardstick, but beyond the tolerance against {}: it is not decided what keeps {}.",
            candidate.name(),
            of_choice.beyond.join(", "),
            per_cent(requirement.tolerance)
        ));
        choice.candidate = None;
        choice.verdict = Verdict::NotDecided;
    }
    Ok(found.settings)
}

/// An error of assembly at its line, where it is about a model of the scene.
fn refuse(scene: &SceneFile, problem: &Problem, e: ChooseError) -> Refusal {
    match (e, &problem.flexible.label) {
        (ChooseError::Build(e) | ChooseError::Run(RunError::Build(e)), Some(label)) => {
            scene.locate_in(label, &e).into()
        }
        (ChooseError::Run(RunError::NoLinearPart(coupled)), _) => {
            let omitted = coupled.without.map_or_else(String::new, |key| {
                format!("{key} omits these terms; with them, ")
            });
            Refusal::Input(miette::miette!(
                help = format!(
                    "{omitted}`gearbench compare` judges the models of the scene by refined gears under dopri5 (`--yardstick refined`)"
                ),
                "`choose` needs coordinates that are independent oscillators: {}",
                coupled.why
            ))
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

/// Returns the comment lines at the head of the written scene file: command, estimated errors and cost.
fn remarks(choice: &Choice, requirement: &Requirement, command: &str) -> Vec<String> {
    let mut all = vec![
        format!("Chosen by `{command}`:"),
        format!(
            "estimated error of the {} {}, own error of the yardstick {}, {} allowed; {} a run on the machine where it was chosen.",
            requirement.title(),
            per_cent(choice.predicted_error),
            per_cent(choice.own_error.unwrap_or(f64::NAN)),
            per_cent(requirement.tolerance),
            seconds(choice.predicted_cost_s)
        ),
    ];
    all.extend(choice.reason.iter().cloned());
    all
}
