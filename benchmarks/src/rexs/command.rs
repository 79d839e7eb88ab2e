//! The commands `gearbench import FILE` and `gearbench export SCENE --rexs FILE`.

use super::arguments::{ExportArguments, ImportArguments};
use super::import::ImportOptions;
use super::{export, import, read, write};
use crate::cli::command_result::CommandResult;
use crate::cli::files::{ReplaceableFiles, write_whole};
use crate::cli::terminal::{Refusal, absolute};
use crate::context::Context;
use crate::scene_file::{self, SceneError, Selection};
use gearbench_models::spec::FlankContact;
use std::path::Path;

/// First line of scenes that `import` wrote, by which it knows its own files.
const MARK: &str = "# Written by gearbench import";

/// Writes a file, unless it is one of another program.
fn put(
    path: &Path,
    text: &str,
    inputs: &[std::path::PathBuf],
    mark: &str,
    force: bool,
) -> Result<(), Refusal> {
    let overwriting = ReplaceableFiles {
        inputs,
        mark: Some(mark),
        force,
    };
    overwriting.check(path)?;
    write_whole(path, text).map_err(|e| Refusal::Files(format!("{}: {e}", path.display())))
}

/// A name for a scene from that of a file.
fn scene_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut name = String::new();
    for c in stem.to_lowercase().chars() {
        match c {
            'a'..='z' | '0'..='9' | '_' => name.push(c),
            _ if !name.ends_with('-') && !name.is_empty() => name.push('-'),
            _ => {}
        }
    }
    match name.trim_end_matches('-') {
        "" => "imported".into(),
        name => name.into(),
    }
}

/// Reads a model of REXS and writes it as a scene.
pub fn import(context: &Context, args: &ImportArguments) -> Result<CommandResult, Refusal> {
    let model = read::read(&args.file)?;
    let out = args.out.clone();
    let out = out.unwrap_or_else(|| format!("{}.toml", scene_name(&args.file)).into());
    let options = ImportOptions {
        rigid_shafts: args.rigid_shafts,
        bearings: args.bearings,
        load_case: args.load_case,
    };
    let found = import::scene(context, &model, &scene_name(&out), &options)
        .map_err(|e| located(&args.file, &e))?;
    let text = found.scene.to_toml();
    let text = text.map_err(|e| SceneError::plain(e.to_string(), "report this"))?;
    let text = format!("{MARK}\n{text}");
    put(
        &out,
        &text,
        std::slice::from_ref(&args.file),
        MARK,
        args.force,
    )?;
    let path = absolute(out);
    let messages = &context.messages;
    messages.print_line(&format!("written: {}", path.display()));
    for line in found.report.to_text().lines() {
        messages.print_line(line);
    }
    Ok(CommandResult::done()
        .with("written", path)
        .with("taken", &found.report.taken)
        .with("assumed", &found.report.assumed)
        .with("left", &found.report.left)
        .with("centre_distance_errors_m", &found.distances))
}

/// An error with the name of the file.
fn located(file: &Path, e: &SceneError) -> Refusal {
    let help = e.help_text().unwrap_or_default().to_owned();
    SceneError::plain(format!("{}: {}", file.display(), e.message()), help).into()
}

/// Writes a scene as a model of REXS.
pub fn export(context: &Context, args: &ExportArguments) -> Result<CommandResult, Refusal> {
    let scene = scene_file::load_for(
        context,
        &args.scene,
        Selection::Labels(args.model.as_deref()),
    )?;
    let choices = scene.select(args.model.as_deref())?;
    let is_lawful = |c: &&&scene_file::ModelChoice| {
        let mut contacts = c.modelling.contacts.iter();
        contacts.all(|c| c.flanks == FlankContact::Toothing)
    };
    let choice = choices.iter().find(is_lawful).or(choices.first());
    let choice = choice.ok_or_else(|| SceneError::plain("the scene has no model", "add one"))?;
    let found = export::model(&scene, choice)?;
    let is_json = args
        .rexs
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("rexsj"));
    let text = match is_json {
        true => write::to_json(&found.model),
        false => write::to_xml(&found.model),
    };
    let inputs = scene.inputs();
    put(&args.rexs, &text, &inputs, "gearbench", args.force)?;
    let path = absolute(args.rexs.clone());
    let messages = &context.messages;
    messages.print_line(&format!(
        "written: {} (stiffness of {})",
        path.display(),
        choice.label
    ));
    for line in &found.left {
        messages.print_line(&format!("left: {line}"));
    }
    Ok(CommandResult::done()
        .with("written", path)
        .with("model", &choice.label)
        .with("left", &found.left))
}
