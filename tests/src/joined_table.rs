//! The joined table of models, with typical parameters of each.

use crate::{case_a, contact, elastic_toy, elastic_web, flank_test_gears, nodal_test_gear};
use gearbench::context::Context;
use gearbench_models::gear::movable_teeth::{MovableTeethParameters, PerTooth};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::table::{MODELS, Model};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, FlankContact, ModelSpec, Modelling, PointContact};
use serde_json::Value;

/// Returns all models: the table of the crate and the example.
pub fn models() -> Vec<Model> {
    [MODELS, &[elastic_web::MODEL]].concat()
}

/// The context of a program that adds the example to the table.
pub fn joined() -> Context {
    Context::default().with_model(elastic_web::MODEL)
}

/// Returns all models, finite elements and the test gears with flanks.
pub fn models_with_flanks() -> Vec<Model> {
    let mut table = models();
    table.extend_from_slice(gearbench_reference::MODELS);
    table.extend([
        flank_test_gears::RIGID,
        nodal_test_gear::NODAL,
        elastic_toy::ELASTIC_TOY,
    ]);
    table
}

/// Returns a model of the table with parameters by their keys.
pub fn model_of<K: Into<String>, V: Into<Value>>(
    id: &str,
    values: impl IntoIterator<Item = (K, V)>,
) -> ModelSpec {
    let table = models_with_flanks();
    let row = table.iter().find(|m| m.id == id).unwrap();
    row.spec(values).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns the rigid model.
pub fn rigid() -> ModelSpec {
    gearbench_models::gear::rigid::spec()
}

/// Returns movable teeth with spring [N/m], mass [kg] and damper [N s/m] of each tooth.
pub fn movable(k: f64, m: f64, c: f64) -> ModelSpec {
    MovableTeethParameters {
        tooth_stiffness_n_per_m: Some(PerTooth::All(k)),
        tooth_mass_kg: Some(PerTooth::All(m)),
        tooth_damping_ns_per_m: Some(PerTooth::All(c)),
        ..MovableTeethParameters::default()
    }
    .spec()
}

/// Returns a model with another parameter.
pub fn with(mut model: ModelSpec, key: &str, value: impl Into<Value>) -> ModelSpec {
    model.set(key, value).unwrap_or_else(|e| panic!("{e}"));
    model
}

/// Returns movable teeth that are all integrated.
pub fn all_teeth(model: ModelSpec) -> ModelSpec {
    with(model, "integrate", "all")
}

/// Returns the example model: half of the inertia in a rim of 20 kHz.
pub fn web(damping_ratio: f64) -> ModelSpec {
    elastic_web::ElasticWebParameters {
        frequency_hz: Some(2e4),
        rim_share: Some(0.5),
        damping_ratio: Some(damping_ratio),
    }
    .spec()
}

/// Typical values of parameters, whatever the model: undamped, with the coarsest meshes.
const USUAL: [(&str, f64); 12] = [
    ("tooth_stiffness_n_per_m", 5.3e8),
    ("tooth_mass_kg", 4.8e-3),
    ("tooth_damping_ns_per_m", 0.0),
    ("frequency_hz", 2e4),
    ("rim_share", 0.5),
    ("damping_ratio", 0.0),
    ("flank_elements", 6.0),
    ("fillet_elements", 2.0),
    ("across_elements", 4.0),
    ("rim_elements", 2.0),
    ("width_elements", 1.0),
    ("modes", 20.0),
];

/// Values that define a variant of a model with the parameter.
const VARIANTS: [(&str, &str); 2] = [("integrate", "all"), ("mass", "lumped")];

/// Returns a row of the table with typical parameters.
pub fn usual(model: &Model) -> ModelSpec {
    let takes = |key: &str| model.parameters.iter().any(|p| p.key == key);
    let spec = model.spec(USUAL.into_iter().filter(|(key, _)| takes(key)));
    let spec = spec.unwrap_or_else(|e| panic!("{e}"));
    let values = spec.values();
    for p in model.parameters.iter().filter(|p| p.required) {
        let known = values.contains_key(p.key);
        assert!(known, "{} needs a usual value of {}", model.id, p.key);
    }
    spec
}

/// Returns the contact stiffness per width [N/m per m] for [`usual`]: the part that the model itself does not include.
pub fn usual_stiffness(model: &Model) -> f64 {
    if model.properties.rigid {
        1.54e10
    } else {
        5e10
    }
}

/// A model of the joined table under test: all shipped models and the example, with their variants.
pub struct Subject {
    /// Row of the model.
    pub model: Model,
    /// Identifier of the row, with a suffix for the variant.
    pub name: String,
    /// Typical parameters of the model.
    pub spec: ModelSpec,
    /// Contact of the model: of tooth pairs, or of flank points for a model with its own flanks.
    pub contact: ContactSpec,
    /// True if the model has its own flanks.
    pub flanks: bool,
}

/// Returns all models of the joined table.
pub fn subjects() -> Vec<Subject> {
    let mut all = Vec::new();
    for model in &*joined().models {
        let plain = (model.id.to_string(), usual(model));
        let takes = |key: &str| model.parameters.iter().any(|p| p.key == key);
        let variants = VARIANTS.iter().filter(|(key, _)| takes(key));
        let variants = variants.map(|(key, value)| {
            let spec = with(usual(model), key, *value);
            (format!("{}, {key} = {value}", model.id), spec)
        });
        for (name, spec) in std::iter::once(plain).chain(variants) {
            let pairs = contact(usual_stiffness(model));
            let points = ContactSpec {
                flanks: FlankContact::Points(PointContact::new(1e15)),
                ..contact(1.5e10)
            };
            let flanks = of_flanks(&spec, &pairs);
            all.push(Subject {
                model: *model,
                name,
                spec,
                contact: if flanks { points } else { pairs },
                flanks,
            });
        }
    }
    all
}

/// Returns true if a model requires the contact of flank points and refuses that of tooth pairs.
fn of_flanks(model: &ModelSpec, pairs: &ContactSpec) -> bool {
    let modelling = Modelling {
        gears: vec![model.clone(), model.clone()],
        contacts: vec![pairs.clone()],
    };
    Scene::build(&case_of_body(3e-6), &modelling, &joined().models).is_err()
}

/// Returns the impact of [`case_a`] with the inertia of the bodies.
pub fn case_of_body(gap: f64) -> gearbench_models::spec::SceneSpec {
    let mut spec = case_a(gap);
    for g in &mut spec.gears {
        g.inertia = None;
    }
    spec
}

impl Subject {
    /// Builds the impact of case A with this model for both gears.
    pub fn scene(&self, gap: f64) -> Scene {
        let modelling = Modelling {
            gears: vec![self.spec.clone(), self.spec.clone()],
            contacts: vec![self.contact.clone()],
        };
        Scene::build(&case_of_body(gap), &modelling, &joined().models)
            .unwrap_or_else(|e| panic!("{}: {e}", self.name))
    }
}
