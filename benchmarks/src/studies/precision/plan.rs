//! Plan of a study of accuracy against cost: variants of models with their series of resolutions, and their references.

use super::arguments::PrecisionOptions;
use super::references::{references, references_for};
use super::resolutions::Resolutions;
use crate::experiment::configuration::Configuration;
use crate::scene_file::{ModelChoice, SceneFile};
use gearbench_integrators::scheme::SchemeRequest;
use gearbench_integrators::{MethodError, Scheme};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::Metric;
use gearbench_reports::record::ReferenceSeries;
use std::collections::HashSet;

/// Default numbers of modes per gear.
pub const COUNTS: [usize; 6] = [0, 10, 35, 70, 100, 150];
/// Id of the full-order model, the reference of the others.
pub(super) const FULL: &str = FullOrderParameters::MODEL;

/// Model with a number of modes, and its series of resolutions.
#[derive(Clone, Debug)]
pub struct Variant {
    pub entry: Configuration,
    /// Modes per gear, where the study varies them; `None` keeps the model's own.
    pub modes: Option<usize>,
    /// Integrators at every step and tolerance, the coarsest of each first.
    pub methods: Vec<Scheme>,
    /// Ids of the references that the variant is compared with.
    pub against: Vec<String>,
}

/// Reference that the study computes.
#[derive(Clone, Debug)]
pub struct Full {
    /// Id of the reference in metrics.
    pub id: String,
    pub entry: Configuration,
    /// Integrator at a step so small that its own error is negligible; `None` takes the converged solution of gears
    /// with modes.
    pub method: Option<Scheme>,
    /// Title of the reference in the record.
    pub title: String,
}

/// Reference from a measurement or another program.
#[derive(Clone, Debug)]
pub struct External {
    /// Id of the reference in metrics.
    pub id: String,
    /// Own error of the reference, where it states one [-].
    pub own_error: Option<f64>,
}

/// Plan of a study of accuracy against cost.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Models with their series of resolutions.
    pub variants: Vec<Variant>,
    /// References that the study computes.
    pub fulls: Vec<Full>,
    /// References from measurements or other programs that a variant is compared with.
    pub external: Vec<External>,
    /// Metrics of the errors, the most important first.
    pub metrics: Vec<Metric>,
    /// Settings that name the references of each model.
    pub settings: Vec<(String, String)>,
    /// True if contact events are located.
    pub events: bool,
}

impl Plan {
    /// Plans the study of some models of a scene.
    ///
    /// # Errors
    /// A sentence about what was asked for and cannot be had.
    pub fn of(
        scene: &SceneFile,
        choices: &[&ModelChoice],
        external: &[ReferenceSeries],
        asked: &PrecisionOptions,
    ) -> Result<Plan, String> {
        let mut variants = Vec::new();
        for choice in choices {
            variants.extend(variants_of(scene, choice, asked)?);
        }
        let fulls = references(scene, choices, &variants, external, asked)?;
        let mut settings = Vec::new();
        for variant in &mut variants {
            let akin = references_for(scene, variant, &fulls, external);
            let stored = external.iter().map(|e| e.id.as_str());
            if variant
                .entry
                .fitted_to
                .as_deref()
                .is_some_and(|f| stored.clone().all(|id| id != f))
            {
                variant.entry.fitted_to = None;
            }
            // A reference that the user names is used even if its contact differs; the settings state the difference.
            variant.against = if asked.against.is_empty() {
                akin.clone()
            } else {
                asked.against.clone()
            };
            let what = format!("reference of model {}", variant.entry.label);
            if settings.iter().any(|(w, _)| *w == what) {
                continue;
            }
            let name = |id: &String| {
                let other = if akin.contains(id) {
                    ""
                } else {
                    " (another contact)"
                };
                format!("{id}{other}")
            };
            let names: Vec<String> = variant.against.iter().map(name).collect();
            settings.push((
                what,
                if names.is_empty() {
                    "its own converged solution alone: no reference has its contact".into()
                } else {
                    names.join(", ")
                },
            ));
        }
        let is_used = |id: &String| variants.iter().any(|v| v.against.contains(id));
        Ok(Plan {
            external: (external.iter().filter(|e| is_used(&e.id)))
                .map(|e| External {
                    id: e.id.clone(),
                    own_error: e.own_error,
                })
                .collect(),
            variants,
            fulls,
            metrics: metrics(scene, asked),
            settings,
            events: scene.study.events,
        })
    }
}

/// Returns the metrics of the command line, else those of the scene, else that of its tolerance.
fn metrics(scene: &SceneFile, asked: &PrecisionOptions) -> Vec<Metric> {
    if !asked.metrics.is_empty() {
        let mut each_once = asked.metrics.clone();
        let mut known = HashSet::new();
        each_once.retain(|m| known.insert(*m));
        return each_once;
    }
    if !scene.study.precision.metrics.is_empty() {
        return scene.study.precision.metrics.clone();
    }
    let own = scene.tolerance.as_ref().map(|t| t.metric);
    vec![own.filter(|m| m.is_error()).unwrap_or_default()]
}

/// A model, once or with each number of modes.
fn variants_of(
    scene: &SceneFile,
    choice: &ModelChoice,
    asked: &PrecisionOptions,
) -> Result<Vec<Variant>, String> {
    let own = &scene.study.precision;
    let or_scene = |asked: &[f64], scene: &[f64]| {
        let list = if asked.is_empty() { scene } else { asked };
        (!list.is_empty()).then(|| list.to_vec())
    };
    let resolutions = Resolutions {
        factors: (asked.steps.is_empty() && !own.factors.is_empty()).then(|| own.factors.clone()),
        steps: if choice.model == FULL {
            or_scene(&asked.steps, &[])
        } else {
            or_scene(&asked.steps, &own.steps)
        },
        rtols: or_scene(&asked.rtols, &own.rtols),
        full: choice.model == FULL,
    };
    let series = |methods: &[Scheme]| -> Vec<Scheme> {
        methods.iter().flat_map(|m| resolutions.of(m)).collect()
    };
    let of_model = choice.integrators.as_deref();
    let (methods, beside) = match &asked.integrators {
        Some(text) => (
            from_command_line(text, scene, &resolutions).map_err(|e| e.to_string())?,
            Vec::new(),
        ),
        None => match of_model {
            Some(methods) if choice.model == FULL => (series(methods), Vec::new()),
            Some(methods) => {
                let others = own.integrators.iter();
                let others = others.filter(|o| methods.iter().all(|m| m.method != o.method));
                let others: Vec<Scheme> = others.cloned().collect();
                (series(methods), series(&others))
            }
            None if own.integrators.is_empty() => (series(&scene.study.integrators), Vec::new()),
            None => (series(&own.integrators), Vec::new()),
        },
    };
    let one = |modes: Option<usize>, methods: Vec<Scheme>| {
        let mut entry = Configuration::of(scene, choice);
        if let Some(n) = modes {
            set_modes(&mut entry, n);
        }
        Variant {
            entry,
            modes,
            methods,
            against: Vec::new(),
        }
    };
    let Some(given) = counted(choice) else {
        return Ok(vec![one(None, [methods, beside].concat())]);
    };
    let mut counts = match (asked.modes.as_slice(), own.modes.as_slice()) {
        ([], []) => COUNTS.to_vec(),
        ([], scene) => scene.to_vec(),
        (asked, _) => asked.iter().map(|n| *n as usize).collect(),
    };
    counts.sort_unstable();
    counts.dedup();
    // Explicit integrators beside its own run every number of modes, so that what is compared is the integrator alone;
    // implicit ones, which take seconds, that of the scene or the nearest.
    let nearest = counts.iter().copied().min_by_key(|n| n.abs_diff(given));
    let implicit = |m: &Scheme| m.method.info().implicit;
    Ok(counts
        .into_iter()
        .map(|n| {
            let further = beside.iter().filter(|m| Some(n) == nearest || !implicit(m));
            one(Some(n), methods.iter().chain(further).cloned().collect())
        })
        .collect())
}

/// Integrators of the command line: those with `@` at that step or tolerance, the others with their series.
fn from_command_line(
    text: &str,
    scene: &SceneFile,
    resolutions: &Resolutions,
) -> Result<Vec<Scheme>, MethodError> {
    let asked = SchemeRequest::list(text)?;
    if asked.is_empty() {
        return Err(MethodError::Empty);
    }
    let known = &scene.study.integrators;
    let of = |a: &SchemeRequest| match a.resolution {
        Some(_) => vec![a.or_known(known)],
        None => resolutions.of(&a.or_known(known)),
    };
    Ok(asked.iter().flat_map(of).collect())
}

/// Modes that the scene gives an elastic model whose cut modes stay as residual compliance.
fn counted(choice: &ModelChoice) -> Option<usize> {
    let gears = choice.modelling.gears.iter();
    let elastic: Vec<_> = gears.filter_map(ElasticParameters::of).collect();
    let kept = elastic.iter().all(|p| p.keeps_residual());
    let modes = (elastic.iter()).filter_map(|p| p.most_modes()).next_back();
    (kept && !elastic.is_empty()).then(|| modes.unwrap_or(ElasticParameters::MODES))
}

fn set_modes(entry: &mut Configuration, n: usize) {
    ElasticParameters::change(&mut entry.modelling, |p| p.with_modes(n));
}
