//! The list `[[models]]`: models that a study compares.

use super::calibration_choice::{CalibrationChoice, CalibrationUse, FindCalibration, calibration};
use super::contact::{ContactTable, contact};
use super::damping;
use super::error::SceneError;
use super::gear::GearDraft;
use super::reading::keys::keys;
use super::reading::values::{ModelId, OneOrMany, OrderedTable, is_default};
use super::reading::{Place, suggest};
use super::study_plan::{IntegratorTable, schemes};
use gearbench_integrators::Scheme;
use gearbench_models::error::Subject;
use gearbench_models::gear::table::Model;
use gearbench_models::law::ForceLaw;
use gearbench_models::spec::{ContactSpec, ModelSpec, Modelling};
use gearbench_reports::record::Run;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

keys! {
    /// A model that a study compares.
    #[derive(Default)]
    struct ModelTable {
        /// name of this configuration in reports and on the command line, default the model's id
        label: Option<ModelLabel>,
        /// id of the gear model, for example "rigid"; `gearbench list` shows all
        model: ModelId,
        /// other models for single gears, for example { wheel = "rigid" }
        #[serde(default, skip_serializing_if = "is_default")]
        gears: OrderedTable<GearModelEntry>,
        /// { stiffness, exponent, damping, friction, slices }, or a list with one per mesh
        contact: OneOrMany<ContactTable>,
        /// parameters of the gear model, SI units in their names
        #[serde(default, skip_serializing_if = "is_default")]
        parameters: OrderedTable<ParameterValue>,
        /// gap at the start for this model [m], in place of the scene's
        gap_m: Option<f64>,
        /// integrators of this model, in place of the study's
        integrators: Option<Vec<IntegratorTable>>,
        /// time in seconds that others publish for such a model, for the timing table
        published_s: Option<f64>,
        /// true where that time is not printed there but follows from other published numbers
        #[serde(default, skip_serializing_if = "is_default")]
        published_derived: bool,
        /// "impact", "static" or "running", or { name, scene, label } for the calibration of another model or scene
        calibration: Option<CalibrationChoice>,
    }

    /// The model of a single gear.
    #[derive(Default)]
    struct GearModelTable {
        /// id of the gear model
        model: ModelId,
        /// parameters of the gear model, SI units in their names
        #[serde(default, skip_serializing_if = "is_default")]
        parameters: OrderedTable<ParameterValue>,
    }
}

/// A label for legends and for `--models a,b`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "String")]
pub struct ModelLabel(pub String);

impl TryFrom<String> for ModelLabel {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let fits = !text.trim().is_empty()
            && text.len() <= 60
            && !text.contains(',')
            && !text.chars().any(char::is_control)
            && text.trim() == text;
        let shown: String = text.chars().take(60).collect();
        fits.then_some(ModelLabel(text)).ok_or_else(|| {
            format!(
                "the label {shown:?} cannot be used: expected 1 to 60 characters without commas and control characters"
            )
        })
    }
}

/// Model of one gear.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum GearModelEntry {
    /// Another model with its default parameters.
    #[serde(rename = "<text>")]
    Id(ModelId),
    /// A model with parameters of its own.
    #[serde(rename = "<table>")]
    Own(GearModelTable),
}

/// Value of a parameter of a gear model.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum ParameterValue {
    /// A number in SI units.
    #[serde(rename = "<number>", serialize_with = "whole_or_decimal")]
    Number(f64),
    /// A word or a path.
    #[serde(rename = "<text>")]
    Text(String),
    /// A list of numbers.
    #[serde(rename = "<list>")]
    List(Vec<f64>),
    /// A truth value.
    #[serde(rename = "<flag>")]
    Flag(bool),
}

/// Writes whole numbers, such as counts, without a decimal point.
#[allow(clippy::trivially_copy_pass_by_ref)] // the form that serde calls
fn whole_or_decimal<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    match x.fract() == 0.0 && x.abs() < 1e6 {
        true => serializer.serialize_i64(*x as i64),
        false => serializer.serialize_f64(*x),
    }
}

impl ParameterValue {
    /// Converts a parameter of a model; `None` for a value that the format does not have.
    fn of(value: &Value) -> Option<Self> {
        match value {
            Value::Number(x) => x.as_f64().map(ParameterValue::Number),
            Value::String(x) => Some(ParameterValue::Text(x.clone())),
            Value::Array(x) => {
                let numbers = x.iter().map(Value::as_f64);
                numbers
                    .collect::<Option<Vec<f64>>>()
                    .map(ParameterValue::List)
            }
            Value::Bool(x) => Some(ParameterValue::Flag(*x)),
            Value::Null | Value::Object(_) => None,
        }
    }
}

impl From<&ModelSpec> for GearModelTable {
    fn from(spec: &ModelSpec) -> Self {
        let values = spec.values().into_iter();
        let parameters = values.filter_map(|(key, x)| Some((key, ParameterValue::of(&x)?)));
        GearModelTable {
            model: ModelId(spec.id().to_owned()),
            parameters: OrderedTable(parameters.collect()),
        }
    }
}

impl ModelTable {
    /// Returns the table of models of gears, given with the names of the gears, and contacts of meshes.
    pub fn of(label: &str, names: &[&str], modelling: &Modelling) -> Self {
        let first = modelling.gears.first();
        let others = names.iter().zip(&modelling.gears);
        let others = others.filter(|(_, m)| Some(*m) != first);
        let others = others.map(|(name, m)| ((*name).to_owned(), GearModelEntry::Own(m.into())));
        let GearModelTable { model, parameters } = first.map(Into::into).unwrap_or_default();
        let contacts: Vec<ContactTable> = modelling.contacts.iter().map(Into::into).collect();
        let alike = contacts.windows(2).all(|w| w[0] == w[1]);
        ModelTable {
            label: Some(ModelLabel(label.to_owned())),
            model,
            parameters,
            gears: OrderedTable(others.collect()),
            contact: match contacts.first() {
                Some(one) if alike => OneOrMany::One(one.clone()),
                _ => OneOrMany::Many(contacts),
            },
            ..ModelTable::default()
        }
    }
}

/// A model of a scene: models of all gears and contacts, with integrators.
#[derive(Clone, Debug)]
pub struct ModelChoice {
    /// Label in reports and on the command line, unique in the scene.
    pub label: String,
    /// Id of the gear model that most gears use.
    pub model: String,
    /// Models of all gears and contacts of all meshes, with the calibration applied.
    pub modelling: Modelling,
    /// True once the model has the damping that the scene states for all.
    pub is_damped: bool,
    /// The calibration, if the model uses one.
    pub calibration: Option<CalibrationUse>,
    /// Gap at the start that the model sets [m].
    pub own_gap: Option<f64>,
    /// Integrators of this model, where they differ from those of the study.
    pub integrators: Option<Vec<Scheme>>,
    /// True if the scene names no integrators: the default of the model applies, which is set when the model is built.
    pub default_integrators: bool,
    /// Published computing time of such a model [s].
    pub published: Option<f64>,
    /// True if the published time is derived from other published numbers.
    pub published_derived: bool,
}

impl ModelChoice {
    /// Gap at the start that the model or its calibration sets [m].
    pub fn gap(&self) -> Option<f64> {
        let calibrated = || self.calibration.as_ref()?.constants.as_ref()?.gap;
        self.own_gap.or_else(calibrated)
    }

    /// The label of the model in reports.
    pub fn model_label(&self) -> String {
        Run::called(&self.label, &self.model).model_label()
    }
}

/// Parts of the scene that the keys of its models are checked against.
pub(super) struct Context<'a> {
    pub(super) scene: &'a str,
    /// True if the scene is embedded in the program.
    pub(super) shipped: bool,
    pub(super) gears: &'a [GearDraft],
    pub(super) meshes: usize,
    pub(super) models: &'a [Model],
    pub(super) laws: &'a [Arc<dyn ForceLaw>],
    /// Folder of the scene file, to which paths of meshes are relative.
    pub(super) folder: Option<&'a Path>,
    /// Finds the calibration of a scene.
    pub(super) calibrations: &'a FindCalibration<'a>,
    /// True if models use the constants of their calibration.
    pub(super) calibrated: bool,
    /// True if the scene states a damping for all models.
    pub(super) damped: bool,
}

/// Checks all models of a scene.
pub(super) fn models(
    list: Vec<ModelTable>,
    context: &Context<'_>,
    all: &Place<'_>,
) -> Result<Vec<ModelChoice>, SceneError> {
    let mut read: Vec<ModelChoice> = Vec::new();
    for (i, keys) in list.into_iter().enumerate() {
        let at = all.member(i);
        let own = keys.clone();
        let choice = model(keys, context, &at)?;
        if context.damped {
            damping::check_once(&own, &choice, &at)?;
        }
        if let Some(other) = read.iter().position(|c| c.label == choice.label) {
            let names = ["label", "model"];
            return Err(at.first(&names).against(
                (&all.member(other).first(&names), "first here"),
                format!("two models have the label `{}`", choice.label),
                "again here",
                "give one of them another `label`",
            ));
        }
        read.push(choice);
    }
    Ok(read)
}

fn model(
    keys: ModelTable,
    context: &Context<'_>,
    at: &Place<'_>,
) -> Result<ModelChoice, SceneError> {
    let model = keys.model.0;
    let label = keys.label.map_or_else(|| model.clone(), |l| l.0);
    let own = gear_model(&model, keys.parameters, context, at)?;
    let mut gears = vec![own; context.gears.len()];
    for (name, of) in keys.gears.0 {
        let at = at.key("gears").key(&name);
        let names: Vec<&str> = context.gears.iter().map(|g| g.spec.name.as_str()).collect();
        let Some(found) = names.iter().position(|n| *n == name) else {
            return at.refuse(
                format!("there is no gear `{name}`"),
                "unknown name",
                suggest::there_are(&name, &names),
            );
        };
        let gear = &mut gears[found];
        match of {
            // Parameters of the configuration go to the gears that take its model.
            GearModelEntry::Id(ModelId(id)) if id == model => {}
            GearModelEntry::Id(ModelId(id)) => {
                *gear = gear_model(&id, OrderedTable::default(), context, &at.key("gears"))?;
            }
            GearModelEntry::Own(keys) => {
                *gear = gear_model(&keys.model.0, keys.parameters, context, &at)?;
            }
        }
    }
    let calibration = keys
        .calibration
        .map(|choice| calibration(choice, context, &label, &at.key("calibration")))
        .transpose()?;
    let contacts = contacts(
        &keys.contact,
        context.meshes,
        (calibration.is_some(), context.laws),
        &at.key("contact"),
    )?;
    let mut modelling = Modelling { gears, contacts };
    if let Some(constants) = calibration.as_ref().and_then(|c| c.constants.as_ref()) {
        let names: Vec<&str> = context.gears.iter().map(|g| g.spec.name.as_str()).collect();
        let applied = constants.apply(&model, &names, &mut modelling);
        applied.map_err(|e| {
            at.key("calibration")
                .error(e.to_string(), "this", e.reason.help)
        })?;
    }
    let integrators = (keys.integrators).map(|list| schemes(&list, &at.key("integrators")));
    Ok(ModelChoice {
        label,
        model,
        modelling,
        is_damped: false,
        calibration,
        own_gap: keys.gap_m,
        integrators: integrators.transpose()?,
        default_integrators: false,
        published: keys.published_s,
        published_derived: keys.published_derived,
    })
}

/// Path of a deck or reduction relative to the folder of the scene file; other text unchanged.
fn from_folder(text: &str, folder: Option<&Path>) -> String {
    let name = text.to_ascii_lowercase();
    let ends = [
        ".inp", ".inp.gz", ".msh", ".msh.gz", ".cdb", ".cdb.gz", ".npz",
    ];
    let is_path = ends.iter().any(|e| name.ends_with(e));
    let beside = folder.filter(|_| is_path).map(|f| f.join(text));
    match beside.filter(|p| p.is_file()) {
        Some(path) => path.to_string_lossy().into_owned(),
        None => text.to_owned(),
    }
}

/// Reads the model of a gear, whose table is at a place; refuses unknown models and keys.
fn gear_model(
    model: &str,
    keys: OrderedTable<ParameterValue>,
    context: &Context<'_>,
    at: &Place<'_>,
) -> Result<ModelSpec, SceneError> {
    let Some(row) = context.models.iter().find(|m| m.id == model) else {
        let known: Vec<&str> = context.models.iter().map(|m| m.id).collect();
        return at.first(&["model"]).refuse(
            format!("there is no model `{model}`"),
            "unknown name",
            suggest::there_are(model, &known),
        );
    };
    let at = at.key("parameters");
    let known = row.parameters;
    let meaning = |key: &str| {
        known
            .iter()
            .find(|p| p.key == key)
            .map_or("", |p| p.meaning)
    };
    let mut values = Vec::new();
    for (key, value) in keys.0 {
        if !known.iter().any(|p| p.key == key) {
            let names: Vec<&str> = known.iter().map(|p| p.key).collect();
            let number = match value {
                ParameterValue::Number(x) => Some(x),
                _ => None,
            };
            return at.key(&key).refuse(
                format!("the model `{model}` has no parameter `{key}`"),
                "unknown name",
                suggest::help_for(&key, number, &names, &meaning),
            );
        }
        let value = match value {
            ParameterValue::Number(x) => Value::from(x),
            ParameterValue::Text(text) => Value::from(from_folder(&text, context.folder)),
            ParameterValue::List(list) => Value::from(list),
            ParameterValue::Flag(flag) => Value::from(flag),
        };
        values.push((key, value));
    }
    row.spec(values).map_err(|e| {
        let at = match &*e.subject {
            Subject::Parameter { key, .. } => at.key(key),
            _ => at,
        };
        at.error(
            format!("{}: {}", e.subject, e.reason.cause),
            "this",
            e.reason.help,
        )
    })
}

fn contacts(
    keys: &OneOrMany<ContactTable>,
    meshes: usize,
    (calibrated, laws): (bool, &[Arc<dyn ForceLaw>]),
    at: &Place<'_>,
) -> Result<Vec<ContactSpec>, SceneError> {
    match keys {
        OneOrMany::One(keys) => Ok(vec![contact(keys, calibrated, laws, at)?; meshes]),
        OneOrMany::Many(list) if list.len() != meshes => at.refuse(
            format!("{} contacts for {meshes} meshes", list.len()),
            format!("expected {meshes}"),
            "give one contact for all meshes, or a list with one per mesh in their order",
        ),
        OneOrMany::Many(list) => (list.iter().enumerate())
            .map(|(i, keys)| contact(keys, calibrated, laws, &at.member(i)))
            .collect(),
    }
}
