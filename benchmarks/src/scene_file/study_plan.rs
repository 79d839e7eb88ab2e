//! `[study]` and `tolerance`: what is compared, and what counts as accurate enough.

use super::error::SceneError;
use super::precision_plan::{Precision, precision};
use super::reader::{Entry, Key, key};
use super::stability::{self, StabilitySet};
use gearbench_integrators::spec::ids;
use gearbench_integrators::{METHODS, MethodError, MethodSpec, Resolution, Scheme, Stepping};
use gearbench_reports::Metric;
use gearbench_reports::record::Tolerance;

pub(super) static STUDY: &[Key] = &[
    key(
        "models",
        "labels to compare, default all models of the scene",
    ),
    key(
        "integrators",
        "list such as [{ method = \"dopri5\", rtol = 1e-6 }, { method = \"rk4\", step_s = 1e-6 }]",
    ),
    key("events", "locate contact events, default true"),
    key(
        "samples",
        "samples of the histories over the duration, default 2000",
    ),
    key(
        "quantities",
        "metrics of interest, default all, for example [\"force_l2_aligned\", \"peak_force_n\"]",
    ),
    key(
        "reference_model",
        "label of a model whose run the others are held against, beside the scene's reference",
    ),
    key(
        "published",
        "where the times `published_s` of the models were published",
    ),
    key(
        "sweep",
        "speeds of `gearbench sweep`: { from_hz, to_hz, points, cycles, settle_s }",
    ),
    key(
        "stability",
        "maps of `gearbench stability`, one set or a list: { models, integrators, duration_s, step_s, axes }",
    ),
    key(
        "precision",
        "defaults of `gearbench precision`: { models, integrators, modes, factors, steps_s, rtols, metrics, duration_s }",
    ),
];
pub(super) static SWEEP: &[Key] = &[
    key("from_hz", "lowest mesh frequency in hertz"),
    key("to_hz", "highest mesh frequency in hertz"),
    key("points", "number of speeds, default 40"),
    key("cycles", "whole mesh cycles that are measured, default 8"),
    key(
        "settle_s",
        "time in seconds that a run is given to settle, default 0.005; at least four mesh cycles",
    ),
];
pub(super) static INTEGRATOR: &[Key] = &[
    key(
        "method",
        "id or id(name=value), for example \"generalised-alpha(rho_inf=0.8)\"",
    ),
    key("step_s", "fixed step in seconds, for example 1e-6"),
    key("rtol", "relative tolerance, for example 1e-6"),
];
pub(super) static TOLERANCE: &[Key] = &[
    key(
        "metric",
        "metric that is limited, default \"force_l2_aligned\"",
    ),
    key(
        "limit",
        "greatest magnitude that is accurate enough, for example 0.05",
    ),
    key(
        "against",
        "\"reference\", \"model\" (the study's `reference_model`) or \"self\", the model's own converged solution",
    ),
];

/// Tolerance against the model that `reference_model` names.
pub(super) const AGAINST_MODEL: &str = "model";

/// Samples of the histories when a scene does not say.
const DEFAULT_SAMPLES: usize = 2000;
/// Tolerance of the adaptive methods that are compared when a scene names none.
const DEFAULT_RTOL: f64 = 1e-6;

/// What a study of a scene does when the command line does not say otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Labels of the models, in the order of the scene.
    pub models: Vec<String>,
    /// Integrators.
    pub integrators: Vec<Scheme>,
    /// Locate contact events.
    pub events: bool,
    /// Samples of the histories over the duration.
    pub samples: usize,
    /// Metrics of interest; empty means all.
    pub quantities: Vec<Metric>,
    /// Label of a model that is a reference for the others.
    pub reference_model: Option<String>,
    /// Source of published times.
    pub published: Option<String>,
    /// Speeds of a sweep.
    pub sweep: Sweep,
    /// Maps of where methods fail.
    pub stability: Vec<StabilitySet>,
    /// Accuracy against cost.
    pub precision: Precision,
}

/// Speeds at which a sweep runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Lowest and highest mesh frequency [Hz]; `None` takes them from the mesh resonance.
    pub range: Option<[f64; 2]>,
    /// Number of speeds.
    pub points: usize,
    /// Whole mesh cycles that are measured.
    pub cycles: usize,
    /// Time to settle [s].
    pub settle: f64,
}

impl Default for Sweep {
    fn default() -> Self {
        Sweep {
            range: None,
            points: 40,
            cycles: 8,
            settle: 5e-3,
        }
    }
}

/// Reads `[study]`; `labels` are those of the models.
pub(super) fn study(entry: Option<Entry<'_>>, labels: &[&str]) -> Result<Study, SceneError> {
    let mut study = Study {
        models: labels.iter().map(|l| (*l).to_owned()).collect(),
        integrators: default_integrators(),
        events: true,
        samples: DEFAULT_SAMPLES,
        quantities: Vec::new(),
        reference_model: None,
        published: None,
        sweep: Sweep::default(),
        stability: Vec::new(),
        precision: Precision::default(),
    };
    let Some(entry) = entry else { return Ok(study) };
    let s = entry.section("[study]", STUDY)?;
    if let Some(e) = s.get("models") {
        study.models = words(&e, labels)?;
    }
    if let Some(e) = s.get("integrators") {
        study.integrators = e.list()?.iter().map(integrator).collect::<Result<_, _>>()?;
    }
    if let Some(e) = s.get("events") {
        study.events = e.boolean()?;
    }
    if let Some(e) = s.get("samples") {
        study.samples = match e.whole()? {
            n @ 2..=1_000_000 => n as usize,
            n => {
                return Err(e.error(
                    format!("`samples` is {n}"),
                    "expected 2 to 1000000",
                    "2000 are enough for a chart",
                ));
            }
        };
    }
    if let Some(e) = s.get("quantities") {
        let keys = words(&e, &Metric::ALL.map(Metric::key))?;
        study.quantities = keys.iter().filter_map(|k| k.parse().ok()).collect();
    }
    if let Some(e) = s.get("reference_model") {
        let known: Vec<(&str, String)> = labels.iter().map(|l| (*l, (*l).to_owned())).collect();
        study.reference_model = Some(e.word(&known)?);
    }
    if let Some(e) = s.get("published") {
        study.published = Some(e.text()?.to_owned());
    }
    if let Some(e) = s.get("sweep") {
        study.sweep = sweep(&e)?;
    }
    if let Some(e) = s.get("stability") {
        study.stability = stability::sets(&e, labels)?;
    }
    if let Some(e) = s.get("precision") {
        study.precision = precision(&e, labels)?;
    }
    Ok(study)
}

/// Reads `sweep = { .. }`.
fn sweep(entry: &Entry<'_>) -> Result<Sweep, SceneError> {
    let s = entry.section("`sweep`", SWEEP)?;
    let mut sweep = Sweep::default();
    let positive = |e: &Entry<'_>| match e.number()? {
        x if x > 0.0 => Ok(x),
        x => Err(e.error(
            format!("`{}` is {x}", e.name),
            "expected more than 0",
            "a mesh frequency is teeth times turns per second",
        )),
    };
    if s.get("from_hz").is_some() || s.get("to_hz").is_some() {
        let (from, to) = (s.need("from_hz")?, s.need("to_hz")?);
        let range = [positive(&from)?, positive(&to)?];
        if range[1] <= range[0] {
            return Err(to.error(
                format!("the sweep ends at {} Hz, where it has not begun", range[1]),
                format!("expected more than {} Hz", range[0]),
                "give the lower mesh frequency as `from_hz`",
            ));
        }
        sweep.range = Some(range);
    }
    let count = |name: &str, least: u32, most: u32, default: usize| match s.get(name) {
        None => Ok(default),
        Some(e) => match e.whole()? {
            n if (least..=most).contains(&n) => Ok(n as usize),
            n => Err(e.error(
                format!("`{name}` is {n}"),
                format!("expected {least} to {most}"),
                "40 speeds and 8 mesh cycles are usual",
            )),
        },
    };
    sweep.points = count("points", 2, 10_000, sweep.points)?;
    sweep.cycles = count("cycles", 1, 1000, sweep.cycles)?;
    if let Some(e) = s.get("settle_s") {
        sweep.settle = positive(&e)?;
    }
    Ok(sweep)
}

/// A list of words, each known and none twice.
pub(super) fn words(entry: &Entry<'_>, known: &[&str]) -> Result<Vec<String>, SceneError> {
    let mut found: Vec<String> = Vec::new();
    for member in entry.list()? {
        let text = member.text()?;
        if !known.contains(&text) {
            return Err(member.unknown_word(text, known));
        }
        if found.iter().any(|f| f == text) {
            return Err(member.error(
                format!("`{text}` stands twice in `{}`", entry.name),
                "again",
                "remove one",
            ));
        }
        found.push(text.to_owned());
    }
    Ok(found)
}

/// The adaptive methods of the table that run every model.
fn default_integrators() -> Vec<Scheme> {
    METHODS
        .iter()
        .filter(|m| m.info.stepping != Stepping::Fixed && !m.info.linear_part)
        .map(|m| MethodSpec::of(m).at_tolerance(DEFAULT_RTOL))
        .collect()
}

/// Reads an integrator with its step or tolerance.
pub(super) fn integrator(entry: &Entry<'_>) -> Result<Scheme, SceneError> {
    let s = entry.section("an integrator", INTEGRATOR)?;
    let method = s.need("method")?;
    let spec: MethodSpec = method.text()?.parse().map_err(|e| match e {
        MethodError::Unknown(id) => method.unknown_word(&id, &ids()),
        e => method.error(
            e.to_string(),
            "this method",
            "parameters stand in brackets: id(name=value)",
        ),
    })?;
    let id = spec.id();
    let positive = |e: Entry<'_>, below: f64| match e.number()? {
        x if x > 0.0 && x < below => Ok(x),
        x => Err(e.error(
            format!("`{}` is {x}", e.name),
            if below.is_finite() {
                "expected more than 0 and less than 1"
            } else {
                "expected more than 0"
            },
            "for example step_s = 1e-6 or rtol = 1e-6",
        )),
    };
    let resolution = match (s.get("step_s"), s.get("rtol"), spec.info().stepping) {
        (Some(step), Some(rtol), _) => {
            return Err(s
                .source
                .error(
                    rtol.key_range(),
                    "step and tolerance are both given",
                    "and this",
                    "give one: a fixed step or a tolerance",
                )
                .and(step.key_range(), "this"));
        }
        (Some(step), None, Stepping::Adaptive) => {
            return Err(step.error(
                format!("{id} chooses its steps"),
                "it takes no step",
                "give `rtol`, for example 1e-6",
            ));
        }
        (None, Some(rtol), Stepping::Fixed) => {
            return Err(rtol.error(
                format!("{id} has fixed steps"),
                "it takes no tolerance",
                "give `step_s`, for example 1e-6",
            ));
        }
        (Some(step), None, _) => Resolution::Step(positive(step, f64::INFINITY)?),
        (None, Some(rtol), _) => Resolution::Tolerance(positive(rtol, 1.0)?),
        (None, None, Stepping::Fixed) => return Err(s.missing("step_s")),
        (None, None, _) => return Err(s.missing("rtol")),
    };
    Ok(Scheme {
        method: spec,
        resolution,
    })
}

/// Reads `tolerance`: a number, or a table with metric, limit and reference.
pub(super) fn tolerance(
    entry: &Entry<'_>,
    reference: Option<&str>,
) -> Result<Tolerance, SceneError> {
    // Records call a reference by its program.
    let external = reference.map(|id| id.split('/').next().unwrap_or(id).to_owned());
    let default_against = external.clone().unwrap_or_else(|| "self".to_owned());
    let limit = |e: &Entry<'_>| match e.number()? {
        x if x > 0.0 => Ok(x),
        x => Err(e.error(
            format!("the tolerance is {x}"),
            "expected more than 0",
            "0.05 allows an error of 5 %",
        )),
    };
    if !entry.is_table() {
        return Ok(Tolerance {
            metric: Metric::default(),
            limit: limit(entry)?,
            against: default_against,
        });
    }
    let s = entry.section("`tolerance`", TOLERANCE)?;
    let metric = match s.get("metric") {
        Some(e) => e.word(&Metric::ALL.map(|m| (m.key(), m)))?,
        None => Metric::default(),
    };
    let against = match s.get("against") {
        None => default_against,
        Some(e) if e.as_text() == Some(AGAINST_MODEL) => AGAINST_MODEL.to_owned(),
        Some(e) if e.word(&[("reference", true), ("self", false), (AGAINST_MODEL, false)])? => {
            external.ok_or_else(|| {
                e.error(
                    "the scene has no reference",
                    "nothing to refer to",
                    "write \"self\", or give the scene a `reference`",
                )
            })?
        }
        Some(_) => "self".to_owned(),
    };
    Ok(Tolerance {
        metric,
        limit: limit(&s.need("limit")?)?,
        against,
    })
}
