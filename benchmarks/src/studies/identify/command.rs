//! `gearbench identify SCENE`: constants fitted to the scene's references, reported and, on request, written.

use super::arguments::{Identify, WriteTarget};
use super::parameters::{FitOptions, has_key, largest_gap, path_of};
use super::scene_update::{FittedConstants, write_scene};
use super::summary::summarise;
use super::write::{errors_and_intervals, write};
use super::{
    Data, DataSet, FitPlan, Identification, IdentifyError, StaticTarget, default_method,
    histories as histories_of_fit, identify,
};
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::progress::Display;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, absolute, integrators_of, refuse_study};
use crate::context::Context;
use crate::experiment::conditions::{Conditions, silent};
use crate::experiment::configuration::Configuration;
use crate::experiment::error::StudyError;
use crate::experiment::reference_series::channel_of;
use crate::experiment::runner::WorkError;
use crate::experiment::settings::settings;
use crate::scene_file::references::{LoadedReference, subjects};
use crate::scene_file::{self, ModelChoice, SceneFile, Selection, did_you_mean};
use gearbench_integrators::Scheme;
use gearbench_models::spec::{SceneSpec, mesh_layout};
use gearbench_reference::data::{Channel, Quantity, Reference};
use gearbench_reports::Study;
use gearbench_reports::identify::IdentifyRecord;
use gearbench_reports::record::{Part, Run};
use serde_json::json;

/// Positions of a mesh cycle that statics are fitted at.
const POSITIONS: usize = 24;

/// Fits the models of a scene that have constants to fit, and writes the folder.
pub fn run(context: &Context, args: &Identify, command: &str) -> Result<CommandResult, Refusal> {
    // What is identified is built by its fits; statics leave all constants but one as the impact has them.
    let mut scene = match args.to.to_history() {
        true => scene_file::load_uncalibrated(context, &args.scene, Selection::None)?,
        false => scene_file::load_for(context, &args.scene, Selection::None)?,
    };
    let references = match args.to.to_history() {
        true => histories_of(&mut scene, args)?,
        false => Vec::new(),
    };
    let statics = match args.to.to_statics() {
        true => Some(statics_of(&scene, args)?),
        false => None,
    };
    let method = match integrators_of(&scene, args.integrator.as_deref())?.as_deref() {
        None => default_method(),
        Some([one]) => *one,
        Some(several) => {
            return Err(Refusal::Input(miette::miette!(
                help = "give one method, for example --integrator dopri5@1e-8",
                "a fit has one integrator, but {} are given",
                several.len()
            )));
        }
    };
    let choices = scene.select(args.model.as_deref())?;
    if let (Some(WriteTarget::Calibration), Some(key)) = (args.write, keys_of_scene(args).next()) {
        return Err(Refusal::Input(miette::miette!(
            help = "write it with --write=scene",
            "`{key}` is a key of the scene, and a calibration has constants of models alone"
        )));
    }
    let alone = args.fit.is_some() && keys_of_scene(args).count() > 0;
    let fitted: Vec<&ModelChoice> = (choices.into_iter())
        .filter(|c| {
            let has_recipe = scene.properties_of(&c.model).fit.is_some();
            args.model.is_some() || alone || (has_recipe && calibrated(c))
        })
        .collect();
    if fitted.is_empty() {
        return Err(Refusal::Input(miette::miette!(
            help = "a model is fitted if it has a line calibration = \"impact\"",
            "the scene `{}` has no model to calibrate",
            scene.name
        )));
    }
    let labels: Vec<String> = fitted.iter().map(|c| c.label.clone()).collect();
    let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
    if args.to.to_history() {
        scene.damp_unbuilt(&labels)?;
    }
    let fitted: Vec<&ModelChoice> = labels.iter().filter_map(|l| scene.model(l)).collect();
    let mut folder = StudyFolder::of(&args.output, &scene, Study::Identify.as_str())?;
    let runner = folder.runner(&silent);
    let mut found: Vec<(&ModelChoice, Identification)> = Vec::new();
    let mut refused: Vec<(&ModelChoice, WorkError<IdentifyError>)> = Vec::new();
    let mut names = String::new();
    let held = held_by_model(&scene, &fitted, args);
    for (choice, held) in fitted.iter().zip(held) {
        let plan = plan(
            &scene,
            choice,
            (&references, &statics),
            (args, held),
            method,
        );
        let all: Vec<&str> = plan.data.iter().map(|d| d.name.as_str()).collect();
        names = all.join(" and ");
        let display = Display::of(context, 0);
        let fit = || {
            identify(&plan, &runner, |n, error| {
                display.message(&format!(
                    "{}: {n} trials, error {:.3} %",
                    choice.label,
                    100.0 * error
                ));
            })
        };
        match runner.attempt(fit) {
            Ok(_) | Err(WorkError::Interrupted) if context.interruption.is_requested() => break,
            Ok(fit) => found.push((choice, fit)),
            Err(why) => refused.push((choice, why)),
        }
        drop(display);
    }
    let mut histories = Vec::new();
    if !args.output.measured.is_empty() {
        for (choice, found) in &found {
            let made = histories_of_fit(&scene, choice, found, &runner);
            for history in made.map_err(|e| refuse_study(&scene, e.into()))? {
                match history {
                    Ok(history) => histories.push(history),
                    Err(why) => context.messages.warn(&why),
                }
            }
        }
    }
    drop(runner);
    // Where no model is fitted the study has no result: the first reason is its refusal.
    let none = found.is_empty() && !context.interruption.is_requested();
    for (choice, why) in refused {
        let error = |e| folder.refuse(refuse(&scene, choice, e));
        let (status, why) = match why {
            WorkError::Error(e) if none => return Err(error(e)),
            why => why.row().map_err(error)?,
        };
        if none {
            return Err(Refusal::Failed(why));
        }
        context.messages.warn(&format!(
            "the model `{}` is not fitted, unlike the others: {why}",
            choice.label
        ));
        let row = Configuration::of(&scene, choice).refused(why);
        folder.add_refused(Run { status, ..row });
    }
    let conditions = Conditions {
        command: command.to_owned(),
        settings: settings(&scene, &fitted, false),
        ..Conditions::of(&scene)
    };
    let fits: Vec<_> = found.iter().map(|(_, f)| f.record.clone()).collect();
    let told: Vec<_> = fits.iter().map(fit_to_json).collect();
    let results = conditions.record(Part::Identify(IdentifyRecord { fits, histories }));
    let answer = folder.finish(results, |_| Exit::Done, summarise)?;
    let answer = answer.with("reference", &names).with("models", told);
    if context.interruption.is_requested() {
        context.messages.print_line("no constants were written");
        return Ok(answer);
    }
    if let Some(to) = args.write {
        let path = match to {
            WriteTarget::Calibration => write(
                &scene,
                (args.to, &names),
                &found,
                command,
                args.output.force,
            ),
            WriteTarget::Scene => write_scene(&scene, &into_scene(&found, args, command)),
        };
        let path = absolute(path?);
        context
            .messages
            .print_line(&format!("written: {}", path.display()));
        return Ok(answer.with("written", path));
    }
    context.messages.print_line(&format!(
        "no constants were written; `--write` stores the constants for `calibration = \"{}\"`, `--write=scene` in the scene file",
        args.to.as_str()
    ));
    Ok(answer)
}

/// Returns the constants that are written into the scene file. A constant that was not fitted keeps its value in the
/// calibration of the model.
fn into_scene<'a>(
    found: &[(&'a ModelChoice, Identification)],
    args: &Identify,
    command: &str,
) -> Vec<FittedConstants<'a>> {
    let of = |(choice, found): &(&'a ModelChoice, Identification)| {
        let constants = if args.output.force {
            found.all.clone()
        } else {
            found.constants()
        };
        let older = (choice.calibration.as_ref()).and_then(|c| c.stored.as_ref());
        let data: Vec<String> = (found.data.iter())
            .map(|(name, key)| format!("{name} (data {key})"))
            .collect();
        FittedConstants {
            choice,
            constants: older.map_or(constants.clone(), |older| constants.merged_with(older)),
            keys: (found.keys.iter())
                .filter(|(_, _, known)| *known || args.output.force)
                .map(|(key, x, _)| (key.clone(), *x))
                .collect(),
            told: vec![
                format!("written by {command}"),
                format!(
                    "fitted to {}; for {}",
                    data.join(" and "),
                    args.to.holds_for()
                ),
                errors_and_intervals(&found.record),
            ],
        }
    };
    found.iter().map(of).collect()
}

/// Returns a fit as JSON, for programs.
fn fit_to_json(fit: &gearbench_reports::identify::FitRecord) -> serde_json::Value {
    let data = |d: &gearbench_reports::identify::DataRecord| {
        json!({
            "name": d.name, "kind": d.kind, "validation": d.validation, "l2": d.l2,
            "peak_rel": d.peak_rel, "impulse_rel": d.impulse_rel,
        })
    };
    json!({
        "model": fit.label,
        "evaluations": fit.evaluations,
        "parameters": fit.parameters,
        "undetermined": fit.undetermined,
        "data": fit.data.iter().map(data).collect::<Vec<_>>(),
    })
}

/// Returns the fixed parameters of each model: those that it has. A parameter that no model has stays with all of them,
/// which then refuse it.
fn held_by_model(
    scene: &SceneFile,
    fitted: &[&ModelChoice],
    args: &Identify,
) -> Vec<Vec<(String, f64)>> {
    let has = |choice: &ModelChoice, key: &str| {
        has_key(
            key,
            &choice.model,
            (
                &scene.spec_for(choice),
                &choice.modelling,
                &scene.context.models,
            ),
        )
    };
    let of = |choice: &&ModelChoice| {
        let taken = |(key, _): &&(String, f64)| {
            has(choice, key) || !fitted.iter().any(|other| has(other, key))
        };
        args.hold.iter().filter(taken).cloned().collect()
    };
    let held: Vec<Vec<(String, f64)>> = fitted.iter().map(of).collect();
    for (choice, held) in fitted.iter().zip(&held) {
        for (key, _) in args.hold.iter().filter(|h| !held.contains(h)) {
            scene.context.messages.print_line(&format!(
                "--hold {key} does not apply to `{}`, which has no such parameter",
                choice.label
            ));
        }
    }
    held
}

/// Keys of the scene among the parameters of the fit.
fn keys_of_scene(args: &Identify) -> impl Iterator<Item = &String> {
    let all = args.fit.iter().flatten();
    all.filter(|key| path_of(key).is_some())
}

fn calibrated(choice: &ModelChoice) -> bool {
    (choice.calibration.as_ref()).is_some_and(|c| c.label == choice.label)
}

/// Returns the name of a reference.
fn name_of(held: &LoadedReference) -> &str {
    held.named.stored().unwrap_or(&held.named.name)
}

/// Part of the largest contact force of a reference from which on the force of a mesh is fitted.
const LOADED: f64 = 1e-3;

/// Returns the histories of a reference that are fitted: the contact forces of all loaded meshes, else all others that runs
/// have.
fn channels_of(reference: &Reference) -> Vec<&Channel> {
    let all = || reference.channels.iter();
    let peak = |c: &Channel| c.value.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let forces = || all().filter(|c| matches!(c.quantity, Quantity::Force(_)));
    let most = forces().map(peak).fold(0.0, f64::max);
    let loaded: Vec<&Channel> = forces().filter(|c| peak(c) >= LOADED * most).collect();
    match loaded.is_empty() {
        false => loaded,
        true => all().filter(|c| channel_of(c.quantity).is_some()).collect(),
    }
}

/// Returns the plan of the fit of a model: data to fit, and data with which the fitted model is compared.
fn plan(
    scene: &SceneFile,
    choice: &ModelChoice,
    (references, statics): (&[LoadedReference], &Option<(String, StaticTarget)>),
    (args, held): (&Identify, Vec<(String, f64)>),
    method: Scheme,
) -> FitPlan {
    let spec: SceneSpec = scene.spec_for(choice);
    let gap = |scene: &SceneFile| largest_gap(&scene.spec).unwrap_or(0.0);
    let of_channel = |reference: &LoadedReference, channel: &Channel, several: bool| {
        let own = &reference.scene;
        // Beyond the duration of the scene the reference may lack effects that the scene has, such as contact of the
        // other flanks.
        let n = channel.time.partition_point(|&t| t <= own.duration);
        let name = name_of(reference);
        let weight = args.weight.iter().find(|(of, _)| of == name);
        let full_name = match several {
            true => format!("{name}, {}", subjects(&own.spec).told(channel.quantity)),
            false => name.to_owned(),
        };
        let data = Data::History {
            quantity: channel.quantity,
            time: channel.time[..n].to_vec(),
            values: channel.value[..n].to_vec(),
        };
        DataSet {
            further_gap: gap(own) - gap(scene),
            weight: weight.map_or(1.0, |w| w.1),
            peak_weight: args.peak_weight,
            conditions: reference.named.conditions.clone(),
            recorder: name.to_owned(),
            ..DataSet::of(&full_name, &own.spec_for(choice), data)
        }
    };
    let of_reference = |reference: &&LoadedReference| -> Vec<DataSet> {
        let channels = channels_of(&reference.data);
        let several = channels.len() > 1;
        let channels = channels.into_iter();
        channels
            .map(|channel| of_channel(reference, channel, several))
            .collect()
    };
    let (held_out, fitted): (Vec<&LoadedReference>, Vec<&LoadedReference>) =
        references.iter().partition(|r| r.is_held_out());
    let statics = statics.as_ref().map(|(label, target)| DataSet {
        weight: args.static_weight,
        ..DataSet::statics(
            &format!("`{label}` at rest under {} N/mm", args.load),
            &spec,
            target.clone(),
        )
    });
    FitPlan {
        label: choice.label.clone(),
        modelling: choice.modelling.clone(),
        data: (fitted.iter().flat_map(of_reference))
            .chain(statics)
            .collect(),
        held_out: held_out.iter().flat_map(of_reference).collect(),
        method,
        scene: scene.clone(),
        wishes: FitOptions {
            fit: args.fit.clone(),
            held,
            starts: args.start.clone(),
            bounds: args.bounds.clone(),
            scattered: args.starts.into(),
            profiles: args.profiles,
        },
    }
}

fn refuse(scene: &SceneFile, choice: &ModelChoice, e: IdentifyError) -> Refusal {
    match e {
        IdentifyError::Build(e) => Refusal::from(scene.locate_in(&choice.label, &e)),
        IdentifyError::Journal(e) => e.into(),
        e if e.is_of_wishes() => Refusal::Input(miette::miette!("{e}")),
        other => Refusal::Failed(other.to_string()),
    }
}

/// Returns the references whose histories are fitted or held out, at least one to fit.
fn histories_of(scene: &mut SceneFile, args: &Identify) -> Result<Vec<LoadedReference>, Refusal> {
    let known = scene.odd.len();
    let mut references = scene.load_references(args.insist.any_reference)?;
    (scene.odd[known..].iter()).for_each(|odd| scene.context.messages.warn(&odd.to_text()));
    references.retain(|held| !channels_of(&held.data).is_empty());
    let fitted = || references.iter().filter(|held| !held.is_held_out());
    let names: Vec<&str> = fitted().map(name_of).collect();
    if let Some((other, _)) = (args.weight.iter()).find(|(of, _)| !names.contains(&of.as_str())) {
        return Err(Refusal::Input(miette::miette!(
            help = format!(
                "{}there are {}",
                did_you_mean(other, &names),
                names.join(", ")
            ),
            "`{other}` has a weight but is not a reference of the fit"
        )));
    }
    if !names.is_empty() {
        return Ok(references);
    }
    let way_out = match scene.fitting() {
        Some(fitting) => format!("add a line `{fitting}`"),
        None => format!(
            "add measured or computed data, `reference = {{ csv = \"press.csv\" }}`, or compute a reference: `gearbench \
             reference {} --model fe --out fe.csv --add`; no stored reference belongs to these gears, speeds and loads \
             (`gearbench list references`)",
            args.scene
        ),
    };
    Err(Refusal::Input(miette::miette!(
        help = way_out,
        "the scene `{}` has no reference for the fit",
        scene.name
    )))
}

/// The model at rest that is fitted, and its compliances.
fn statics_of(scene: &SceneFile, args: &Identify) -> Result<(String, StaticTarget), Refusal> {
    let choice = match &args.against {
        Some(label) => scene.select(Some(label))?.into_iter().next(),
        None => (scene.models.iter()).find(|c| scene.properties_of(&c.model).full_order),
    };
    let Some(choice) = choice else {
        return Err(Refusal::Input(miette::miette!(
            help = "give the scene a model of finite elements, or name another with --against",
            "the scene `{}` has no model of finite elements for static data",
            scene.name
        )));
    };
    let spec = scene.spec_for(choice);
    let [a, b] = spec.meshes[0].gears.map(|i| &spec.gears[i]);
    let layout = mesh_layout(a, b).map_err(|e| Refusal::Failed(e.to_string()))?;
    let force = 1e3 * args.load * layout.face_width;
    let target = StaticTarget::of(
        (&spec, &choice.modelling),
        &scene.context.models,
        force,
        POSITIONS,
    );
    let fail = |e| refuse_study(scene, StudyError::Statics(choice.label.clone(), e));
    Ok((choice.label.clone(), target.map_err(fail)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reference is fitted by the forces of all of its loaded meshes, without forces by its motions.
    #[test]
    fn forces_of_all_loaded_meshes_are_fitted() {
        let channel = |(quantity, peak): (Quantity, f64)| Channel {
            quantity,
            time: vec![0.0, 1e-3],
            value: vec![0.0, peak],
        };
        let fitted = |channels: &[(Quantity, f64)]| -> Vec<Quantity> {
            let reference = Reference {
                channels: channels.iter().copied().map(channel).collect(),
                ..Reference::default()
            };
            channels_of(&reference).iter().map(|c| c.quantity).collect()
        };
        let (force, speed) = (Quantity::Force, Quantity::Speed(1));
        let all = [
            (speed, 9.0),
            (force(0), 0.5),
            (force(1), 1000.0),
            (force(2), 800.0),
        ];
        assert_eq!(fitted(&all), [force(1), force(2)]);
        assert_eq!(fitted(&all[..1]), [speed]);
        assert_eq!(fitted(&[(force(1), 0.0)]), [force(1)]);
    }
}
