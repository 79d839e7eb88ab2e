//! The command `gearbench fmu SCENE`, which packs a model of a scene as an FMU.

use super::arguments::Fmu;
use super::interface::{Interface, Role};
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
use std::path::{Path, PathBuf};

fn bad(why: impl Into<String>, help: impl Into<String>) -> Refusal {
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
    inputs.extend(places(&library_name()));
    let overwriting = ReplaceableFiles {
        inputs: &inputs,
        // Names of files stand in an archive as they are.
        mark: Some(&format!("resources/{SETTINGS}")),
        force: args.force,
    };
    overwriting.check(&path)?;
    let scheme = scheme(args, &scene, choice)?;
    let library = library(args)?;
    let mut coupled = Coupled::assemble(&scene, choice, &args.moved)?;
    if scheme.method.info().linear_part && coupled.scene.modal().is_none() {
        let (id, spec) = (scheme.method.id(), scene.spec_for(choice));
        let refused = RunError::no_linear_part(id, &coupled.scene, &spec);
        return Err(refuse_run(refused));
    }
    let mut package = Package::of(&scene, choice, scheme, &args.moved)?;
    package.add_library(library);
    let fail = |e: std::io::Error| Refusal::Files(format!("{}: {e}", path.display()));
    let archive = package.archive().map_err(fail)?;
    write_whole(&path, archive).map_err(fail)?;
    let path = absolute(path);
    context
        .messages
        .print_line(&format!("written: {}", path.display()));
    context
        .messages
        .print_line(&summary_line(&coupled.interface));
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

/// Name of the shared library on this system.
fn library_name() -> String {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    format!("{DLL_PREFIX}gearbench_fmu{DLL_SUFFIX}")
}

/// Reads the shared library from its path, from the folder of this program or from `../lib`.
fn library(args: &Fmu) -> Result<Vec<u8>, Refusal> {
    let name = library_name();
    let build = format!(
        "`{name}` is part of gearbench: put it into the folder of this program, or name it with --library; in a checkout of \
         gearbench `cargo build --release -p gearbench-fmu` makes target/release/{name}"
    );
    let path = match &args.library {
        Some(path) => path.clone(),
        None => {
            let places = places(&name);
            let found = places.iter().find(|path| path.is_file());
            let shown: Vec<String> = places.iter().map(|p| p.display().to_string()).collect();
            let missing = format!(
                "an FMU needs the shared library `{name}`, which is neither {}",
                shown.join(" nor ")
            );
            found.cloned().ok_or_else(|| bad(missing, build.clone()))?
        }
    };
    std::fs::read(&path).map_err(|e| {
        bad(
            format!(
                "the shared library of gearbench-fmu, {}: {e}",
                path.display()
            ),
            build,
        )
    })
}

/// Paths at which the library of an installed program may be.
fn places(name: &str) -> Vec<PathBuf> {
    let program = std::env::current_exe().ok();
    let folder = program.as_deref().and_then(Path::parent);
    folder.map_or_else(Vec::new, |folder| {
        let lib = folder.parent().map(|p| p.join("lib").join(name));
        [Some(folder.join(name)), lib]
            .into_iter()
            .flatten()
            .collect()
    })
}

/// Describes an interface in one line: number of inputs, outputs and continuous states, and the kinds of FMI that it
/// supports.
fn summary_line(all: &Interface) -> String {
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
    format!("{inputs} inputs, {outputs} outputs; {serves}")
}
