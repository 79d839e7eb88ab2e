//! Scene files: TOML in SI units (angles in degrees), read into the data of [`gearbench_models::spec::scene`].
//!
//! | module | owns |
//! |---|---|
//! | `reader`, `suggest`, `error` | typed access with places, "did you mean", refusals with line and way out |
//! | `load` | scenes by name or path |
//! | `gear`, `geometry`, `profile`, `mesh` | `[gears.NAME]`, its loads and mount, `[[meshes]]` |
//! | `model`, `calibrated`, [`calibration`] | `[[models]]`, fitted constants |
//! | `contact`, `contact_points`, `stiffness` | `contact = { .. }` |
//! | `study_plan`, `precision_plan` | `[study]`, `tolerance` |
//! | [`stability`] | `[study] stability` |
//! | `locate` | the line that an error of the assembly is about |
//! | [`shipped`] | the scenes in the program |
//!
//! Everything that can be wrong in a file is found when it is loaded, geometry, laws, stiffness and the
//! models' own parameters included: every model of a scene is built once.

mod calibrated;
pub mod calibration;
mod contact;
mod contact_points;
mod error;
mod gear;
mod geometry;
mod load;
mod locate;
mod mesh;
mod model;
mod precision_plan;
mod profile;
mod reader;
pub mod shipped;
pub mod stability;
mod stiffness;
mod study_plan;
mod suggest;
#[cfg(test)]
mod tests;

pub use calibrated::CalibrationUse;
pub use calibration::Calibration;
pub use error::SceneError;
pub use load::{Selection, load, load_for, load_unbuilt, load_uncalibrated};
pub use model::ModelChoice;
pub use precision_plan::Precision;
pub use shipped::SHIPPED;
pub use study_plan::{Study, Sweep};

use crate::models::models as model_table;
use error::Source;
use gear::Place;
use gearbench_models::scene::Scene;
use gearbench_models::spec::SceneSpec;
use gearbench_reference::REFERENCES;
use gearbench_reports::record::Tolerance;
use model::ModelPlace;
use reader::{Key, Section, in_order, key};
use std::path::PathBuf;
use toml::de::DeTable;

/// The version of the format this program reads.
pub const SCHEMA: u32 = 1;

static SCENE: &[Key] = &[
    key("schema", "version of the format, 1"),
    key(
        "name",
        "lower-case letters, digits, `_` and `-`; names the output folder",
    ),
    key("title", "one line for lists and reports"),
    key("description", "what the scene shows, several lines"),
    key(
        "duration_s",
        "simulated time in seconds, for example 0.00025",
    ),
    key(
        "reference",
        "id of a stored reference, for example \"calculix/case-a-fine\"",
    ),
    key(
        "tolerance",
        "greatest error that is accurate enough, 0.05 or { metric, limit, against }",
    ),
    key("gears", "tables [gears.NAME]"),
    key("meshes", "tables [[meshes]]"),
    key("models", "tables [[models]], the configurations to compare"),
    key("study", "table [study]"),
];

/// Where a scene came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Embedded in the program.
    Shipped,
    /// A file.
    File(PathBuf),
}

/// A scene file that has been read and found sound.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// Name, for folders and records.
    pub name: String,
    /// One line.
    pub title: String,
    /// What it shows.
    pub description: String,
    /// Simulated time [s].
    pub duration: f64,
    /// Id of the stored reference.
    pub reference: Option<String>,
    /// What counts as accurate enough.
    pub tolerance: Option<Tolerance>,
    /// Gears and meshes.
    pub spec: SceneSpec,
    /// Configurations to compare, at least one.
    pub models: Vec<ModelChoice>,
    /// What a study does by default.
    pub study: Study,
    /// Where it came from.
    pub origin: Origin,
    source: Source,
    gears: Vec<Place>,
    meshes: Vec<mesh::MeshDraft>,
    model_places: Vec<ModelPlace>,
}

/// An error of the TOML syntax.
fn syntax_error(source: &Source, e: &toml::de::Error) -> SceneError {
    let message = e.message().trim().replace('\n', "; ");
    let help = "a line is `key = value`, a table begins with `[name]`, text stands in quotes, a name stands once \
                (https://toml.io)";
    source.error(
        e.span().unwrap_or(0..0),
        format!("not TOML: {message}"),
        "here",
        help,
    )
}

impl SceneFile {
    /// Reads the text of a scene; `name` stands in refusals.
    ///
    /// # Errors
    /// [`SceneError`] with line and a way out.
    pub fn parse(
        name: &str,
        text: &str,
        origin: Origin,
        calibrated: bool,
    ) -> Result<Self, SceneError> {
        let file = Self::unbuilt(name, text, origin, calibrated)?;
        file.check(&file.models.iter().collect::<Vec<_>>(), calibrated)?;
        Ok(file)
    }

    /// Reads a scene whose models need not be buildable.
    ///
    /// # Errors
    /// [`SceneError`]: what is wrong with the file, and where.
    pub fn unbuilt(
        name: &str,
        text: &str,
        origin: Origin,
        calibrated: bool,
    ) -> Result<Self, SceneError> {
        let source = Source::new(name, text);
        let document = DeTable::parse(source.text()).map_err(|e| syntax_error(&source, &e))?;
        let s = Section::open(&source, document.get_ref(), 0..0, name.to_owned(), SCENE)?;
        let schema = s.need("schema")?;
        if schema.whole()? != SCHEMA {
            return Err(schema.error(
                format!("the scene has schema {}", schema.whole()?),
                format!("expected {SCHEMA}"),
                "this program reads schema 1; a newer scene needs a newer gearbench",
            ));
        }
        let scene_name = scene_name(&s)?;
        let duration = s.need("duration_s")?;
        if duration.number()? <= 0.0 {
            return Err(duration.error(
                "the duration is not positive",
                "expected more than 0",
                "give the simulated time in seconds",
            ));
        }
        let reference = s.get("reference").map(|e| {
            e.word(
                &REFERENCES
                    .iter()
                    .map(|r| (r.id, r.id.to_owned()))
                    .collect::<Vec<_>>(),
            )
        });
        let reference = reference.transpose()?;
        let tolerance = s
            .get("tolerance")
            .map(|e| study_plan::tolerance(&e, reference.as_deref()))
            .transpose()?;

        let gear_tables = s.need("gears")?;
        let mut drafts = in_order(&source, gear_tables.raw_table()?)
            .iter()
            .map(gear::gear)
            .collect::<Result<Vec<_>, _>>()?;
        if drafts.is_empty() {
            return Err(s.missing("gears"));
        }
        let meshes = mesh::meshes(&s.need("meshes")?.list()?, &mut drafts)?;

        let find = |scene: &str| load::find_calibration(scene, &scene_name, &origin);
        let context = model::Context {
            scene: &scene_name,
            gears: &drafts,
            meshes: meshes.len(),
            models: model_table(),
            folder: match &origin {
                Origin::File(path) => path.parent(),
                Origin::Shipped => None,
            },
            calibrations: if calibrated { Some(&find) } else { None },
        };
        let (models, model_places): (Vec<_>, Vec<_>) =
            model::models(&s.need("models")?.list()?, &context)?
                .into_iter()
                .unzip();
        let labels: Vec<&str> = models
            .iter()
            .map(|m: &ModelChoice| m.label.as_str())
            .collect();
        let study = study_plan::study(s.get("study"), &labels)?;
        let tolerance = match (tolerance, &study.reference_model) {
            (Some(t), Some(label)) if t.against == study_plan::AGAINST_MODEL => Some(Tolerance {
                against: label.clone(),
                ..t
            }),
            (Some(t), None) if t.against == study_plan::AGAINST_MODEL => {
                return Err(s.need("tolerance")?.error(
                    "the tolerance is against a model, but the study names none",
                    "against nothing",
                    "add `reference_model = \"LABEL\"` to [study]",
                ));
            }
            (t, _) => t,
        };

        let text = |key: &str| {
            s.get(key)
                .map_or(Ok(String::new()), |e| e.text().map(|t| t.trim().to_owned()))
        };
        let (title, description) = (text("title")?, text("description")?);
        let duration = duration.number()?;
        let (specs, gears): (Vec<_>, Vec<_>) = drafts
            .into_iter()
            .map(|d| {
                let mut spec = d.spec;
                spec.position = d.position.unwrap_or_default();
                (spec, d.place)
            })
            .unzip();
        let spec = SceneSpec {
            gears: specs,
            meshes: meshes.iter().map(|m| m.spec.clone()).collect(),
        };
        Ok(SceneFile {
            name: scene_name,
            title,
            description,
            duration,
            reference,
            tolerance,
            spec,
            models,
            study,
            origin,
            source: source.clone(),
            gears,
            meshes,
            model_places,
        })
    }

    /// Builds every model once. Without calibrations a model that asks for one may lack its constants.
    fn check(&self, choices: &[&ModelChoice], calibrated: bool) -> Result<(), SceneError> {
        for choice in choices {
            let incomplete = choice.calibration.is_some() && !calibrated;
            if let Err(e) = Scene::build(&self.spec_for(choice), &choice.modelling, model_table())
                && !(incomplete && e.is_missing())
            {
                return Err(self.locate_in(&choice.label, &e));
            }
        }
        Ok(())
    }

    /// The text that it was read from.
    pub fn text(&self) -> &str {
        self.source.text()
    }

    /// A model by its label.
    pub fn model(&self, label: &str) -> Option<&ModelChoice> {
        self.models.iter().find(|m| m.label == label)
    }

    /// Models asked for on the command line, by labels between commas; `None` takes those of the study.
    ///
    /// # Errors
    /// [`SceneError`] lists the labels there are.
    pub fn select(&self, labels: Option<&str>) -> Result<Vec<&ModelChoice>, SceneError> {
        let wanted: Vec<&str> = match labels {
            Some(text) => text
                .split(',')
                .map(str::trim)
                .filter(|l| !l.is_empty())
                .collect(),
            None => self.study.models.iter().map(String::as_str).collect(),
        };
        let known: Vec<&str> = self.models.iter().map(|m| m.label.as_str()).collect();
        if wanted.is_empty() {
            return Err(SceneError::plain(
                "no model is named",
                format!("`{}` has {}", self.name, known.join(", ")),
            ));
        }
        wanted
            .iter()
            .map(|label| {
                self.model(label).ok_or_else(|| {
                    let near = suggest::nearest(label, &known)
                        .map_or(String::new(), |n| format!("did you mean `{n}`? "));
                    SceneError::plain(
                        format!("the scene `{}` has no model `{label}`", self.name),
                        format!("{near}it has {}", known.join(", ")),
                    )
                })
            })
            .collect()
    }

    /// The same for accuracy against cost, which may have models of its own by default.
    ///
    /// # Errors
    /// [`SceneError`] lists the labels there are.
    pub fn select_precision(&self, labels: Option<&str>) -> Result<Vec<&ModelChoice>, SceneError> {
        let own = self.study.precision.models.join(",");
        self.select(labels.or((!own.is_empty()).then_some(own.as_str())))
    }

    /// Gears and meshes as a model needs them: a calibration brings its own gap at the start.
    pub fn spec_for(&self, choice: &ModelChoice) -> SceneSpec {
        let mut spec = self.spec.clone();
        if let Some(gap) = choice.gap() {
            for mesh in &mut spec.meshes {
                mesh.start.gap = gap;
            }
        }
        spec
    }

    /// Where the calibrations of this scene are written: beside a file; for a shipped scene in the folder
    /// from which it is embedded, relative to the root of the repository.
    pub fn calibration_path(&self) -> PathBuf {
        match &self.origin {
            Origin::Shipped => PathBuf::from(format!("benchmarks/calibrations/{}.toml", self.name)),
            Origin::File(path) => path.with_extension("calibration.toml"),
        }
    }
}

fn scene_name(s: &Section<'_>) -> Result<String, SceneError> {
    let entry = s.need("name")?;
    let name = entry.text()?;
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
    if name.is_empty() || name.len() > 60 || !name.chars().all(fits) {
        return Err(entry.error(
            format!(
                "the name \"{}\" cannot be used",
                name.chars().take(60).collect::<String>()
            ),
            "expected lower-case letters, digits, `_` and `-`",
            "the name becomes a folder; the `title` may be any text",
        ));
    }
    Ok(name.to_owned())
}
