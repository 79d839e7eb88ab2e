//! `gearbench identify SCENE`: constants fitted to the scene's reference, printed and, on request, written.

use super::arguments::Identify;
use super::summary::summarise;
use super::{Identification, IdentifyError, identify};
use crate::cli::answer::Answer;
use crate::cli::progress::Display;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, absolute, say, stored_reference};
use crate::experiment::conditions::silent;
use crate::experiment::interruption;
use crate::experiment::machine;
use crate::models::models;
use crate::scene_file::calibration::Constants;
use crate::scene_file::{self, Calibration, SceneFile, Selection};
use gearbench_models::gear::table::properties_of;
use std::path::PathBuf;

/// Name of the calibration that an impact gives.
const NAME: &str = "impact";

/// Fits the models of a scene that have something to fit.
pub fn run(args: &Identify, command: &str) -> Result<Answer, Refusal> {
    // What is identified is built by its fits.
    let mut scene = scene_file::load_uncalibrated(&args.scene, Selection::None)?;
    let Some(reference) = stored_reference(&mut scene, &args.insist)? else {
        let way_out = match scene.fitting() {
            Some(fitting) => format!("give it a line `{fitting}`"),
            None => {
                "no stored reference is of these gears, speeds and loads: `gearbench list`".into()
            }
        };
        return Err(Refusal::Input(miette::miette!(
            help = way_out,
            "the scene `{}` has no reference to identify against",
            scene.name
        )));
    };
    let id = reference.id;
    let history = &reference.history;
    // Beyond the scene's duration the reference may lack what the scene has, as the other flanks.
    let n = history.time.partition_point(|&t| t <= scene.duration);
    let (time, force) = (&history.time[..n], &history.contact_force[..n]);

    let choices = scene.select(args.model.as_deref())?;
    let fitted: Vec<_> = choices
        .into_iter()
        .filter(|c| {
            args.model.is_some()
                || (properties_of(models(), &c.model).fit.is_some() && calibrated(c))
        })
        .collect();
    if fitted.is_empty() {
        return Err(Refusal::Input(miette::miette!(
            help = "a model takes part when it has a line calibration = \"impact\"",
            "the scene `{}` has no model to calibrate",
            scene.name
        )));
    }
    let mut folder = StudyFolder::of(&args.output, &scene, "identify")?;
    let runner = folder.runner(&silent);
    let mut found: Vec<(String, Identification)> = Vec::new();
    for choice in fitted {
        let display = Display::new(0);
        let result = identify(
            &scene.spec_for(choice),
            &choice.modelling,
            models(),
            (time, force),
            &runner,
            |n, error| {
                display.message(&format!(
                    "{}: {n} integrations, force error {:.3} %",
                    choice.label,
                    100.0 * error
                ));
            },
        );
        drop(display);
        if interruption::requested() {
            return Err(Refusal::Interrupted);
        }
        let result = result.map_err(|e| match e {
            IdentifyError::Build(e) => Refusal::from(scene.locate_in(&choice.label, &e)),
            IdentifyError::Model(..) => Refusal::Input(miette::miette!("{e}")),
            other => Refusal::Failed(other.to_string()),
        })?;
        summarise(&choice.label, id, &result);
        found.push((choice.label.clone(), result));
    }
    folder.close();
    let models: Vec<_> = found.iter().map(|(label, r)| r.told(label)).collect();
    let answer = (Answer::done().with("reference", id)).with("models", models);
    if args.write {
        let path = absolute(write(&scene, &found, command)?);
        say(&format!("written: {}", path.display()));
        return Ok(answer.with("written", path));
    }
    say("nothing was written; `--write` stores the constants for `calibration = \"impact\"`");
    Ok(answer)
}

fn calibrated(choice: &scene_file::ModelChoice) -> bool {
    choice
        .calibration
        .as_ref()
        .is_some_and(|c| c.name == NAME && c.label == choice.label)
}

fn write(
    scene: &SceneFile,
    found: &[(String, Identification)],
    command: &str,
) -> Result<PathBuf, Refusal> {
    let path = scene.calibration_path();
    let fail = |e: &dyn std::fmt::Display| Refusal::Files(format!("{}: {e}", path.display()));
    // Calibrations of other names or labels stay as they are.
    let mut calibration = match std::fs::read_to_string(&path) {
        Ok(text) => Calibration::parse(&path.display().to_string(), &text)?,
        Err(_) => Calibration::default(),
    };
    calibration.header = vec![
        format!("Written by: {command}"),
        format!(
            "Reference: {}",
            scene.reference.as_deref().unwrap_or("none")
        ),
        format!("Commit {}, {}", machine::COMMIT, machine::now()),
    ];
    for (label, r) in found {
        let intervals: Vec<String> = r
            .parameters
            .iter()
            .map(|p| format!("{} {:.1} %", p.key, 100.0 * p.relative_95))
            .collect();
        calibration.header.push(format!(
            "{label}: relative L2 error of the force history {:.4}; 95 % intervals: {}",
            r.force_l2,
            intervals.join(", ")
        ));
        let constants = Constants::of(r.parameters.iter().map(|p| (p.key, p.value)));
        calibration
            .sets
            .entry(NAME.into())
            .or_default()
            .insert(label.clone(), constants);
    }
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
    if let Some(parent) = parent
        && !parent.is_dir()
    {
        return Err(Refusal::Files(format!(
            "{}: the folder does not exist; run this from the root of the repository for a shipped scene",
            parent.display()
        )));
    }
    let staged = path.with_extension("toml.part");
    std::fs::write(&staged, calibration.to_toml()).map_err(|e| fail(&e))?;
    std::fs::rename(&staged, &path).map_err(|e| fail(&e))?;
    Ok(path)
}
