//! `gearbench choose SCENE`.

use super::arguments::Choose;
use super::reason::{per_cent, seconds};
use super::{Choice, ChooseError, Situation, Wish, choose};
use super::{chosen, record};
use crate::cli::terminal::{FELL_SHORT, Refusal, progress_bar, refuse_run, say, write};
use crate::scene_file;
use std::path::Path;
use std::process::ExitCode;

/// Runs the study and writes its folder.
pub fn run(args: &Choose, command: &str) -> Result<ExitCode, Refusal> {
    // Models are built when they are tried: many a scene has full finite elements beside.
    let scene = scene_file::load_for(&args.scene, scene_file::Selection::None)?;
    let situation = Situation::of(&scene);
    let wish = Wish {
        metric: args.metric,
        tolerance: args.tolerance,
    };
    let bar = progress_bar(0);
    let choice = choose(&situation, &wish, |what| {
        bar.set_message(what.to_string());
    });
    bar.finish_and_clear();
    let choice = choice.map_err(refuse)?;

    let results = record::results(&situation, (&scene.title, command), &wish, &choice);
    let dir =
        (args.out.clone()).unwrap_or_else(|| Path::new("out").join(&scene.name).join("choose"));
    let io = |e: std::io::Error| Refusal::Files(format!("{}: {e}", dir.display()));
    std::fs::create_dir_all(&dir).map_err(io)?;
    if let Some(candidate) = &choice.candidate {
        let remarks = remarks(&choice, &wish, command);
        let text = chosen::text(&scene, candidate, &remarks)?;
        std::fs::write(dir.join("chosen.toml"), text).map_err(io)?;
    }
    write(&results, (&args.out, &scene.name), |_| {
        summarise(&choice, &wish);
    })?;
    if choice.candidate.is_some() {
        say(&format!("scene:  {}", dir.join("chosen.toml").display()));
        Ok(ExitCode::SUCCESS)
    } else {
        Ok(ExitCode::from(FELL_SHORT))
    }
}

fn refuse(e: ChooseError) -> Refusal {
    match e {
        ChooseError::Run(e) => refuse_run(e),
        ChooseError::NoContact { .. } => Refusal::Input(miette::miette!("{e}")),
        ChooseError::Build(_) | ChooseError::Ladder(_) => Refusal::Failed(e.to_string()),
    }
}

/// What heads the scene file.
fn remarks(choice: &Choice, wish: &Wish, command: &str) -> Vec<String> {
    let mut all = vec![
        format!("Chosen by `{command}`:"),
        format!(
            "estimated error of the {} {}, of {} allowed; {} on the machine where it was chosen.",
            wish.metric.title(),
            per_cent(choice.predicted_error),
            per_cent(wish.tolerance),
            seconds(choice.predicted_cost_s)
        ),
    ];
    all.extend(choice.reason.iter().cloned());
    all
}

/// The answer in plain words.
fn summarise(choice: &Choice, wish: &Wish) {
    let wanted = format!(
        "{} within {}",
        wish.metric.title(),
        per_cent(wish.tolerance)
    );
    match &choice.candidate {
        Some(c) => {
            say(&format!("{wanted}: {}", c.name()));
            say(&format!(
                "predicted error {}, predicted cost {} for the whole scene",
                per_cent(choice.predicted_error),
                seconds(choice.predicted_cost_s)
            ));
        }
        None => say(&format!("{wanted}: nothing is adequate")),
    }
    for sentence in &choice.reason {
        say(&format!("  {sentence}"));
    }
    for sentence in &choice.outside {
        say(&format!(
            "warning: not checked on scenes like this: {sentence}"
        ));
    }
    say(&format!(
        "{:<34} {:>9} {:>9}  {}",
        "rung", "error", "cost", "verdict"
    ));
    for r in &choice.rungs {
        let (cost, verdict) = match (&r.cheapest, &r.failure) {
            (_, Some(f)) => (String::new(), f.clone()),
            (Some((c, cost)), None) => {
                let name = c.name();
                let method = name.strip_prefix(&r.rung.name()).unwrap_or(&name);
                let method = method.trim_start_matches(", ").to_string();
                (seconds(*cost), format!("adequate with {method}"))
            }
            (None, None) if r.adequate && choice.candidate.is_some() => {
                (String::new(), "adequate, dearer".into())
            }
            (None, None) if r.adequate => (String::new(), "no step tried keeps it".into()),
            (None, None) => (String::new(), "not adequate".into()),
        };
        say(&format!(
            "{:<34} {:>9} {:>9}  {verdict}",
            r.rung.name(),
            per_cent(r.error),
            cost
        ));
    }
}
