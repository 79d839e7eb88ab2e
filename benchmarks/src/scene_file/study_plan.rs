//! The keys `[study]` and `tolerance`: defaults of studies and required accuracy. Keys of a single study belong to the
//! module of that study.

use super::error::SceneError;
use super::model::ModelChoice;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::suggest::there_are;
use super::reading::values::{
    Count, Distinct, Label, Method, MetricKey, OneOrMany, Positive, QuantityKey, Share, is_default,
};
use super::references::NamedReference;
use crate::studies::compare::REFINED;
use crate::studies::precision::scene::{Precision, PrecisionTable};
use crate::studies::stability::scene::{StabilitySet, StabilityTable};
use crate::studies::sweep::scene::Sweep;
use gearbench_integrators::SecondOrderSystem as _;
use gearbench_integrators::modal::resonance::safe_step;
use gearbench_integrators::table::{DOPRI5, HHT_ALPHA, NEWMARK, TRIGONOMETRIC};
use gearbench_integrators::{METHODS, MethodSpec, Resolution, Scheme, Stepping};
use gearbench_models::gear::properties::Properties;
use gearbench_models::scene::Scene;
use gearbench_models::spec::GearSpec;
use gearbench_reports::Metric;
use gearbench_reports::record::{SELF, Tolerance};
use serde::{Deserialize, Serialize};

keys! {
    /// The table `[study]`: defaults of studies.
    #[derive(Default)]
    struct StudyTable {
        /// labels to compare, default all models of the scene
        models: Option<Distinct<Label>>,
        /// list such as [{ method = "dopri5", rtol = 1e-6 }, { method = "rk4", step_s = 1e-6 }], default those of the model
        integrators: Option<Vec<IntegratorTable>>,
        /// locate contact events, default true
        events: Option<bool>,
        /// samples of the histories over the duration, default 2000, which are enough for a chart
        samples: Option<Count<2, 1_000_000>>,
        /// metrics of interest, default all, for example ["force_l2_aligned", "peak_force_n", "speeds_end"]
        quantities: Option<Distinct<QuantityKey>>,
        /// label of a model whose run the others are compared with, in addition to the scene's reference
        reference_model: Option<Label>,
        /// frequency above which the force of each mesh of a scene with several counts as ripple, for example 25e3
        ripple_above_hz: Option<Positive>,
        /// where the times `published_s` of the models were published
        published: Option<String>,
        /// speeds of `gearbench sweep`: { from_hz, to_hz, points, cycles, turns, settle_s, branches }
        #[serde(default, skip_serializing_if = "is_default")]
        sweep: Sweep,
        /// maps of `gearbench stability`, one set or a list: { models, integrators, duration_s, step_s, axes }
        stability: Option<OneOrMany<StabilityTable>>,
        /// defaults of `gearbench precision`: { models, integrators, modes, factors, steps_s, rtols, metrics,
        /// duration_s }
        #[serde(default, skip_serializing_if = "is_default")]
        precision: PrecisionTable,
    }

    /// An integrator with its step or tolerance.
    struct IntegratorTable {
        /// id or id(name=value), for example "generalised-alpha(rho_inf=0.8)"
        method: Method,
        /// fixed step in seconds, for example 1e-6
        step_s: Option<Positive>,
        /// relative tolerance, for example 1e-6
        rtol: Option<Share>,
    }

    /// The accuracy that a scene requires.
    #[derive(Default)]
    struct ToleranceTable {
        /// metric that is limited, default "force_l2_aligned", against "self" "force_l1"
        metric: Option<MetricKey>,
        /// greatest magnitude that is accurate enough, for example 0.05
        limit: Positive,
        /// "reference" (the scene's first), the name of one, "model" (the study's `reference_model`), "refined" (elastic
        /// gears that gearbench refines for it) or "self", the model's own converged solution; default the first of the
        /// first four that the scene has
        against: Option<String>,
        /// labels of models that are shown for their error: beyond the limit they leave the exit code at 0
        except: Option<Distinct<Label>>,
    }
}

impl From<&Scheme> for IntegratorTable {
    fn from(scheme: &Scheme) -> Self {
        let (step_s, rtol) = match scheme.resolution {
            Resolution::Step(h) => (Some(Positive(h)), None),
            Resolution::Tolerance(r) => (None, Some(Share(r))),
        };
        IntegratorTable {
            method: Method(scheme.method),
            step_s,
            rtol,
        }
    }
}

/// A limit of the default metric, or metric, limit and reference.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum ToleranceChoice {
    /// The limit of the default metric.
    #[serde(rename = "<number>")]
    Limit(Positive),
    /// Metric, limit and reference.
    #[serde(rename = "<table>")]
    Full(ToleranceTable),
}

/// Default number of samples of the histories.
const DEFAULT_SAMPLES: usize = 2000;
/// Default relative tolerance of adaptive methods.
const DEFAULT_RTOL: f64 = 1e-6;

/// Largest default step of the method that is exact for modes [s]. It resolves the contact and its effect on the modes,
/// not the modes themselves.
const EXACT_STEP: f64 = 1e-6;
/// Default step of full finite elements, in travel times of a wave across a module.
const CROSSING: f64 = 0.5;

/// Defaults of studies of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Labels of the models, in the order of the scene.
    pub models: Vec<String>,
    /// Integration methods with their step or tolerance.
    pub integrators: Vec<Scheme>,
    /// True if contact events are located.
    pub events: bool,
    /// Number of samples of the histories over the duration.
    pub samples: usize,
    /// Metrics of interest; empty for all.
    pub quantities: Vec<Metric>,
    /// Label of a model that serves as reference for the others.
    pub reference_model: Option<String>,
    /// Frequency above which the force of a mesh counts as ripple [Hz].
    pub ripple_above: Option<f64>,
    /// Source of the published computing times.
    pub published: Option<String>,
    /// Settings of the speed sweep.
    pub sweep: Sweep,
    /// Settings of maps of stability.
    pub stability: Vec<StabilitySet>,
    /// Settings of the study of accuracy against cost.
    pub precision: Precision,
}

/// Checks `[study]`; `labels` are those of the models.
pub(super) fn study(
    keys: StudyTable,
    labels: &[&str],
    at: &Place<'_>,
) -> Result<Study, SceneError> {
    let integrators = (keys.integrators).map(|list| schemes(&list, &at.key("integrators")));
    let all = || labels.iter().map(|l| (*l).to_owned()).collect();
    keys.sweep.check(&at.key("sweep"))?;
    let stability = at.key("stability");
    let stability = match keys.stability {
        None => Vec::new(),
        Some(OneOrMany::One(set)) => vec![set.read(&stability)?],
        Some(OneOrMany::Many(sets)) => (sets.into_iter().enumerate())
            .map(|(i, set)| set.read(&stability.member(i)))
            .collect::<Result<_, _>>()?,
    };
    Ok(Study {
        models: keys.models.map_or_else(all, Distinct::labels),
        integrators: integrators.unwrap_or_else(|| Ok(default_integrators()))?,
        events: keys.events.unwrap_or(true),
        samples: keys.samples.map_or(DEFAULT_SAMPLES, |n| n.0),
        quantities: (keys.quantities.into_iter())
            .flat_map(|quantities| quantities.0)
            .filter_map(QuantityKey::metric)
            .collect(),
        reference_model: keys.reference_model.map(|l| l.0),
        ripple_above: keys.ripple_above_hz.map(|f| f.0),
        published: keys.published,
        sweep: keys.sweep,
        stability,
        precision: keys.precision.read(&at.key("precision"))?,
    })
}

/// The adaptive methods of the table that can run every model.
fn default_integrators() -> Vec<Scheme> {
    METHODS
        .iter()
        .filter(|m| m.info.stepping != Stepping::Fixed && !m.info.linear_part)
        .map(|m| MethodSpec::of(m).at_tolerance(DEFAULT_RTOL))
        .collect()
}

/// Integrators of a model in a scene whose study names none: gears with modes take the method that is exact for these,
/// full finite elements those that solve with their sparse matrices, all others those of the study.
///
/// Whether modes are coupled, and how high they are, is known when the gears are built ([`default_in`]); until then modes
/// are taken as uncoupled.
pub(super) fn default_of(properties: Properties, gears: &[&GearSpec]) -> Option<Vec<Scheme>> {
    if properties.full_order {
        let step = gears
            .iter()
            .map(|g| crossing(g))
            .fold(f64::INFINITY, f64::min);
        let step = format!("{:.0e}", CROSSING * step).parse().unwrap_or(step);
        return Some(vec![HHT_ALPHA.at_step(step), NEWMARK.at_step(step)]);
    }
    (properties.modes).then(|| vec![TRIGONOMETRIC.at_step(EXACT_STEP)])
}

/// Default integrators of a model that is built. Gears with modes take the method that is exact for these, at the
/// longest step up to [`EXACT_STEP`] at which no mode resonates with it, in one significant digit; where a carrier, a
/// bearing or terms of rotation couple the modes, an adaptive method.
pub(super) fn default_in(properties: Properties, scene: &mut Scene) -> Option<Vec<Scheme>> {
    if !properties.modes {
        return None;
    }
    let n = scene.layout().n;
    let Some(modal) = scene.modal() else {
        return Some(vec![DOPRI5.at_tolerance(DEFAULT_RTOL)]);
    };
    let (mut omega, mut zeta) = (vec![0.0; n], vec![0.0; n]);
    modal.oscillators(&mut omega, &mut zeta);
    let step = safe_step(&omega).min(EXACT_STEP);
    let digit = 10f64.powf(step.log10().floor());
    let rounded = (step / digit * (1.0 + 1e-9)).floor() * digit;
    let written = format!("{rounded:.0e}").parse().unwrap_or(rounded);
    Some(vec![TRIGONOMETRIC.at_step(written)])
}

/// Travel time of a compression wave across a module [s].
fn crossing(gear: &GearSpec) -> f64 {
    gear.body.module() * (gear.material.density / gear.material.young).sqrt()
}

/// Reads integrators with their steps or tolerances.
pub(crate) fn schemes(list: &[IntegratorTable], at: &Place<'_>) -> Result<Vec<Scheme>, SceneError> {
    let schemes = list.iter().enumerate();
    schemes
        .map(|(i, keys)| scheme(keys, &at.member(i)))
        .collect()
}

fn scheme(keys: &IntegratorTable, at: &Place<'_>) -> Result<Scheme, SceneError> {
    let method = keys.method.0;
    let id = method.id();
    let resolution = match (keys.step_s, keys.rtol, method.info().stepping) {
        (Some(_), Some(_), _) => {
            return Err(at.key("rtol").against(
                (&at.key("step_s"), "this"),
                "step and tolerance are both given",
                "and this",
                "give one: a fixed step or a tolerance",
            ));
        }
        (Some(_), None, Stepping::Adaptive) => {
            return at.key("step_s").refuse(
                format!("{id} controls its step size"),
                "no fixed step",
                "give `rtol`, for example 1e-6",
            );
        }
        (None, Some(_), Stepping::Fixed) => {
            return at.key("rtol").refuse(
                format!("{id} has fixed steps"),
                "no tolerance",
                "give `step_s`, for example 1e-6",
            );
        }
        (Some(step), None, _) => Resolution::Step(step.0),
        (None, Some(rtol), _) => Resolution::Tolerance(rtol.0),
        (None, None, stepping) => {
            let fixed = stepping == Stepping::Fixed;
            let key = if fixed { "step_s" } else { "rtol" };
            return Err(at.missing(key, &IntegratorTable::TABLE));
        }
    };
    Ok(Scheme { method, resolution })
}

/// The default metric of a tolerance; against the model's own converged solution it measures the integration error
/// alone.
fn metric_against(id: &str) -> Metric {
    match Metric::default() {
        metric if id == SELF => metric.of_integration(),
        metric => metric,
    }
}

/// Checks `tolerance` against the available references: those of the scene, and the reference model of the study.
pub(super) fn tolerance(
    choice: ToleranceChoice,
    models: &[ModelChoice],
    references: &[NamedReference],
    reference_model: Option<&str>,
    at: &Place<'_>,
) -> Result<Tolerance, SceneError> {
    // Models are compared with references under the scene's own conditions.
    let own = || references.iter().filter(|r| r.is_of_the_scene());
    let external = own().next().map(|r| r.name.as_str());
    let (metric, limit, against, except) = match choice {
        ToleranceChoice::Limit(limit) => (None, limit, None, None),
        ToleranceChoice::Full(keys) => (keys.metric, keys.limit, keys.against, keys.except),
    };
    let against = match (against.as_deref(), external, reference_model) {
        (None | Some("reference"), Some(name), _) => name,
        (Some(SELF), ..) => SELF,
        (None | Some("model"), _, Some(label)) => label,
        (None | Some(REFINED), ..) => REFINED,
        (Some("reference"), None, _) => {
            return at.key("against").refuse(
                "the scene has no reference",
                "no reference",
                "write \"self\", or give the scene a `reference`",
            );
        }
        (Some(name), ..) if own().any(|r| r.name == name) => name,
        (Some("model"), _, None) => {
            return at.key("against").refuse(
                "the tolerance refers to a model, but the study has no `reference_model`",
                "against nothing",
                "add `reference_model = \"LABEL\"` to [study]",
            );
        }
        (Some(name), ..) => {
            let words = ["reference", "model", REFINED, SELF].map(str::to_owned);
            let names = own().map(|r| r.name.clone());
            let known: Vec<String> = words.into_iter().chain(names).collect();
            let place = at.key("against");
            if let Some(other) = references.iter().find(|r| r.name == name) {
                return place.refuse(
                    format!(
                        "the reference \"{}\" belongs to other conditions than the scene",
                        other.name
                    ),
                    "no runs at these conditions",
                    "it is used by identification only; name a reference with the speeds and loads of the scene",
                );
            }
            return place.refuse(
                format!("`against` is \"{name}\", which is not known"),
                "not known",
                there_are(name, &known),
            );
        }
    };
    let measured = own().any(|r| r.name == against);
    if let Some(metric) = metric
        .as_ref()
        .map(|m| m.0)
        .filter(|m| m.is_of_measurements() && !measured)
    {
        return at.key("metric").refuse(
            format!("the tolerance limits {metric} against \"{against}\", a run of gearbench"),
            "defined for references only",
            "set `against` to a reference with angles or torques, or use a metric of the force",
        );
    }
    Ok(Tolerance {
        metric: metric.map_or_else(|| metric_against(against), |m| m.0),
        limit: limit.0,
        against: against.to_owned(),
        except: (models.iter())
            .filter(|m| except.iter().any(|l| l.0.iter().any(|l| l.0 == m.label)))
            .map(ModelChoice::model_label)
            .collect(),
    })
}
