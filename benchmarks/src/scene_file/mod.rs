//! Scene files: TOML in SI units (angles in degrees), converted to [`gearbench_models::spec::scene`].
//!
//! | module | owns |
//! |---|---|
//! | `reading` | deserialisation of TOML with places, suggestions, limits and units |
//! | `error` | errors with line and help |
//! | [`format`] | the tables of a scene as values: made, changed and written by a program |
//! | `load` | scenes by name or path |
//! | `gear`, `geometry`, `profile`, `mesh` | `[gears.NAME]`, its loads and mount, `[[meshes]]` |
//! | `model`, `calibration_choice`, [`calibration`] | `[[models]]`, fitted constants |
//! | `contact`, `contact_points`, `stiffness` | `contact = { .. }` |
//! | `damping` | `damping`, which all models share |
//! | `study_plan` | `[study]`, `tolerance`; keys of a single study belong to its module |
//! | `plausibility`, `typical_ranges` | refusal of impossible values, warnings on unusual ones |
//! | `motion` | warnings on initial speeds and loads that do not suit the train |
//! | `selection` | models by their labels |
//! | `formulas` | warnings outside the validity range of a stiffness formula |
//! | [`references`] | references to compare with and fit to: stored ones, or tables of the user |
//! | `locate` | lines of errors of the assembly |
//! | [`shipped`] | scenes that are embedded in the program |
//!
//! All errors of a file are found when it is loaded, including those of geometry, force laws, stiffness and model
//! parameters: every model of a scene is built once.

pub mod calibration;
mod calibration_choice;
pub(crate) mod changes;
mod contact;
mod contact_points;
mod damping;
mod deviations;
mod error;
pub mod format;
mod formulas;
mod gear;
mod geometry;
mod load;
mod locate;
mod material;
mod measured;
mod mesh;
mod model;
mod modifications;
mod motion;
mod out_of_plane;
mod plausibility;
mod profile;
pub(crate) mod reading;
pub mod references;
mod selection;
mod shaft;
pub mod shipped;
pub mod source;
mod stage;
mod stiffness;
pub(crate) mod study_plan;
pub(crate) mod tables;
#[cfg(test)]
mod tests;
mod typical_ranges;

pub use calibration::Calibration;
pub use calibration_choice::CalibrationUse;
pub use error::SceneError;
pub(crate) use formulas::formula_limits;
pub use load::{Selection, load, load_for, load_unbuilt, load_uncalibrated};
pub use model::ModelChoice;
pub(crate) use reading::suggest::did_you_mean;
pub use references::{LoadedReference, NamedReference, ReferenceConditions};
pub use shipped::{SHIPPED, ShippedScene};
pub use study_plan::Study;

use crate::context::Context;
use crate::small_signals::stated_damping::StatedDamping;
use gearbench_integrators::Scheme;
use gearbench_models::error::Fault;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{GearSpec, SceneSpec};
use gearbench_reports::record::Tolerance;
use reading::Document;
use reading::keys::keys;
use reading::values::{OrderedTable, Positive, is_default};
use references::{ReferenceChoice, ReferenceTable};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use toml::de::{DeTable, DeValue};

keys! {
    /// A scene file.
    #[derive(Default)]
    struct SceneTable {
        /// version of the format, 1
        schema: Schema,
        /// lower-case letters, digits, `_` and `-`; names the output folder
        name: SceneName,
        /// one line for lists and reports
        #[serde(default, skip_serializing_if = "is_default")]
        title: String,
        /// purpose of the scene, several lines
        #[serde(default, skip_serializing_if = "is_default")]
        description: String,
        /// simulated time in seconds, for example 0.00025
        duration_s: Positive,
        /// reference that models are compared with: id of a stored one, as "calculix/case-a-fine", or { csv = "press.csv" }
        reference: Option<ReferenceChoice>,
        /// tables [[references]] of further ones, also at other speeds and loads
        references: Option<Vec<ReferenceTable>>,
        /// greatest error that is accurate enough, 0.05 or { metric, limit, against, except }
        tolerance: Option<study_plan::ToleranceChoice>,
        /// tables [gears.NAME]
        gears: OrderedTable<gear::ToothedTable>,
        /// tables [[meshes]]
        meshes: Vec<mesh::MeshTable>,
        /// tables [[shafts]]: shafts with several gears, or with gears and bodies without teeth
        shafts: Option<Vec<shaft::ShaftTable>>,
        /// tables [[stages]]: ratios between gears or bodies whose teeth are not resolved
        stages: Option<Vec<stage::StageTable>>,
        /// damping of the mesh mode that all models share, { mesh_ratio }, { loss_factor } or { rayleigh }; left out, each
        /// model has its own
        damping: Option<damping::SharedDampingTable>,
        /// tables [[models]], the configurations to compare
        models: Vec<model::ModelTable>,
        /// tables [calibration.NAME.LABEL] of fitted constants, as `gearbench identify` writes them next to the scene
        #[serde(default, skip_serializing_if = "is_default")]
        calibration: calibration::Sets,
        /// table [study]
        #[serde(default, skip_serializing_if = "is_default")]
        study: study_plan::StudyTable,
    }
}

/// Version of the scene format that this program reads.
pub const SCHEMA: u32 = 1;

/// Version of the format of a file, which must equal [`SCHEMA`].
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct Schema;

impl From<Schema> for u32 {
    fn from(_: Schema) -> u32 {
        SCHEMA
    }
}

impl TryFrom<u32> for Schema {
    type Error = String;

    fn try_from(schema: u32) -> Result<Self, String> {
        (schema == SCHEMA).then_some(Schema).ok_or_else(|| {
            format!("the scene has schema {schema}, expected {SCHEMA}: a newer scene needs a newer gearbench")
        })
    }
}

/// A name that is valid as name of a folder.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "String")]
pub struct SceneName(pub String);

impl TryFrom<String> for SceneName {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
        if !name.is_empty() && name.len() <= 60 && name.chars().all(fits) {
            return Ok(SceneName(name));
        }
        let shown: String = name.chars().take(60).collect();
        Err(format!(
            "the name \"{shown}\" cannot be the name of a folder; the `title` may be any text"
        ))
    }
}

/// Origin of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A scene that is embedded in the program.
    Shipped,
    /// A file of the user.
    File(PathBuf),
}

/// A model that cannot run its scene.
#[derive(Clone, Debug)]
pub struct RefusedModel {
    /// Label of the model in the scene.
    pub label: String,
    /// Model id, as in the table of models.
    pub model: String,
    /// The reason at the line of the scene, with help.
    pub error: SceneError,
}

/// A scene file that was read and checked.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// Name of the scene, for folders and records.
    pub name: String,
    /// Title in one line.
    pub title: String,
    /// Description of the scene for lists and reports.
    pub description: String,
    /// Simulated time [s].
    pub duration: f64,
    /// References that models are compared with and fitted to, in the order of the file; their data are read when a
    /// study needs them.
    pub references: Vec<NamedReference>,
    /// The accuracy that the scene requires: metric, reference and largest error.
    pub tolerance: Option<Tolerance>,
    /// Gears, shafts and meshes.
    pub spec: SceneSpec,
    /// Damping that all models share.
    pub damping: Option<StatedDamping>,
    /// Models to compare, at least one.
    pub models: Vec<ModelChoice>,
    /// Defaults of studies of this scene.
    pub study: Study,
    /// True if models have the constants of their calibrations.
    pub(crate) calibrated: bool,
    /// Files from which measured flanks, loads and motions were read.
    pub data_files: Vec<PathBuf>,
    /// Origin of the scene.
    pub origin: Origin,
    /// Warnings on values that are valid but implausible.
    pub odd: Vec<SceneError>,
    /// Models that were built and cannot run the scene: studies record the reason and run the others.
    pub refused: Vec<RefusedModel>,
    /// The context that the scene was loaded in.
    pub context: Context,
    document: Document,
}

impl SceneFile {
    /// Parses the text of a scene; `name` is its name in errors.
    ///
    /// # Errors
    /// [`SceneError`] with line and help.
    pub fn parse(
        context: &Context,
        name: &str,
        text: &str,
        origin: Origin,
        calibrated: bool,
    ) -> Result<Self, SceneError> {
        let mut file = Self::unbuilt(context, name, text, origin, calibrated)?;
        let all: Vec<usize> = (0..file.models.len()).collect();
        file.check(&all, calibrated, &|_, _| {})?;
        Ok(file)
    }

    /// Parses a scene without building its models.
    ///
    /// # Errors
    /// [`SceneError`] with the place in the file.
    pub fn unbuilt(
        context: &Context,
        name: &str,
        text: &str,
        origin: Origin,
        calibrated: bool,
    ) -> Result<Self, SceneError> {
        let (document, keys) = SceneTable::read(context, name, text)?;
        let odd = typical_ranges::lengths(&document);
        let file = Self::from_keys(context, document, keys, origin, calibrated);
        let mut file = file.map_err(|e| e.with_remarks(&odd))?;
        file.odd.extend(odd);
        Ok(file)
    }

    /// Parses a changed text of this scene without building its models; paths count from the same folder.
    ///
    /// # Errors
    /// [`SceneError`] with the place in the changed text.
    pub fn with_text(&self, text: &str) -> Result<Self, SceneError> {
        let name = self.document.at("").file();
        let origin = self.origin.clone();
        Self::unbuilt(&self.context, name, text, origin, self.calibrated)
    }

    fn from_keys(
        context: &Context,
        document: Document,
        keys: SceneTable,
        origin: Origin,
        calibrated: bool,
    ) -> Result<Self, SceneError> {
        let SceneTable {
            schema: Schema,
            name: SceneName(name),
            ..
        } = keys;
        let root = document.at("");
        let folder = match &origin {
            Origin::File(path) => path.parent(),
            Origin::Shipped => None,
        };
        let files = measured::DataFiles::beside(folder);
        let mut drafts = (keys.gears.0.into_iter())
            .map(|(name, keys)| {
                let at = root.key("gears").key(&name);
                gear::check_name(&name, &at)?;
                gear::gear(&name, keys, &files, &at)
            })
            .collect::<Result<Vec<_>, _>>()?;
        if drafts.is_empty() {
            return Err(root.missing("gears", &SceneTable::TABLE));
        }
        let shafts = keys.shafts.unwrap_or_default();
        let shafts = shaft::shafts(shafts, &mut drafts, &files, &root.key("shafts"))?;
        let on_shafts = shaft::groups(&shafts);
        let meshes = mesh::meshes(&keys.meshes, &mut drafts, &on_shafts, &root)?;
        let own = Calibration::of(keys.calibration, &root.key("calibration"))?;
        let find = |scene: &str| load::find_calibration(context, scene, (&name, &own), &origin);
        let parts = model::Context {
            scene: &name,
            shipped: origin == Origin::Shipped,
            gears: &drafts,
            meshes: meshes.len(),
            models: &context.models,
            laws: &context.laws,
            folder,
            calibrations: &find,
            calibrated,
            damped: keys.damping.is_some(),
        };
        let damping = keys.damping.as_ref();
        let damping = damping.map(|keys| damping::damping(keys, &root.key("damping")));
        let damping = damping.transpose()?;
        let mut models = model::models(keys.models, &parts, &root.key("models"))?;
        if keys.study.integrators.is_none() {
            let gears: Vec<&GearSpec> = drafts.iter().map(|d| &d.spec).collect();
            for m in models.iter_mut().filter(|m| m.integrators.is_none()) {
                m.integrators =
                    study_plan::default_of(properties_of(&context.models, &m.model), &gears);
                m.default_integrators = m.integrators.is_some();
            }
        }
        let labels: Vec<&str> = models.iter().map(|m| m.label.as_str()).collect();
        let study = study_plan::study(keys.study, &labels, &root.key("study"))?;
        let gears = drafts.iter().map(|draft| GearSpec {
            position: draft.position.unwrap_or_default(),
            ..draft.spec.clone()
        });
        let mut spec = SceneSpec {
            duration: keys.duration_s.0,
            gears: gears.collect(),
            meshes,
            shafts,
            stages: Vec::new(),
        };
        let misalignments = drafts.iter().map(|draft| draft.misalignment.as_ref());
        mesh::misalign(&mut spec, misalignments, &root.key("gears"))?;
        mesh::check_axes(&spec, keys.duration_s.0, &root.key("gears"))?;
        shaft::roll_planets(&mut spec, &root.key("gears"));
        let stages = keys.stages.unwrap_or_default();
        spec.stages = stage::stages(stages, &spec, &root.key("stages"))?;
        let beside = references::SceneParts {
            spec: &spec,
            labels: &labels,
            folder,
            duration: keys.duration_s.0,
        };
        let several = keys.references.unwrap_or_default();
        let references = references::references(keys.reference, several, &beside, &root)?;
        let reference_model = study.reference_model.as_deref();
        let tolerance = keys.tolerance.map(|choice| {
            let at = root.key("tolerance");
            study_plan::tolerance(choice, &models, &references, reference_model, &at)
        });
        let tolerance = tolerance.transpose()?;
        let mut file = SceneFile {
            name,
            title: keys.title.trim().to_owned(),
            description: keys.description.trim().to_owned(),
            duration: keys.duration_s.0,
            references,
            tolerance,
            spec,
            damping,
            models,
            study,
            calibrated,
            data_files: files.into_paths(),
            origin,
            odd: Vec::new(),
            refused: Vec::new(),
            context: context.clone(),
            document,
        };
        file.odd = plausibility::check(&file)?;
        Ok(file)
    }

    /// Refuses steps of the command line that are longer than the simulated time.
    ///
    /// # Errors
    /// [`SceneError`] with both.
    pub fn check_steps(&self, schemes: &[Scheme]) -> Result<(), SceneError> {
        match schemes
            .iter()
            .find_map(|s| plausibility::step_too_long(s, self.duration))
        {
            Some(why) => Err(SceneError::plain(why, "give a smaller step, as in rk4@1us")),
            None => Ok(()),
        }
    }

    /// Builds models, given by their indices, sets the default integrators of those for which the scene names none, and
    /// stores which of them cannot run the scene. Returns warnings on the others. `begins` receives the number of
    /// models built so far and the label of the next. Without calibrations a model that uses one may lack its
    /// constants.
    ///
    /// # Errors
    /// [`SceneError`] when a value is wrong, and when none of the models can run.
    fn check(
        &mut self,
        choices: &[usize],
        calibrated: bool,
        begins: &dyn Fn(usize, &str),
    ) -> Result<Vec<SceneError>, SceneError> {
        let mut odd = Vec::new();
        let (mut refused, mut defaults) = (Vec::new(), Vec::new());
        for (done, &place) in choices.iter().enumerate() {
            let choice = &self.models[place];
            begins(done, &choice.label);
            let incomplete = choice.calibration.is_some() && !calibrated;
            let damped = self.damp(place);
            let choice = &self.models[place];
            let built = damped.and_then(|more| {
                odd.extend(more);
                Scene::build(
                    &self.spec_for(choice),
                    &choice.modelling,
                    &self.context.models,
                )
            });
            match built {
                Ok(mut scene) => {
                    odd.extend(self.without_effect(choice, &scene)?);
                    odd.extend(self.outside_formulas(choice));
                    if choice.default_integrators {
                        let default =
                            study_plan::default_in(self.properties_of(&choice.model), &mut scene);
                        defaults.extend(default.map(|d| (place, d)));
                    }
                }
                Err(e) if incomplete && e.is_missing() => {}
                Err(e) if e.fault == Fault::Model => refused.push(RefusedModel {
                    label: choice.label.clone(),
                    model: choice.model.clone(),
                    error: self.locate_in(&choice.label, &e),
                }),
                Err(e) => return Err(self.locate_in(&choice.label, &e)),
            }
        }
        if !choices.is_empty() && refused.len() == choices.len() {
            return Err(SceneError::all_of(refused.into_iter().map(|r| r.error)));
        }
        self.refused.extend(refused);
        for (place, methods) in defaults {
            self.models[place].integrators = Some(methods);
        }
        Ok(odd)
    }

    /// True if a model was built and cannot run the scene.
    pub fn is_refused(&self, label: &str) -> bool {
        self.refused.iter().any(|r| r.label == label)
    }

    /// Returns the properties of a gear model by its id.
    pub fn properties_of(&self, model: &str) -> Properties {
        properties_of(&self.context.models, model)
    }

    /// The text of the scene file.
    pub fn text(&self) -> &str {
        self.document.text()
    }

    /// Returns a model by its label.
    pub fn model(&self, label: &str) -> Option<&ModelChoice> {
        self.models.iter().find(|m| m.label == label)
    }

    /// The gears and meshes for a model: a calibration may change the gap at the start.
    pub fn spec_for(&self, choice: &ModelChoice) -> SceneSpec {
        let mut spec = self.spec.clone();
        if let Some(gap) = choice.gap() {
            for mesh in &mut spec.meshes {
                mesh.start.gap = gap;
            }
        }
        spec
    }

    /// Path to which calibrations of this scene are written: next to the file; for a shipped scene in the folder from
    /// which it is embedded, relative to the root of the repository.
    pub fn calibration_path(&self) -> PathBuf {
        match &self.origin {
            Origin::Shipped => PathBuf::from(format!("benchmarks/calibrations/{}.toml", self.name)),
            Origin::File(path) => path.with_extension("calibration.toml"),
        }
    }
}

/// Names that the scene defines, and those of the table of models, by their type.
fn known_words(scene: &DeTable<'_>, models: &[Model]) -> Vec<(&'static str, Vec<String>)> {
    let table = |key: &str| scene.get(key).and_then(|v| v.get_ref().as_table());
    let gears = table("gears").into_iter().flatten();
    let list = scene.get("models").and_then(|v| v.get_ref().as_array());
    let label = |model: &DeValue<'_>| {
        let model = model.as_table()?;
        let label = model.get("label").or(model.get("model"))?;
        label.get_ref().as_str().map(str::to_owned)
    };
    let labels = (list.into_iter().flat_map(|l| l.iter())).filter_map(|m| label(m.get_ref()));
    let ids = models.iter().map(|m| m.id.to_owned());
    vec![
        (
            "<gear>",
            gears.map(|(name, _)| name.get_ref().to_string()).collect(),
        ),
        ("<model>", labels.collect()),
        ("<gear model>", ids.collect()),
        (
            "<calibration>",
            calibration::NAMES.map(str::to_owned).to_vec(),
        ),
    ]
}
