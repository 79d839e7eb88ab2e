//! `[[models]]`: the configurations that a study compares.

use super::calibrated::{CalibrationUse, FindCalibration, calibration};
use super::contact::contact;
use super::error::SceneError;
use super::gear::{GearDraft, Place};
use super::reader::{Entry, Key, in_order, key};
use super::study_plan::integrator;
use gearbench_integrators::Scheme;
use gearbench_models::gear::table::Model;
use gearbench_models::spec::{ContactSpec, ModelSpec, Modelling, Parameters, Value};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

pub(super) static MODEL: &[Key] = &[
    key(
        "label",
        "name of this configuration in reports and on the command line, default the model's id",
    ),
    key(
        "model",
        "id of the gear model, for example \"rigid\"; `gearbench list` shows all",
    ),
    key(
        "gears",
        "other models for single gears, for example { wheel = \"rigid\" }",
    ),
    key(
        "contact",
        "{ stiffness, exponent, damping, friction, slices }, or a list with one per mesh",
    ),
    key(
        "parameters",
        "parameters of the gear model, SI units in their names",
    ),
    key(
        "gap_m",
        "gap at the start for this model [m], in place of the scene's",
    ),
    key(
        "integrators",
        "integrators of this model, in place of the study's",
    ),
    key(
        "published_s",
        "time in seconds that others publish for such a model, for the timing table",
    ),
    key(
        "calibration",
        "\"impact\" or \"static\", or { name, scene, label } to take another one's",
    ),
];
pub(super) static OF_GEAR: &[Key] = &[
    key("model", "id of the gear model"),
    key(
        "parameters",
        "parameters of the gear model, SI units in their names",
    ),
];
/// One configuration of a study.
#[derive(Clone, Debug)]
pub struct ModelChoice {
    /// Name in reports and on the command line, unique in the scene.
    pub label: String,
    /// Id of the gear model that most gears take.
    pub model: String,
    /// Models of all gears and contacts of all meshes, calibration applied.
    pub modelling: Modelling,
    /// The calibration, if one is used.
    pub calibration: Option<CalibrationUse>,
    /// Gap at the start [m] that the model asks for itself.
    pub own_gap: Option<f64>,
    /// Its integrators, where they are not those of the study.
    pub integrators: Option<Vec<Scheme>>,
    /// Time that others publish for such a model [s].
    pub published: Option<f64>,
}

impl ModelChoice {
    /// Gap at the start that the model or its calibration brings [m].
    pub fn gap(&self) -> Option<f64> {
        let calibrated = || self.calibration.as_ref()?.constants.as_ref()?.gap;
        self.own_gap.or_else(calibrated)
    }
}

/// Where a model stands, and its parts by dotted key such as `contact.stiffness`.
#[derive(Clone, Debug, Default)]
pub(super) struct ModelPlace {
    pub(super) header: Range<usize>,
    pub(super) keys: BTreeMap<String, Range<usize>>,
}

impl ModelPlace {
    pub(super) fn first(&self, keys: &[&str]) -> Range<usize> {
        keys.iter()
            .find_map(|k| self.keys.get(*k))
            .unwrap_or(&self.header)
            .clone()
    }
}

/// What models are read against.
pub(super) struct Context<'a> {
    pub(super) scene: &'a str,
    pub(super) gears: &'a [GearDraft],
    pub(super) meshes: usize,
    pub(super) models: &'a [Model],
    /// Folder of the scene file, from which paths of meshes count.
    pub(super) folder: Option<&'a Path>,
    /// Finds the calibration of a scene; `None` when the scene is loaded without.
    pub(super) calibrations: Option<&'a FindCalibration<'a>>,
}

/// Reads all configurations.
pub(super) fn models(
    list: &[Entry<'_>],
    context: &Context<'_>,
) -> Result<Vec<(ModelChoice, ModelPlace)>, SceneError> {
    let mut read: Vec<(ModelChoice, ModelPlace)> = Vec::new();
    for entry in list {
        let (choice, place) = model(entry, context)?;
        if let Some((_, other)) = read.iter().find(|(c, _)| c.label == choice.label) {
            return Err(entry
                .source()
                .error(
                    place.first(&["label", "model"]),
                    format!("two models have the label `{}`", choice.label),
                    "again here",
                    "give one of them another `label`",
                )
                .and(other.first(&["label", "model"]), "first here"));
        }
        read.push((choice, place));
    }
    Ok(read)
}

fn model(
    entry: &Entry<'_>,
    context: &Context<'_>,
) -> Result<(ModelChoice, ModelPlace), SceneError> {
    let s = entry.section("[[models]]", MODEL)?;
    let mut place = ModelPlace {
        header: entry.span(),
        keys: Place::of(entry)?.keys,
    };
    let id = s.need("model")?;
    let row = known(&id, context.models)?;
    let label = match s.get("label") {
        Some(e) => label(&e)?,
        None => row.id.to_owned(),
    };
    let parameters = match s.get("parameters") {
        Some(e) => parameters(&e, row, context, &mut place)?,
        None => Parameters::new(),
    };
    let mut gears = vec![
        ModelSpec {
            id: row.id.to_owned(),
            parameters
        };
        context.gears.len()
    ];
    if let Some(overrides) = s.get("gears") {
        override_gears(&overrides, context, &mut gears, &mut place)?;
    }
    let calibration = s
        .get("calibration")
        .map(|e| calibration(&e, context, &label))
        .transpose()?;
    let contacts = match s.get("contact") {
        Some(e) => contacts(&e, context.meshes, calibration.is_some(), &mut place)?,
        None => return Err(s.missing("contact")),
    };
    let mut modelling = Modelling { gears, contacts };
    if let Some(constants) = calibration.as_ref().and_then(|c| c.constants.as_ref()) {
        constants.apply(row.id, &mut modelling);
    }
    let own_gap = s.get("gap_m").map(|e| e.number()).transpose()?;
    let integrators = s
        .get("integrators")
        .map(|e| e.list()?.iter().map(integrator).collect())
        .transpose()?;
    Ok((
        ModelChoice {
            label,
            model: row.id.to_owned(),
            modelling,
            calibration,
            own_gap,
            integrators,
            published: s.maybe_number("published_s")?,
        },
        place,
    ))
}

fn known<'m>(entry: &Entry<'_>, models: &'m [Model]) -> Result<&'m Model, SceneError> {
    let id = entry.text()?;
    models.iter().find(|m| m.id == id).ok_or_else(|| {
        let ids: Vec<&str> = models.iter().map(|m| m.id).collect();
        entry.unknown_word(id, &ids)
    })
}

fn label(entry: &Entry<'_>) -> Result<String, SceneError> {
    let text = entry.text()?;
    let fits = !text.trim().is_empty()
        && text.len() <= 60
        && !text.contains([',', '\n'])
        && text.trim() == text;
    if fits {
        return Ok(text.to_owned());
    }
    Err(entry.error(
        format!(
            "the label \"{}\" cannot be used",
            text.chars().take(60).collect::<String>()
        ),
        "expected 1 to 60 characters without commas",
        "labels stand in legends and in `--models a,b`",
    ))
}

/// The path of a deck or a reduction that lies beside the scene file; other texts as they are.
fn from_folder(text: &str, folder: Option<&Path>) -> String {
    let name = text.to_ascii_lowercase();
    let is_path = [".inp", ".inp.gz", ".npz"]
        .iter()
        .any(|e| name.ends_with(e));
    let beside = folder.filter(|_| is_path).map(|f| f.join(text));
    match beside.filter(|p| p.is_file()) {
        Some(path) => path.to_string_lossy().into_owned(),
        None => text.to_owned(),
    }
}

/// Parameters of a model; a key it does not have is refused.
fn parameters(
    entry: &Entry<'_>,
    row: &Model,
    context: &Context<'_>,
    place: &mut ModelPlace,
) -> Result<Parameters, SceneError> {
    let names: Vec<&str> = row.parameters.iter().map(|p| p.key).collect();
    let meaning = |name: &str| {
        row.parameters
            .iter()
            .find(|p| p.key == name)
            .map_or("", |p| p.meaning)
    };
    let mut parameters = Parameters::new();
    for e in in_order(entry.source(), entry.raw_table()?) {
        if !names.contains(&e.name) {
            return Err(e.unknown(
                &format!("the model `{}` has no parameter `{}`", row.id, e.name),
                &names,
                &meaning,
            ));
        }
        place.keys.insert(
            format!("parameters.{}", e.name),
            e.key_range().start..e.span().end,
        );
        let value = if e.is_list() {
            Value::List(e.numbers()?)
        } else if let Some(text) = e.as_text() {
            Value::Text(from_folder(text, context.folder))
        } else if let Some(flag) = e.as_boolean() {
            Value::Flag(flag)
        } else {
            Value::Number(e.number()?)
        };
        parameters.insert(e.name.to_owned(), value);
    }
    Ok(parameters)
}

fn override_gears(
    entry: &Entry<'_>,
    context: &Context<'_>,
    gears: &mut [ModelSpec],
    place: &mut ModelPlace,
) -> Result<(), SceneError> {
    let names: Vec<&str> = context.gears.iter().map(|g| g.spec.name.as_str()).collect();
    for e in in_order(entry.source(), entry.raw_table()?) {
        let Some(i) = names.iter().position(|n| *n == e.name) else {
            return Err(e.unknown(
                &format!("there is no gear `{}`", e.name),
                &names,
                &|_| "a gear of this scene",
            ));
        };
        place.keys.insert(
            format!("gears.{}", e.name),
            e.key_range().start..e.span().end,
        );
        gears[i] = if e.is_table() {
            let s = e.section(format!("`gears.{}`", e.name), OF_GEAR)?;
            let row = known(&s.need("model")?, context.models)?;
            let parameters = s.get("parameters").map_or(Ok(Parameters::new()), |p| {
                parameters(&p, row, context, place)
            })?;
            ModelSpec {
                id: row.id.to_owned(),
                parameters,
            }
        } else {
            let row = known(&e, context.models)?;
            // Parameters of the configuration go to the gears that take its model.
            let parameters = if row.id == gears[i].id {
                gears[i].parameters.clone()
            } else {
                Parameters::new()
            };
            ModelSpec {
                id: row.id.to_owned(),
                parameters,
            }
        };
    }
    Ok(())
}

fn contacts(
    entry: &Entry<'_>,
    meshes: usize,
    calibrated: bool,
    place: &mut ModelPlace,
) -> Result<Vec<ContactSpec>, SceneError> {
    if !entry.is_list() {
        for e in in_order(entry.source(), entry.raw_table()?) {
            place.keys.insert(
                format!("contact.{}", e.name),
                e.key_range().start..e.span().end,
            );
        }
        return Ok(vec![contact(entry, calibrated)?; meshes]);
    }
    let list = entry.list()?;
    if list.len() != meshes {
        return Err(entry.error(
            format!("{} contacts for {meshes} meshes", list.len()),
            format!("expected {meshes}"),
            "give one contact for all meshes, or a list with one per mesh in their order",
        ));
    }
    list.iter().map(|e| contact(e, calibrated)).collect()
}
