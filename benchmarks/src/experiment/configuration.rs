//! A configuration to run: one model of a scene with its parameters.

use crate::scene_file::{ModelChoice, NamedReference, SceneFile};
use gearbench_integrators::Scheme;
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reports::record::{Run, Status};

/// A configuration to run: one model with its scene (a calibration may change the initial gap).
#[derive(Clone, Debug)]
pub struct Configuration {
    /// Label in records and on the command line.
    pub label: String,
    /// Model id in records: the model of the gears, or `mixed`.
    pub model: String,
    /// Name of the calibration that supplies the constants.
    pub calibration: Option<String>,
    /// Id of the scene's own reference to whose history the constants were fitted.
    pub fitted_to: Option<String>,
    /// The scene, with the changes of this model.
    pub scene: SceneSpec,
    /// Models of gears and contacts.
    pub modelling: Modelling,
    /// Integrators of this model, where they differ from those of the study.
    pub methods: Option<Vec<Scheme>>,
    /// Published computing time of such a model [s].
    pub published: Option<f64>,
    /// True if the published time is derived from other published numbers.
    pub published_derived: bool,
}

impl Configuration {
    /// The configuration of a model in its scene.
    pub fn of(scene: &SceneFile, choice: &ModelChoice) -> Configuration {
        Configuration {
            label: choice.label.clone(),
            model: choice.model.clone(),
            calibration: choice.calibration.as_ref().map(|c| c.name.clone()),
            fitted_to: fitted_to(scene, choice),
            scene: scene.spec_for(choice),
            modelling: choice.modelling.clone(),
            methods: choice.integrators.clone(),
            published: choice.published,
            published_derived: choice.published_derived,
        }
    }

    /// The part of the label that distinguishes this configuration from others of the same model.
    pub fn variant(&self) -> Option<String> {
        Run::called(&self.label, &self.model).variant
    }

    /// The label of the model in reports.
    pub fn model_label(&self) -> String {
        Run::called(&self.label, &self.model).model_label()
    }

    /// The row of the record if this model cannot run.
    pub fn refused(&self, why: String) -> Run {
        let mut row = refused(&self.label, &self.model, why);
        self.sign(&mut row);
        row
    }

    /// Writes label, model and calibration to a row of the record.
    pub fn sign(&self, row: &mut Run) {
        row.model.clone_from(&self.model);
        row.variant = self.variant();
        row.calibration.clone_from(&self.calibration);
        row.fitted_to.clone_from(&self.fitted_to);
    }
}

/// The integrator that a record states for a model that was not run.
const NO_METHOD: &str = "none";

/// The row of a model that cannot run: without method and numbers.
pub fn refused(label: &str, model: &str, why: String) -> Run {
    Run {
        integrator: NO_METHOD.into(),
        status: Status::Refused,
        message: Some(why),
        wall_s: f64::NAN,
        setup_s: f64::NAN,
        simulated_s: f64::NAN,
        ..Run::called(label, model)
    }
}

/// The reference of the scene to whose history the constants of a model were fitted, according to its calibration.
fn fitted_to(scene: &SceneFile, choice: &ModelChoice) -> Option<String> {
    let calibration = choice.calibration.as_ref()?;
    let fitted = &calibration.stored.as_ref()?.fitted_to;
    let is_fitted = |r: &&NamedReference| match r.stored() {
        Some(id) => fitted.iter().any(|name| name == id),
        // Tables of two scenes may have one name.
        None => calibration.scene == scene.name && fitted.contains(&r.name),
    };
    let mut references = scene.references.iter().filter(|r| r.is_of_the_scene());
    references.find(is_fitted).map(|r| r.name.clone())
}
