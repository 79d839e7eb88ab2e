//! `[study] precision = { .. }`: what `gearbench precision` does when the command line does not say otherwise.

use super::error::SceneError;
use super::reader::{Entry, Key, key};
use super::study_plan::{integrator, words};
use gearbench_integrators::Scheme;
use gearbench_reports::Metric;

pub(super) static PRECISION: &[Key] = &[
    key("models", "labels, default those of the study"),
    key(
        "integrators",
        "in place of the study's, and beside a model's own (full finite elements keep their own)",
    ),
    key(
        "modes",
        "numbers of modes per gear of elastic models, default [0, 10, 35, 70, 100, 150]",
    ),
    key(
        "factors",
        "steps over that of the scene, default [16, 8, 4, 2, 1, 0.5, 0.25, 0.125]",
    ),
    key(
        "steps_s",
        "steps in seconds, in place of `factors`, for example [1e-6, 5e-7]",
    ),
    key(
        "rtols",
        "tolerances of adaptive methods, default 1e-2 to 1e-8 by decades",
    ),
    key(
        "metrics",
        "names as after --metric, the first above all, default that of the scene's tolerance",
    ),
    key(
        "duration_s",
        "simulated time in seconds, default that of the scene",
    ),
];

/// What accuracy against cost does by default; empty lists leave it to the study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Precision {
    /// Labels of the models.
    pub models: Vec<String>,
    /// Integrators.
    pub integrators: Vec<Scheme>,
    /// Numbers of modes.
    pub modes: Vec<usize>,
    /// Steps over that of the scene.
    pub factors: Vec<f64>,
    /// Steps [s].
    pub steps: Vec<f64>,
    /// Tolerances.
    pub rtols: Vec<f64>,
    /// Metrics.
    pub metrics: Vec<Metric>,
    /// Simulated time [s].
    pub duration: Option<f64>,
}

/// Reads `precision = { .. }`.
pub(super) fn precision(entry: &Entry<'_>, labels: &[&str]) -> Result<Precision, SceneError> {
    let s = entry.section("`precision`", PRECISION)?;
    let numbers = |name: &str, below: f64, help: &str| -> Result<Vec<f64>, SceneError> {
        let Some(list) = s.get(name) else {
            return Ok(Vec::new());
        };
        let list = list.list()?;
        let one = |e: &Entry<'_>| match e.number()? {
            x if x > 0.0 && x < below => Ok(x),
            x => {
                let expected = if below.is_finite() {
                    format!("expected more than 0 and less than {below}")
                } else {
                    "expected more than 0".into()
                };
                Err(e.error(format!("`{name}` holds {x}"), expected, help))
            }
        };
        list.iter().map(one).collect()
    };
    let mut plan = Precision {
        factors: numbers(
            "factors",
            1e6,
            "steps are these times that of the scene, for example [4, 2, 1, 0.5]",
        )?,
        steps: numbers(
            "steps_s",
            f64::INFINITY,
            "seconds, for example [1e-6, 5e-7]",
        )?,
        rtols: numbers("rtols", 1.0, "for example [1e-3, 1e-5, 1e-7]")?,
        ..Precision::default()
    };
    if let (Some(factors), Some(steps)) = (s.get("factors"), s.get("steps_s")) {
        return Err(s
            .source
            .error(
                steps.key_range(),
                "steps are given twice",
                "and this",
                "give one: `factors` of the scene's step, or `steps_s` in seconds",
            )
            .and(factors.key_range(), "this"));
    }
    if let Some(e) = s.get("models") {
        plan.models = words(&e, labels)?;
    }
    if let Some(e) = s.get("integrators") {
        plan.integrators = e.list()?.iter().map(integrator).collect::<Result<_, _>>()?;
    }
    if let Some(e) = s.get("modes") {
        let one = |e: &Entry<'_>| match e.whole()? {
            n @ 0..=2000 => Ok(n as usize),
            n => Err(e.error(
                format!("`modes` holds {n}"),
                "expected 0 to 2000",
                "numbers of modes per gear, for example [0, 35, 100]",
            )),
        };
        plan.modes = e.list()?.iter().map(one).collect::<Result<_, _>>()?;
    }
    if let Some(e) = s.get("metrics") {
        let errors = Metric::ALL.into_iter().filter_map(Metric::option);
        let names = words(&e, &errors.collect::<Vec<_>>())?;
        plan.metrics = names.iter().filter_map(|n| n.parse().ok()).collect();
    }
    if let Some(e) = s.get("duration_s") {
        plan.duration = match e.number()? {
            x if x > 0.0 => Some(x),
            x => {
                return Err(e.error(
                    format!("`duration_s` is {x}"),
                    "expected more than 0",
                    "seconds of simulated time, for example 0.01",
                ));
            }
        };
    }
    Ok(plan)
}
