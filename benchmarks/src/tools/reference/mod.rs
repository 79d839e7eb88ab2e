//! The command `gearbench reference SCENE --model LABEL`: a run of one model as reference for others.

pub(crate) mod arguments;
mod file;

use crate::cli::command_result::CommandResult;
use crate::cli::files::{ReplaceableFiles, folder_of, write_whole};
use crate::cli::progress::Display;
use crate::cli::terminal::{Refusal, absolute, refuse_run};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::run::{Job, RunError, run as integrate};
use crate::scene_file::references::{ConditionsOfGear, ReferenceConditions};
use crate::scene_file::{
    self, ModelChoice, Origin, SceneError, SceneFile, Selection, did_you_mean,
};
use arguments::Reference;
use file::Header;
use gearbench_integrators::table::DOPRI5;
use gearbench_integrators::{Resolution, Scheme};
use gearbench_reports::metrics::compare;
use gearbench_reports::numbers::per_cent;
use gearbench_reports::record::{Metrics, Run};
use serde_json::json;
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

/// Default relative tolerance of the reference run.
const RTOL: f64 = 1e-10;
/// Step and tolerance of the second run relative to the first.
const FINER: [f64; 2] = [0.5, 0.1];

/// Runs the model, writes the reference file and prints its lines for the scene.
pub fn run(context: &Context, args: &Reference, command: &str) -> Result<CommandResult, Refusal> {
    let scene = scene_file::load_for(context, &args.scene, Selection::Labels(Some(&args.model)))?;
    let choices = scene.select(Some(&args.model))?;
    let [choice] = choices.as_slice() else {
        return Err(bad(
            "several models are named",
            "a reference is the run of one model",
        ));
    };
    let choice = (*choice).clone();
    let conditions = conditions(args, &scene)?;
    let other = scene.with(&conditions);
    let other = other.map_err(|(_, why, help)| bad(why, help))?;
    let lines = lines(args, &scene, &conditions)?;
    // What would be refused when it is added is refused before it is computed.
    if !named(args, &scene) {
        with_lines(&scene, &lines)?;
    }
    if args.add {
        scene_path(&scene)?;
    }
    let method = method(args, &other, &choice)?;
    can_be_written(&args.out)?;
    let overwriting = ReplaceableFiles {
        inputs: &scene.inputs(),
        mark: Some("# command: gearbench reference"),
        force: args.force,
    };
    overwriting.check(&args.out)?;
    context.interruption.defer();
    let display = Display::of(context, 2);
    display.report_progress(0, 2, &format!("{} under {}", choice.label, method));
    let row = row(args, &other, &choice, &method)?;
    if row.status.is_failure() {
        return Err(Refusal::Failed(format!(
            "{} under {} did not complete the run: {}",
            choice.label,
            &method.to_string(),
            row.message.as_deref().unwrap_or("no reason given")
        )));
    }
    let finer = finer(&method);
    display.report_progress(1, 2, &format!("its error, {finer}"));
    let check = self::row(args, &other, &choice, &finer)?;
    drop(display);
    let own = own_error(&row, &check);
    let note = match &own {
        Some(m) => format!(
            "own error, compared with {}: {}",
            &finer.to_string(),
            [
                ("force history", m.force_l2),
                ("peak force", m.peak_force_rel),
                ("impulse", m.impulse_rel),
                ("transmission error", m.transmission_error_l2),
            ]
            .into_iter()
            .filter_map(|(what, e)| Some(format!(
                "{what} {}",
                per_cent(e?.abs(), 2).replace('\u{a0}', " ")
            )))
            .collect::<Vec<_>>()
            .join(", ")
        ),
        None => format!(
            "own error unknown: the run under {} was not completed",
            finer
        ),
    };
    // Legends are narrow: the command beside it has the step.
    let title = format!("{}, {}", choice.label, method.method.id());
    let spec = other.spec_for(&choice);
    let series = row.series.clone().unwrap_or_default();
    let header = Header {
        title: &title,
        command,
        note: &note,
        scene: &scene.name,
    };
    // Conditions of the scene are stated; a gap that belongs to the model is a property of the model.
    let text = file::text(&header, &spec, &series, usize::from(args.digits));
    let fail = |path: &Path| {
        let path = path.display().to_string();
        move |e: std::io::Error| Refusal::Files(format!("{path}: {e}"))
    };
    write_whole(&args.out, &text).map_err(fail(&args.out))?;
    context.messages.print_line(&format!(
        "{} under {}: {note}",
        choice.label,
        &method.to_string()
    ));
    context.messages.print_line(&format!(
        "written: {}",
        absolute(args.out.clone()).display()
    ));
    let answer = CommandResult::done()
        .with("written", absolute(args.out.clone()))
        .with("model", &choice.label)
        .with("method", method.to_string())
        .with("scene_lines", &lines)
        .with("own_error", own.map(|m| json!({
            "force_l2": m.force_l2, "peak_force_rel": m.peak_force_rel, "impulse_rel": m.impulse_rel,
            "transmission_error_l2": m.transmission_error_l2,
        })));
    if !args.add {
        context.messages.print_line("in the scene, or with --add:");
        context.messages.print_line(&lines);
        return Ok(answer);
    }
    let path = add(&scene, &lines)?;
    context
        .messages
        .print_line(&format!("added to {}:\n{lines}", path.display()));
    Ok(answer.with("added_to", absolute(path)))
}

fn bad(why: impl Into<String>, help: impl Into<String>) -> Refusal {
    SceneError::plain(why, help).into()
}

/// The conditions that the command line changes relative to the scene.
fn conditions(args: &Reference, scene: &SceneFile) -> Result<ReferenceConditions, Refusal> {
    let mut found = ReferenceConditions {
        duration: args.duration,
        gap: args.gap,
        path_coordinate: None,
        centre_distance: args.distance,
        gears: Vec::new(),
    };
    let asked = (args.speed.iter().map(|s| (s, true))).chain(args.load.iter().map(|l| (l, false)));
    for ((name, x), is_speed) in asked {
        let Some(gear) = scene.spec.gears.iter().position(|g| g.name == *name) else {
            let names: Vec<&str> = scene.spec.gears.iter().map(|g| g.name.as_str()).collect();
            return Err(bad(
                format!("there is no gear `{name}` in the scene `{}`", scene.name),
                format!("{}it has {}", did_you_mean(name, &names), names.join(", ")),
            ));
        };
        let place = found.gears.iter().position(|g| g.gear == gear);
        let place = place.unwrap_or_else(|| {
            found.gears.push(ConditionsOfGear {
                gear,
                ..ConditionsOfGear::default()
            });
            found.gears.len() - 1
        });
        let own = &mut found.gears[place];
        *(if is_speed {
            &mut own.speed
        } else {
            &mut own.load
        }) = Some(*x);
    }
    Ok(found)
}

/// The name of the reference in the scene: as given, else the stem of the file (with a suffix if a model has it).
fn name(args: &Reference, scene: &SceneFile) -> String {
    let stem = args
        .out
        .file_stem()
        .map(|s| s.to_string_lossy().into_owned());
    let stem = stem.unwrap_or_default();
    let usual = match scene.model(&stem) {
        Some(_) => format!("{stem}-reference"),
        None => stem,
    };
    args.name.clone().unwrap_or(usual)
}

/// True if the scene already has a reference with that name.
fn named(args: &Reference, scene: &SceneFile) -> bool {
    let name = name(args, scene);
    scene.references.iter().any(|r| r.name == name)
}

/// The lines that add the reference to the scene.
fn lines(
    args: &Reference,
    scene: &SceneFile,
    conditions: &ReferenceConditions,
) -> Result<String, Refusal> {
    let name = name(args, scene);
    if args.add && named(args, scene) {
        return Err(bad(
            format!("the scene already has a reference \"{name}\""),
            "give another --name, or remove --add to overwrite only the file",
        ));
    }
    let text = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let mut lines = vec![
        "[[references]]".to_owned(),
        format!("name = {}", text(&name)),
    ];
    lines.push(format!(
        "csv = {}",
        text(&path_from_scene(&args.out, scene))
    ));
    lines.extend(conditions.lines(&scene.spec));
    if args.validate {
        lines.push("role = \"validate\"".into());
    }
    Ok(lines.join("\n"))
}

/// The path of a file relative to the folder of the scene.
fn path_from_scene(file: &Path, scene: &SceneFile) -> String {
    let whole = |path: &Path| folder_of(path).canonicalize().ok();
    let found = match &scene.origin {
        Origin::Shipped => None,
        Origin::File(path) => whole(path).zip(whole(file)),
    };
    let name = file.file_name().map(PathBuf::from).unwrap_or_default();
    let path = found.map(|(scene, folder)| relative_path(&scene, &folder).join(&name));
    path.unwrap_or_else(|| file.to_owned())
        .display()
        .to_string()
}

/// The relative path from one folder to another: a scene with it can be moved together with the file.
fn relative_path(from: &Path, to: &Path) -> PathBuf {
    let common = (from.components().zip(to.components())).take_while(|(a, b)| a == b);
    let common = common.count();
    if common == 0 {
        return to.to_owned();
    }
    let up = from.components().skip(common).map(|_| Component::ParentDir);
    up.chain(to.components().skip(common)).collect()
}

fn method(args: &Reference, scene: &SceneFile, choice: &ModelChoice) -> Result<Scheme, Refusal> {
    let own = choice
        .integrators
        .as_deref()
        .unwrap_or(&scene.study.integrators);
    let Some(text) = &args.method else {
        let own = choice.integrators.as_ref().and_then(|m| m.first());
        let found = own.copied().unwrap_or_else(|| DOPRI5.at_tolerance(RTOL));
        scene.check_steps(&[found])?;
        return Ok(found);
    };
    let found = Scheme::list(text, own)
        .map_err(RunError::from)
        .map_err(refuse_run)?;
    scene.check_steps(&found)?;
    match found.as_slice() {
        [one] => Ok(*one),
        _ => Err(bad(
            "several methods are named",
            "a reference is one run: name one method",
        )),
    }
}

/// The method at half its step, or a tenth of its tolerance.
fn finer(method: &Scheme) -> Scheme {
    method.method.at(match method.resolution {
        Resolution::Step(h) => Resolution::Step(FINER[0] * h),
        Resolution::Tolerance(rtol) => {
            // A tenth, without the digits of a product.
            let tenth = format!("{:.6e}", FINER[1] * rtol).parse().unwrap_or(rtol);
            Resolution::Tolerance(f64::max(tenth, 1e-14))
        }
    })
}

fn row(
    args: &Reference,
    scene: &SceneFile,
    choice: &ModelChoice,
    method: &Scheme,
) -> Result<Run, Refusal> {
    let conditions = Conditions {
        timeout: Duration::from_secs_f64(args.timeout),
        repeats: 0,
        measurable: true,
        ..Conditions::of(scene)
    };
    let (spec, grid) = (scene.spec_for(choice), conditions.grid());
    let job = Job {
        histories: false,
        ..conditions.job((&spec, &choice.modelling), method, &grid)
    };
    let row = integrate(&job).map_err(refuse_run)?;
    match scene.context.interruption.is_requested() {
        true => Err(Refusal::Interrupted),
        false => Ok(row),
    }
}

/// The error of a run against a run with a finer step.
fn own_error(row: &Run, finer: &Run) -> Option<Metrics> {
    let series = finer
        .series
        .as_ref()
        .filter(|_| !finer.status.is_failure())?;
    Some(compare(row.finished().ok()?, series, "finer"))
}

/// Checks, before any computation, that a file can be written.
fn can_be_written(path: &Path) -> Result<(), Refusal> {
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
    if path.is_dir() || parent.is_some_and(|p| !p.is_dir()) {
        return Err(bad(
            format!("{} cannot be written", path.display()),
            "give --out a file in an existing folder, such as --out ref.csv",
        ));
    }
    Ok(())
}

/// The path of a scene file; refuses shipped scenes, which have none.
fn scene_path(scene: &SceneFile) -> Result<PathBuf, Refusal> {
    match &scene.origin {
        Origin::File(path) => Ok(path.clone()),
        Origin::Shipped => Err(bad(
            "a shipped scene is part of the program",
            format!(
                "`gearbench init {}` writes a copy that you can edit",
                scene.name
            ),
        )),
    }
}

/// The text of the scene with the lines added, and the scene read from it.
fn with_lines(scene: &SceneFile, lines: &str) -> Result<(String, SceneFile), Refusal> {
    let text = format!("{}\n\n{lines}\n", scene.text().trim_end());
    let name = match &scene.origin {
        Origin::File(path) => path.display().to_string(),
        Origin::Shipped => format!("{}.toml", scene.name),
    };
    let whole = SceneFile::unbuilt(&scene.context, &name, &text, scene.origin.clone(), false)?;
    Ok((text, whole))
}

/// Appends the lines to the scene file and leaves the other lines unchanged; the result is parsed before it is written.
fn add(scene: &SceneFile, lines: &str) -> Result<PathBuf, Refusal> {
    let path = scene_path(scene)?;
    let (text, mut whole) = with_lines(scene, lines)?;
    whole.load_references(false)?;
    let there = std::fs::read_to_string(&path)
        .map_err(|e| Refusal::Files(format!("{}: {e}", path.display())))?;
    if there.trim_start_matches('\u{feff}') != scene.text() {
        return Err(bad(
            format!("{} has changed since it was read", path.display()),
            format!("the file of the reference is written; add these lines to the scene:\n{lines}"),
        ));
    }
    write_whole(&path, &text).map_err(|e| Refusal::Files(format!("{}: {e}", path.display())))?;
    Ok(path)
}
