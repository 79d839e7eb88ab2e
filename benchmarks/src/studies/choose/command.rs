//! `gearbench choose SCENE`.

use super::arguments::Choose;
use super::problem::Problem;
use super::reason::{per_cent, seconds};
use super::requirement::Requirement;
use super::run::{Choice, ChooseError, choose};
use super::summary::summarise;
use super::{chosen, record};
use crate::cli::answer::Answer;
use crate::cli::exit::Exit;
use crate::cli::terminal::{Refusal, absolute, folder, progress_bar, refuse_run, say, write};
use crate::scene_file;
use gearbench_reports::Study;

/// Runs the study and writes its folder.
pub fn run(args: &Choose, command: &str) -> Result<Answer, Refusal> {
    // Models are built when they are tried: many a scene has full finite elements beside.
    let scene = scene_file::load_for(&args.scene, scene_file::Selection::None)?;
    let problem = Problem::of(&scene);
    let requirement = Requirement {
        metric: args.metric,
        tolerance: args.tolerance,
    };
    let bar = progress_bar(0);
    let choice = choose(&problem, &requirement, |what| {
        bar.set_message(what.to_string());
    });
    bar.finish_and_clear();
    let choice = choice.map_err(refuse)?;

    let out = args.output.out.as_deref();
    let results = record::results(&problem, (&scene.title, command), &requirement, &choice);
    let dir = folder(out, &scene.name, Study::Choose.as_str());
    let io = |e: std::io::Error| Refusal::Files(format!("{}: {e}", dir.display()));
    std::fs::create_dir_all(&dir).map_err(io)?;
    if let Some(candidate) = &choice.candidate {
        let remarks = remarks(&choice, &requirement, command);
        let text = chosen::text(&scene, candidate, &remarks)?;
        std::fs::write(dir.join("chosen.toml"), text).map_err(io)?;
    }
    let answer = write(&results, (out, &scene.name), |_| {
        summarise(&choice, &requirement);
    })?;
    if choice.candidate.is_some() {
        let path = absolute(dir.join("chosen.toml"));
        say(&format!("scene:  {}", path.display()));
        Ok(answer.with("scene", path))
    } else {
        Ok(answer.ending(Exit::FellShort))
    }
}

fn refuse(e: ChooseError) -> Refusal {
    match e {
        ChooseError::Run(e) => refuse_run(e),
        ChooseError::NoContact { .. } => Refusal::Input(miette::miette!("{e}")),
        ChooseError::Build(_) | ChooseError::Hierarchy(_) => Refusal::Failed(e.to_string()),
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
