//! Loading of scenes by name or path, with their calibrations.

use super::reading::suggest;
use super::shipped::{self, SHIPPED};
use super::{Calibration, Origin, SceneError, SceneFile};
use crate::cli::progress::Display;
use crate::context::Context;
use gearbench_reference::file_kind::{self, Input};
use gearbench_reference::files;
use gearbench_reports::RECORD;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Largest number of scene files of a folder that a refusal lists.
const MOST_NAMED: usize = 3;

/// Loads a shipped scene by name, or a file by path (ends in `.toml` or has a folder).
///
/// # Errors
/// [`SceneError`] with file, line and help.
pub fn load(context: &Context, path_or_name: &str) -> Result<SceneFile, SceneError> {
    load_for(context, path_or_name, Selection::All)
}

/// Models of a scene to build. The others are read only, as the reduction of finite elements takes seconds.
#[derive(Clone, Copy, Debug)]
pub enum Selection<'a> {
    /// Builds all models of the scene.
    All,
    /// Builds the models that [`SceneFile::select`] returns.
    Labels(Option<&'a str>),
    /// Builds the models that [`SceneFile::select_reduced`] returns.
    Reduced(Option<&'a str>),
    /// Builds no model: later building reports their errors.
    None,
    /// Builds the models that [`SceneFile::select_precision`] returns.
    Precision(Option<&'a str>),
}

/// Loads a scene as [`load`] does, but builds only the selected models.
///
/// # Errors
/// [`SceneError`] with file, line and help, also for labels that the scene does not have.
pub fn load_for(
    context: &Context,
    path_or_name: &str,
    selection: Selection<'_>,
) -> Result<SceneFile, SceneError> {
    load_with(context, path_or_name, selection, true)
}

fn load_with(
    context: &Context,
    path_or_name: &str,
    selection: Selection<'_>,
    calibrated: bool,
) -> Result<SceneFile, SceneError> {
    let mut file = read(context, path_or_name, calibrated)?;
    let chosen = match selection {
        Selection::All => file.models.iter().collect(),
        Selection::None => Vec::new(),
        Selection::Labels(labels) => file.select(labels)?,
        Selection::Reduced(labels) => file.select_reduced(labels)?,
        Selection::Precision(labels) => file.select_precision(labels)?,
    };
    let labels: Vec<&str> = chosen.iter().map(|m| m.label.as_str()).collect();
    let is_chosen = |i: &usize| labels.contains(&file.models[*i].label.as_str());
    let chosen: Vec<usize> = (0..file.models.len()).filter(is_chosen).collect();
    file.odd
        .iter()
        .for_each(|odd| context.messages.warn(&odd.to_text()));
    file.build(&chosen, calibrated)?;
    Ok(file)
}

impl SceneFile {
    /// Builds models that were not built with the scene, selected as by [`SceneFile::select`], and warns of those that
    /// cannot run it.
    ///
    /// # Errors
    /// [`SceneError`] when a value is wrong, and when none of them can run.
    pub fn build_selected(&mut self, labels: &[&str]) -> Result<(), SceneError> {
        let is_chosen = |i: &usize| labels.contains(&self.models[*i].label.as_str());
        let chosen: Vec<usize> = (0..self.models.len()).filter(is_chosen).collect();
        self.build(&chosen, true)
    }

    fn build(&mut self, chosen: &[usize], calibrated: bool) -> Result<(), SceneError> {
        let display = Display::of(&self.context, chosen.len());
        let known = self.refused.len();
        let odd = self.check(chosen, calibrated, &|done, label| {
            display.report_progress(done, chosen.len(), &format!("building the model `{label}`"));
        })?;
        drop(display);
        odd.iter()
            .for_each(|odd| self.context.messages.warn(&odd.to_text()));
        for refused in &self.refused[known..] {
            self.context.messages.warn(&format!(
                "the model `{}` is refused, the others run: {}",
                refused.label,
                refused.error.to_text()
            ));
        }
        Ok(())
    }
}

/// Loads a scene without applying calibrations: the models have the constants of the scene, at which an identification
/// starts.
///
/// # Errors
/// [`SceneError`] with file, line and help.
pub fn load_uncalibrated(
    context: &Context,
    path_or_name: &str,
    selection: Selection<'_>,
) -> Result<SceneFile, SceneError> {
    load_with(context, path_or_name, selection, false)
}

/// Loads a scene without calibrations and without building its models, for uses of its gears alone: files of models
/// need not exist yet.
///
/// # Errors
/// [`SceneError`] with file, line and help.
pub fn load_unbuilt(context: &Context, path_or_name: &str) -> Result<SceneFile, SceneError> {
    let file = read(context, path_or_name, false)?;
    file.odd
        .iter()
        .for_each(|odd| context.messages.warn(&odd.to_text()));
    Ok(file)
}

fn read(context: &Context, path_or_name: &str, calibrated: bool) -> Result<SceneFile, SceneError> {
    if let Some(s) = shipped::shipped(path_or_name) {
        return SceneFile::unbuilt(
            context,
            &format!("{}.toml", s.name),
            context.recorded(s.name).unwrap_or(s.text),
            Origin::Shipped,
            calibrated,
        );
    }
    let path = Path::new(path_or_name);
    let is_recorded = context.recorded(path_or_name).is_some();
    if path.is_dir() && !is_recorded {
        return Err(SceneError::plain(
            format!("`{path_or_name}` is a folder, not a scene"),
            contents(path),
        ));
    }
    if let Some(kind) = file_kind::foreign(path, Input::Scene).filter(|_| !is_recorded) {
        return Err(SceneError::plain(
            format!("`{path_or_name}` is {}, not a scene", kind.name),
            kind.way_out_of(path),
        ));
    }
    let is_path = path.extension().is_some_and(|e| e == "toml") || path.components().count() > 1;
    if !is_path && !is_recorded {
        let names: Vec<&str> = SHIPPED.iter().map(|s| s.name).collect();
        let near = suggest::did_you_mean(path_or_name, &names);
        let file = path.with_extension("toml");
        let help = match (file.is_file(), path.is_file()) {
            (true, _) => format!("write `{}`, the file in this folder", file.display()),
            (_, true) => "this file exists, but the names of scenes end in .toml".to_owned(),
            _ => format!(
                "{near}shipped scenes are {}; the path of your own scene ends in .toml",
                names.join(", ")
            ),
        };
        let what = format!("there is no scene `{path_or_name}`");
        return Err(SceneError::plain(what, help));
    }
    let read = || match context.recorded(path_or_name) {
        Some(text) => Ok(text.to_owned()),
        None => files::read_text(path, files::MOST_OF_TEXT),
    };
    let text = read().map_err(|e| {
        SceneError::plain(
            format!("{path_or_name}: {e}"),
            "expected a readable TOML file in UTF-8; `gearbench list` names the shipped scenes",
        )
    })?;
    SceneFile::unbuilt(
        context,
        path_or_name,
        &text,
        Origin::File(path.to_owned()),
        calibrated,
    )
}

/// The advice for a folder that is named in the place of a scene.
fn contents(folder: &Path) -> String {
    if folder.join(RECORD).is_file() {
        let shown = folder.display();
        return format!(
            "it contains the record of a study: `gearbench report {shown}` rewrites its report, `gearbench rerun {shown}` repeats the study"
        );
    }
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|e| e == "toml");
    let mut scenes: Vec<String> = (entries.map(|e| e.path()).filter(is_scene))
        .map(|path| format!("`{}`", path.display()))
        .collect();
    scenes.sort();
    scenes.truncate(MOST_NAMED);
    match scenes.is_empty() {
        true => "name a scene file with the ending .toml: `gearbench init` writes one".to_owned(),
        false => format!("name a scene file in it, such as {}", scenes.join(", ")),
    }
}

/// Finds the calibrations of a scene by model: in the file next to the scene, else in the scene itself, else among the
/// embedded ones of that name.
pub(super) fn find_calibration(
    context: &Context,
    scene: &str,
    (name, own): (&str, &Calibration),
    origin: &Origin,
) -> Result<Option<Calibration>, SceneError> {
    if let Some(text) = context.recorded_calibration(scene) {
        return Calibration::parse("the record", text).map(Some);
    }
    if let (Origin::File(path), true) = (origin, scene == name) {
        let beside = path.with_extension("calibration.toml");
        match files::read_text(&beside, files::MOST_OF_TEXT) {
            Ok(text) => {
                let stored = Calibration::parse(&beside.to_string_lossy(), &text)?;
                return Ok(Some(stored.or(own)));
            }
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            Err(e) => {
                return Err(SceneError::plain(
                    format!("{}: {e}", beside.display()),
                    "expected a calibration file of `gearbench identify --write`; move it elsewhere to run without it",
                ));
            }
        }
    }
    if scene == name && !own.sets.is_empty() {
        return Ok(Some(own.clone()));
    }
    match shipped::shipped(scene) {
        Some(s) => {
            Calibration::parse(&format!("calibrations/{}.toml", s.name), s.calibration).map(Some)
        }
        None => Ok(None),
    }
}
