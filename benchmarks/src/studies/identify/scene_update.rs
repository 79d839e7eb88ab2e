//! Writing of fitted constants into the scene file: comments and layout stay, and the model no longer refers to a
//! calibration.
//!
//! | constant | where it goes in the model's entry of `models` |
//! |---|---|
//! | stiffness and its course along the path | `contact.stiffness`, of every contact where there is a list |
//! | damping | `contact.damping` |
//! | gap | `gap_m` |
//! | of all gears | `parameters`, and those of gears with an entry of their own in `gears` |
//! | of one gear | `gears.NAME.parameters`, beside what all have |
//!
//! Where they come from stands in comments above the entry, each line behind a tag, so that a later fit replaces them. What
//! was written is read again before it takes the place of the file: it has to give the very model that was fitted.

use super::plan::{apply, text_with};
use crate::cli::files::write_whole;
use crate::cli::terminal::Refusal;
use crate::scene_file::calibration::{Constants, of_gear};
use crate::scene_file::changes::{KeyPath, inner, set};
use crate::scene_file::format::{StiffnessTable, number, to_value};
use crate::scene_file::{ModelChoice, Origin, SceneFile};
use gearbench_models::law::Damping;
use gearbench_models::stiffness::PairStiffness;
use gearbench_reference::files;
use std::path::PathBuf;
use toml_edit::{DocumentMut, InlineTable, Item, TableLike, Value};

/// Returns the prefix of the comments that this module writes about a model.
fn tag(label: &str) -> String {
    format!("# identified, {label}: ")
}

/// Model with its fitted constants and the comments about them.
pub struct FittedConstants<'a> {
    /// Model whose entry is changed.
    pub choice: &'a ModelChoice,
    /// All constants that the model gets.
    pub constants: Constants,
    /// Values of keys of the scene.
    pub keys: Vec<(KeyPath, f64)>,
    /// Lines of the comment above the entry.
    pub told: Vec<String>,
}

/// Writes constants into the file of a scene.
///
/// # Errors
/// [`Refusal`] where the file is not the one that was read, stands in a way that was not seen through, lacks what the data
/// do not determine, or cannot be written.
pub fn write_scene(scene: &SceneFile, all: &[FittedConstants<'_>]) -> Result<PathBuf, Refusal> {
    let path = match &scene.origin {
        Origin::Shipped => PathBuf::from(format!("benchmarks/scenes/{}.toml", scene.name)),
        Origin::File(path) => path.clone(),
    };
    let shown = path.display();
    let there = files::read_text(&path, files::MOST_OF_TEXT).map_err(|e| match &scene.origin {
        Origin::Shipped => Refusal::Files(format!(
            "{shown}: {e}; run this from the root of the repository for a shipped scene"
        )),
        Origin::File(_) => Refusal::Files(format!("{shown}: {e}")),
    })?;
    if there.trim_start_matches('\u{feff}') != scene.text() {
        return Err(Refusal::Files(format!(
            "{shown} has changed since the fit; fit it again"
        )));
    }
    let text = written(scene, all)?;
    write_whole(&path, &text).map_err(|e| Refusal::Files(format!("{shown}: {e}")))?;
    Ok(path)
}

/// The text of the scene with constants.
fn written(scene: &SceneFile, all: &[FittedConstants<'_>]) -> Result<String, Refusal> {
    let unseen = |label: &str| {
        Refusal::Input(miette::miette!(
            help = "write a calibration with `--write` instead",
            "the constants of `{label}` cannot be written into the scene: its entry has an unexpected form"
        ))
    };
    let keys: Vec<_> = all.iter().flat_map(|w| w.keys.clone()).collect();
    let text = text_with(scene, &keys).map_err(Refusal::Files)?;
    let with_keys = scene.with_text(&text).map_err(Refusal::from)?;
    let scene = &with_keys;
    let mut document: DocumentMut =
        (text.parse()).map_err(|e: toml_edit::TomlError| Refusal::Files(e.to_string()))?;
    // A model of which keys of the scene alone were fitted keeps its entry.
    let all = || all.iter().filter(|w| w.constants != Constants::default());
    for w in all() {
        write_constants(&mut document, scene, w).ok_or_else(|| unseen(&w.choice.label))?;
    }
    let text = document.to_string();
    let read = SceneFile::parse(
        &scene.context,
        &scene.name,
        &text,
        scene.origin.clone(),
        false,
    );
    let read = read.map_err(|e| {
        Refusal::Input(miette::miette!(
            help = "constants that the data do not determine are not written: fix them with --hold, or write them with --force",
            "the scene with these constants is not valid: {}",
            e.to_text()
        ))
    })?;
    for w in all() {
        let found = read.model(&w.choice.label);
        let found = found.map(|c| format!("{:?}{:?}", read.spec_for(c), c.modelling));
        if found != fitted(scene, w) {
            return Err(unseen(&w.choice.label));
        }
    }
    Ok(text)
}

/// Returns the fitted model as text with all digits, for comparison; `None` for a constant that it does not have.
fn fitted(scene: &SceneFile, w: &FittedConstants<'_>) -> Option<String> {
    let (mut spec, mut modelling) = (scene.spec_for(w.choice), w.choice.modelling.clone());
    apply(&w.constants, &w.choice.model, &mut spec, &mut modelling).ok()?;
    Some(format!("{spec:?}{modelling:?}"))
}

/// Writes constants into the entry of a model; `None` if the form of the entry is not supported.
fn write_constants(
    document: &mut DocumentMut,
    scene: &SceneFile,
    w: &FittedConstants<'_>,
) -> Option<()> {
    let place = scene
        .models
        .iter()
        .position(|c| c.label == w.choice.label)?;
    let tag = tag(&w.choice.label);
    let told = w.told.iter().map(|l| l.replace(['\n', '\r'], " "));
    let lines: String = told.map(|l| format!("{tag}{l}\n")).collect();
    match document.get_mut("models")? {
        Item::ArrayOfTables(models) => {
            let model = models.get_mut(place)?;
            let kept = change(model, scene, w)?;
            let before = model.decor().prefix().and_then(|p| p.as_str());
            let before = above(before.unwrap_or_default(), &tag) + &kept + &lines;
            model.decor_mut().set_prefix(before);
        }
        models => {
            let entry = models.as_array_mut()?.get_mut(place)?;
            let kept = change(entry.as_inline_table_mut()?, scene, w)?;
            let mut key = document.key_mut("models")?;
            let decor = key.leaf_decor_mut();
            let before = decor.prefix().and_then(|p| p.as_str());
            let before = above(before.unwrap_or_default(), &tag) + &kept + &lines;
            decor.set_prefix(before);
        }
    }
    Some(())
}

/// Returns the comment above an entry without the lines of an earlier fit.
fn above(text: &str, tag: &str) -> String {
    let kept = text.split_inclusive('\n').filter(|l| !l.starts_with(tag));
    kept.collect()
}

/// Changes the entry of a model, and returns the comments about its calibration, which is gone.
fn change(model: &mut dyn TableLike, scene: &SceneFile, w: &FittedConstants<'_>) -> Option<String> {
    let mut kept = String::new();
    if let Some((key, item)) = model.get_key_value("calibration") {
        let after = item.as_value().and_then(|v| v.decor().suffix());
        for part in [key.leaf_decor().prefix(), after] {
            let lines = part.and_then(|p| p.as_str()).unwrap_or_default().lines();
            let comments = lines.map(str::trim).filter(|l| l.starts_with('#'));
            kept.extend(comments.map(|l| format!("{l}\n")));
        }
    }
    model.remove("calibration");
    let (mut spec, mut modelling) = (scene.spec_for(w.choice), w.choice.modelling.clone());
    apply(&w.constants, &w.choice.model, &mut spec, &mut modelling).ok()?;

    let contact = model.get_mut("contact")?;
    let course = [w.constants.slope, w.constants.curvature];
    let stiffness = w.constants.stiffness.or(course[0]).or(course[1]).is_some();
    let one = |table: &mut dyn TableLike, i: usize| {
        let spec = modelling.contacts.get(i)?;
        if stiffness {
            set(table, "stiffness", stiffness_of(&spec.stiffness)?);
        }
        if let (Some(_), law @ Damping::KelvinVoigt { .. }) = (w.constants.damping, spec.damping) {
            set(table, "damping", to_value(&law).ok()??);
        }
        Some(())
    };
    match contact {
        Item::ArrayOfTables(all) => {
            let mut all = all.iter_mut().enumerate();
            all.try_for_each(|(i, table)| one(table, i))?;
        }
        Item::Value(Value::Array(all)) => {
            let mut all = all.iter_mut().enumerate();
            all.try_for_each(|(i, table)| one(table.as_inline_table_mut()?, i))?;
        }
        item => one(item.as_table_like_mut()?, 0)?,
    }
    tidy(model, "contact");
    if let Some(gap) = w.constants.gap {
        set(model, "gap_m", number(gap));
    }
    parameters(model, scene, w)?;
    Some(kept)
}

/// Puts constants among the parameters of all gears, and of single ones.
fn parameters(model: &mut dyn TableLike, scene: &SceneFile, w: &FittedConstants<'_>) -> Option<()> {
    let all = &w.constants.parameters;
    let common: Vec<(&str, f64)> = (all.iter())
        .filter(|(key, _)| of_gear(key).0.is_none())
        .map(|(key, x)| (key.as_str(), *x))
        .collect();
    if !common.is_empty() {
        let table = inner(model, "parameters")?;
        for (key, x) in &common {
            set(table, key, number(*x));
        }
        tidy(model, "parameters");
    }
    let given = model.get("parameters").cloned();
    for (gear, spec) in scene.spec.gears.iter().zip(&w.choice.modelling.gears) {
        let own: Vec<(&str, f64)> = (all.iter())
            .filter_map(|(key, x)| {
                let (of, key) = of_gear(key);
                (of == Some(gear.name.as_str())).then_some((key, *x))
            })
            .collect();
        let gears = model.get("gears").and_then(Item::as_table_like);
        let entry = gears.and_then(|g| g.get(&gear.name));
        let has_own = entry.is_some_and(Item::is_table_like);
        if spec.id() != w.choice.model || (own.is_empty() && !has_own) {
            continue;
        }
        let gears = inner(model, "gears")?;
        if !has_own {
            // An entry of its own has all that the others have.
            let mut table = InlineTable::new();
            table.insert("model", w.choice.model.as_str().into());
            let mut parameters = InlineTable::new();
            let given = given.as_ref().and_then(Item::as_table_like);
            for (key, item) in given.into_iter().flat_map(TableLike::iter) {
                parameters.insert(key, item.as_value()?.clone().decorated("", ""));
            }
            table.insert("parameters", parameters.into());
            set(gears, &gear.name, table.into());
        }
        let entry = gears.get_mut(&gear.name)?.as_table_like_mut()?;
        let table = inner(entry, "parameters")?;
        for (key, x) in common.iter().filter(|_| has_own).chain(&own) {
            set(table, key, number(*x));
        }
        tidy(entry, "parameters");
        tidy(gears, &gear.name);
        tidy(model, "gears");
    }
    Some(())
}

/// Normalises the spaces of an inline table.
fn tidy(table: &mut dyn TableLike, key: &str) {
    let value = table.get_mut(key).and_then(Item::as_value_mut);
    if let Some(inline) = value.and_then(Value::as_inline_table_mut)
        && !inline.to_string().contains(['\n', '#'])
    {
        inline.fmt();
    }
}

/// A constant stiffness or a parabola as the scene has it.
fn stiffness_of(stiffness: &PairStiffness) -> Option<Value> {
    match stiffness {
        PairStiffness::Constant { .. } | PairStiffness::Parabola { .. } => {
            to_value(&StiffnessTable::from(stiffness)).ok()?
        }
        _ => None,
    }
}
