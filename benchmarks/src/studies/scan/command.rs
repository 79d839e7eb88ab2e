//! `gearbench scan SCENE`: many scenes that differ in some keys.

use super::arguments::Scan;
use super::design::Design;
use super::output::Output;
use super::plan::{Plan, default_method, part_of};
use super::results::summarise_table;
use super::run::{study, write_tables};
use super::summary::summarise;
use super::table::TableError;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, integrators_of};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::key::Key;
use crate::experiment::machine;
use crate::experiment::parallel::thread_count;
use crate::experiment::settings::settings;
use crate::scene_file::{self, ModelChoice, SceneError, SceneFile, Selection};
use gearbench_reports::Study;
use gearbench_reports::record::{Results, Source};
use gearbench_reports::scan::ScanIdentity;
use std::path::Path;

impl From<TableError> for Refusal {
    fn from(e: TableError) -> Self {
        Refusal::Files(e.to_string())
    }
}

/// Loads the scene with the models that a scan runs.
fn load(context: &Context, args: &Scan) -> Result<SceneFile, SceneError> {
    let wanted = args.models.as_ref().map(|models| match &args.against {
        Some(label) => format!("{models},{label}"),
        None => models.clone(),
    });
    scene_file::load_for(context, &args.scene, Selection::Labels(wanted.as_deref()))
}

/// Returns what the cells of a scan are computed from, without running any: the records of all its parts have the same.
///
/// # Errors
/// As those of [`run`] before its first cell.
pub fn identity(context: &Context, args: &Scan) -> Result<ScanIdentity, Refusal> {
    Ok(plan(&load(context, args)?, args, "")?.identity)
}

/// Runs the scan, or a part of it, and writes its folder.
pub fn run(context: &Context, args: &Scan, command: &str) -> Result<CommandResult, Refusal> {
    let scene = load(context, args)?;
    let plan = plan(&scene, args, command)?;
    // A key or a listed value that the scene refuses is refused before anything runs.
    if !plan.cells().is_empty() {
        plan.scene_of(plan.cells().start)?;
    }
    let mut folder = StudyFolder::of(&args.run.output, &scene, Study::Scan.as_str())?;
    let threads = thread_count(args.threads);
    let cells = plan.cells();
    let total = cells.end - cells.start;
    let made = folder.run(total as usize, |runner| study(&plan, runner, threads));
    let finished = made.map_err(Refusal::from)?;
    if context.interruption.is_requested() || finished.len() < total {
        return Err(folder.interrupted());
    }
    write_tables(&plan, folder.path(), finished)?;
    let mut results = plan.record();
    summarise_table(&mut results, &plan.design, folder.path())?;
    finish(&folder, results)
}

/// Writes the record of a scan, and returns the result of the command.
pub fn finish(folder: &StudyFolder, results: Results) -> Result<CommandResult, Refusal> {
    folder.finish(results, exit, summarise)
}

/// Failed runs are results of a scan; it has failed if there is no other.
fn exit(results: &Results) -> Exit {
    match results.scan() {
        Some(scan) if scan.runs() > 0 && scan.failed() == scan.runs() => Exit::FailedRun,
        _ => Exit::Done,
    }
}

fn plan<'a>(scene: &'a SceneFile, args: &Scan, command: &str) -> Result<Plan<'a>, Refusal> {
    let design = args
        .design()
        .map_err(|e| SceneError::plain(e, "`gearbench scan --help` has examples"))?;
    let yardstick = args.against.as_deref();
    let mut choices: Vec<&ModelChoice> = match yardstick {
        Some(label) => scene.select(Some(label))?,
        None => Vec::new(),
    };
    if choices.len() > 1 {
        let why = "--against names several models";
        return Err(SceneError::plain(
            why,
            "name one model, whose run the others are compared with",
        )
        .into());
    }
    for choice in scene.select(args.models.as_deref())? {
        if !choices.iter().any(|c| c.label == choice.label) {
            choices.push(choice);
        }
    }
    let outputs = outputs(args, scene)?;
    let methods = integrators_of(scene, args.integrators.as_deref())?;
    let mut runs = Vec::new();
    for (i, choice) in choices.iter().enumerate() {
        let entry = Configuration::of(scene, choice);
        let own = default_method(scene, &entry);
        let is_yardstick = i == 0 && yardstick.is_some();
        // The yardstick keeps its own integrator.
        let all = match (&methods, is_yardstick) {
            (Some(methods), false) => methods.clone(),
            _ => own.into_iter().collect(),
        };
        if all.is_empty() {
            let why = format!("no integrator is known for the model `{}`", choice.label);
            return Err(SceneError::plain(
                why,
                "name one with --integrators, for example dopri5@1e-6",
            )
            .into());
        }
        runs.extend(all.into_iter().map(|method| (choice.label.clone(), method)));
    }
    let texts = |all: &mut dyn Iterator<Item = String>| all.collect::<Vec<_>>().join(" ");
    let arguments = format!(
        "vary {}; {}; runs {}; outputs {}; against {}; timeout {} s",
        texts(&mut design.axes().iter().map(|a| format!("[{a}]"))),
        design_text(&design),
        texts(
            &mut runs
                .iter()
                .map(|(label, method)| format!("[{label}, {method}]"))
        ),
        texts(&mut outputs.iter().map(Output::key)),
        yardstick.unwrap_or("none"),
        args.run.timeout
    );
    let shard = args.shard.map(|part| part_of(design.cells(), part));
    Ok(Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: settings(scene, &choices, false),
            ..Conditions::of(scene)
        },
        scene,
        document: (scene.text().parse())
            .map_err(|e: toml_edit::TomlError| Refusal::Files(e.to_string()))?,
        runs,
        has_yardstick: yardstick.is_some(),
        outputs,
        identity: ScanIdentity {
            program: format!("{} {}", env!("CARGO_PKG_VERSION"), machine::commit()),
            scene: hash_of(scene.source()),
            arguments,
        },
        shard,
        timeout: args.run.timeout(),
        design,
    })
}

fn design_text(design: &Design) -> String {
    match design.is_sampled() {
        true => {
            let d = design.record();
            let indices = if design.has_indices() {
                ", indices"
            } else {
                ""
            };
            format!(
                "{} samples, {}, seed {}{indices}",
                d.samples, d.sampling, d.seed
            )
        }
        false => "no samples".into(),
    }
}

/// Hash of a scene with its calibrations and the contents of its files, whatever folder they are in.
fn hash_of(source: Source) -> String {
    let in_any_folder = |(path, hash): (String, String)| {
        let name = Path::new(&path)
            .file_name()
            .map(|n| n.to_string_lossy().into_owned());
        (name.unwrap_or(path), hash)
    };
    let source = Source {
        name: String::new(),
        files: source.files.into_iter().map(in_any_folder).collect(),
        ..source
    };
    Key::new("scene of a scan").and(&source).to_string()
}

fn outputs(args: &Scan, scene: &SceneFile) -> Result<Vec<Output>, Refusal> {
    if args.outputs.is_empty() {
        let errors = Output::ERRORS
            .into_iter()
            .filter(|_| args.against.is_some());
        return Ok(Output::DEFAULTS.into_iter().chain(errors).collect());
    }
    let mut once: Vec<Output> = Vec::new();
    for output in &args.outputs {
        if output.is_error() && args.against.is_none() {
            let why = format!(
                "`{}` is an error, but nothing says against what",
                output.key()
            );
            return Err(SceneError::plain(
                why,
                "name the model that others are compared with: --against LABEL",
            )
            .into());
        }
        let of_scene = (output.clone().of_scene(&scene.spec)).map_err(|why| {
            let gears: Vec<&str> = scene.spec.gears.iter().map(|g| g.name.as_str()).collect();
            SceneError::plain(why, format!("its gears are {}", gears.join(", ")))
        })?;
        for output in of_scene {
            if !once.contains(&output) {
                once.push(output);
            }
        }
    }
    Ok(once)
}
