//! `gearbench identify SCENE`: constants fitted to the scene's reference, printed and, on request, written.

use super::arguments::Identify;
use super::summary::summarise;
use super::{Identification, IdentifyError, StaticTarget, Target, identify};
use crate::cli::answer::Answer;
use crate::cli::progress::Display;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, absolute, references_of, refuse_study, say};
use crate::experiment::conditions::silent;
use crate::experiment::error::StudyError;
use crate::experiment::interruption;
use crate::experiment::machine;
use crate::models::models;
use crate::scene_file::calibration::{Constants, FittedTo};
use crate::scene_file::{self, Calibration, SceneFile, Selection};
use gearbench_models::gear::table::properties_of;
use gearbench_models::spec::mesh_layout;
use gearbench_reference::data::Reference;
use std::path::PathBuf;

/// Positions of a mesh cycle that statics are fitted at.
const POSITIONS: usize = 24;

/// Fits the models of a scene that have something to fit.
pub fn run(args: &Identify, command: &str) -> Result<Answer, Refusal> {
    // What is identified is built by its fits; statics leave all constants but one as the impact has them.
    let mut scene = match args.to.to_history() {
        true => scene_file::load_uncalibrated(&args.scene, Selection::None)?,
        false => scene_file::load_for(&args.scene, Selection::None)?,
    };
    let reference = match args.to.to_history() {
        true => Some(history_of(&mut scene, args)?),
        false => None,
    };
    // Beyond the scene's duration the reference may lack what the scene has, as the other flanks.
    let history = reference.as_ref().and_then(Reference::force);
    let history = history.map(|(time, force)| {
        let n = time.partition_point(|&t| t <= scene.duration);
        (&time[..n], &force[..n])
    });
    let named = scene.reference().filter(|_| reference.is_some());
    let mut names: Vec<String> = (named.iter())
        .map(|r| r.stored().unwrap_or(&r.name).to_owned())
        .collect();
    let statics = match args.to.to_statics() {
        true => {
            let (label, target) = statics_of(&scene, args)?;
            names.push(format!("`{label}` at rest under {} N/mm", args.load));
            Some(target)
        }
        false => None,
    };
    let target = Target { history, statics };
    let id = names.join(" and ");

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
            &target,
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
        summarise(&choice.label, &id, &result);
        found.push((choice.label.clone(), result));
    }
    folder.close();
    let models: Vec<_> = found.iter().map(|(label, r)| r.told(label)).collect();
    let answer = (Answer::done().with("reference", &id)).with("models", models);
    if args.write {
        let path = absolute(write(&scene, (args.to, &id), &found, command)?);
        say(&format!("written: {}", path.display()));
        return Ok(answer.with("written", path));
    }
    say(&format!(
        "nothing was written; `--write` stores the constants for `calibration = \"{}\"`",
        args.to.as_str()
    ));
    Ok(answer)
}

fn calibrated(choice: &scene_file::ModelChoice) -> bool {
    (choice.calibration.as_ref()).is_some_and(|c| c.label == choice.label)
}

/// The reference whose history is fitted.
fn history_of(scene: &mut SceneFile, args: &Identify) -> Result<Reference, Refusal> {
    let references = references_of(scene, &args.insist)?;
    if let Some(reference) = references.into_iter().find(|r| r.force().is_some()) {
        return Ok(reference);
    }
    let way_out = match scene.fitting() {
        Some(fitting) => format!("give it a line `{fitting}`"),
        None => "no stored reference is of these gears, speeds and loads: `gearbench list`".into(),
    };
    Err(Refusal::Input(miette::miette!(
        help = way_out,
        "the scene `{}` has no reference to identify against",
        scene.name
    )))
}

/// The model at rest that is fitted, and its compliances.
fn statics_of(scene: &SceneFile, args: &Identify) -> Result<(String, StaticTarget), Refusal> {
    let choice = match &args.against {
        Some(label) => scene.select(Some(label))?.into_iter().next(),
        None => (scene.models.iter()).find(|c| properties_of(models(), &c.model).full_order),
    };
    let Some(choice) = choice else {
        return Err(Refusal::Input(miette::miette!(
            help = "give the scene a model of finite elements, or name another with --against",
            "the scene `{}` has no model whose statics could be fitted",
            scene.name
        )));
    };
    let spec = scene.spec_for(choice);
    let [a, b] = spec.meshes[0].gears.map(|i| &spec.gears[i]);
    let layout = mesh_layout(a, b).map_err(|e| Refusal::Failed(e.to_string()))?;
    let force = 1e3 * args.load * layout.face_width;
    let target = StaticTarget::of((&spec, &choice.modelling), models(), force, POSITIONS);
    let fail = |e| refuse_study(scene, StudyError::Statics(choice.label.clone(), e));
    Ok((choice.label.clone(), target.map_err(fail)?))
}

fn write(
    scene: &SceneFile,
    (to, reference): (FittedTo, &str),
    found: &[(String, Identification)],
    command: &str,
) -> Result<PathBuf, Refusal> {
    let path = scene.calibration_path();
    let fail = |e: &dyn std::fmt::Display| Refusal::Files(format!("{}: {e}", path.display()));
    // Calibrations of other names or labels stay as they are.
    let mut calibration = match std::fs::read_to_string(&path) {
        Ok(text) => {
            let mut calibration = Calibration::parse(&path.display().to_string(), &text)?;
            let comments = text.lines().map_while(|l| l.strip_prefix('#'));
            calibration.header = comments.map(|l| l.trim().to_owned()).collect();
            calibration
        }
        Err(_) => Calibration::default(),
    };
    // Every line of the header says which calibration it is of.
    let own = |line: String| format!("{}: {line}", to.as_str());
    let tag = own(String::new());
    calibration
        .header
        .retain(|l| !l.starts_with(tag.trim_end()));
    calibration.header.extend([
        own(format!("written by {command}")),
        own(format!("fitted to {reference}; for {}", to.holds_for())),
        own(format!("commit {}, {}", machine::COMMIT, machine::now())),
    ]);
    for (label, r) in found {
        let intervals: Vec<String> = r
            .parameters
            .iter()
            .map(|p| format!("{} {:.1} %", p.key, 100.0 * p.relative_95))
            .collect();
        let errors = [
            ("force history", r.force_l2),
            ("static compliance", r.static_l2),
        ];
        let errors = errors
            .into_iter()
            .filter_map(|(what, e)| Some(format!("{what} {:.4}", e?)));
        calibration.header.push(own(format!(
            "{label}: relative L2 error of the {}; 95 % intervals: {}",
            errors.collect::<Vec<_>>().join(", of the "),
            intervals.join(", ")
        )));
        let mut constants = Constants::of(r.parameters.iter().map(|p| (p.key, p.value)));
        // What was not fitted stays as the calibration that the model asks for has it.
        let before = scene
            .model(label)
            .and_then(|c| c.calibration.as_ref()?.constants.clone());
        for (key, x) in before.map(|b| b.parameters).unwrap_or_default() {
            constants.parameters.entry(key).or_insert(x);
        }
        calibration
            .sets
            .entry(to.as_str().into())
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
