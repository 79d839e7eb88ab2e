//! The command `gearbench fmu SCENE`, which packs a model of a scene as an FMU.

use super::arguments::Fmu;
use super::description::FmiVersion;
use super::interface::{Interface, Role};
use super::library;
use super::package::Package;
use super::settings::SETTINGS;
use crate::cli::command_result::CommandResult;
use crate::cli::files::{ReplaceableFiles, write_whole};
use crate::cli::terminal::{Refusal, absolute, refuse_run};
use crate::context::Context;
use crate::experiment::run::RunError;
use crate::fmu::coupled::Coupled;
use crate::scene_file::{self, ModelChoice, SceneError, SceneFile, Selection};
use gearbench_integrators::{Scheme, SecondOrderSystem};

pub(super) fn bad(why: impl Into<String>, help: impl Into<String>) -> Refusal {
    SceneError::plain(why, help).into()
}

/// Packs a model of a scene as an FMU and writes the file.
pub fn run(context: &Context, args: &Fmu) -> Result<CommandResult, Refusal> {
    let mut scene = scene_file::load_for(context, &args.scene, Selection::None)?;
    let label = choice(args, &scene)?.label.clone();
    scene.damp_unbuilt(&[&label])?;
    let choice = choice(args, &scene)?;
    let path = (args.out.clone()).unwrap_or_else(|| format!("{}.fmu", scene.name).into());
    let mut inputs = scene.inputs();
    inputs.extend(args.library.clone());
    inputs.extend(library::places());
    let overwriting = ReplaceableFiles {
        inputs: &inputs,
        // Names of files stand in an archive as they are.
        mark: Some(&format!("resources/{SETTINGS}")),
        force: args.force,
    };
    overwriting.check(&path)?;
    let scheme = scheme(args, &scene, choice)?;
    let mut coupled = Coupled::assemble(&scene, choice, &args.moved)?;
    if scheme.method.info().linear_part && coupled.scene.modal().is_none() {
        let (id, spec) = (scheme.method.id(), scene.spec_for(choice));
        let refused = RunError::no_linear_part(id, &coupled.scene, &spec);
        return Err(refuse_run(refused));
    }
    let version = match args.fmi {
        2 => FmiVersion::Two,
        _ => FmiVersion::Three,
    };
    let mut package = Package::of(&scene, choice, scheme, &args.moved, version)?;
    package.add_library(library::read(context, args.library.as_deref())?);
    let fail = |e: std::io::Error| Refusal::Files(format!("{}: {e}", path.display()));
    let archive = package.archive().map_err(fail)?;
    write_whole(&path, archive).map_err(fail)?;
    let path = absolute(path);
    context
        .messages
        .print_line(&format!("written: {}", path.display()));
    context
        .messages
        .print_line(&summary_line(&coupled.interface, version));
    Ok(CommandResult::done().with("written", path))
}

/// The requested model, or the first of the study.
fn choice<'a>(args: &Fmu, scene: &'a SceneFile) -> Result<&'a ModelChoice, Refusal> {
    let label = args.model.as_ref().or(scene.study.models.first());
    let choices = scene.select(label.map(String::as_str))?;
    match choices.as_slice() {
        [one] => Ok(one),
        _ => Err(bad(
            "several models are named",
            "an FMU contains one model: name one",
        )),
    }
}

/// The requested method, or the first of the model.
fn scheme(args: &Fmu, scene: &SceneFile, choice: &ModelChoice) -> Result<Scheme, Refusal> {
    let own = (choice.integrators.as_deref()).unwrap_or(&scene.study.integrators);
    let found = match &args.method {
        Some(text) => Scheme::list(text, own).map_err(|e| refuse_run(RunError::from(e)))?,
        None => own.first().copied().into_iter().collect(),
    };
    scene.check_steps(&found)?;
    match found.as_slice() {
        [one] => Ok(*one),
        _ => Err(bad(
            "one method is needed",
            "an FMU uses one integrator: name one, as in --method rk4@1us",
        )),
    }
}

/// Describes an interface in one line: number of inputs, outputs and continuous states, version and kinds of FMI.
fn summary_line(all: &Interface, version: FmiVersion) -> String {
    let count = |of: &dyn Fn(&Role) -> bool| {
        let roles = all.variables.iter().map(|v| v.role);
        roles.filter(of).count()
    };
    let inputs = count(&|r| matches!(r, Role::Input { end: false, .. }));
    let outputs = count(&|r| matches!(r, Role::Output(_)));
    let serves = match all.exchanges {
        true => format!(
            "co-simulation and model exchange, {} continuous states",
            all.states
        ),
        false => format!(
            "co-simulation; {} continuous states are too many for model exchange",
            all.states
        ),
    };
    let version = version.text();
    format!("{inputs} inputs, {outputs} outputs; FMI {version}: {serves}")
}
