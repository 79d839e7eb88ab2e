//! `[study] precision = { .. }` of a scene: defaults of the study, which options on the command line override.

use crate::scene_file::SceneError;
use crate::scene_file::reading::Place;
use crate::scene_file::reading::keys::keys;
use crate::scene_file::reading::values::{
    Count, Distinct, Factor, Label, MetricOption, Positive, Share,
};
use crate::scene_file::study_plan::{IntegratorTable, schemes};
use gearbench_integrators::Scheme;
use gearbench_reports::Metric;

keys! {
    /// Defaults of the study of accuracy against cost.
    #[derive(Default)]
    struct PrecisionTable {
        /// labels, default those of the study
        models: Option<Distinct<Label>>,
        /// in place of the study's, in addition to a model's own (full finite elements keep their own)
        integrators: Option<Vec<IntegratorTable>>,
        /// numbers of modes per gear of elastic models, default [0, 10, 35, 70, 100, 150]
        modes: Option<Vec<Count<0, 2000>>>,
        /// steps over that of the scene, default [16, 8, 4, 2, 1, 0.5, 0.25, 0.125]
        factors: Option<Vec<Factor>>,
        /// steps in seconds, in place of `factors`, for example [1e-6, 5e-7]
        steps_s: Option<Vec<Positive>>,
        /// tolerances of adaptive methods, default 1e-2 to 1e-8 by decades
        rtols: Option<Vec<Share>>,
        /// names as after --metric, the first above all, default that of the scene's tolerance
        metrics: Option<Distinct<MetricOption>>,
        /// simulated time in seconds, default that of the scene
        duration_s: Option<Positive>,
    }
}

/// Defaults of accuracy against cost in a scene; empty lists leave the choice to the study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Precision {
    /// Labels of the models to run.
    pub models: Vec<String>,
    /// Integrators in place of the study's.
    pub integrators: Vec<Scheme>,
    /// Numbers of modes per gear.
    pub modes: Vec<usize>,
    /// Steps as multiples of the step of the scene.
    pub factors: Vec<f64>,
    /// Steps [s], in place of factors.
    pub steps: Vec<f64>,
    /// Relative tolerances of adaptive methods.
    pub rtols: Vec<f64>,
    /// Metrics of the error, the most important first.
    pub metrics: Vec<Metric>,
    /// Simulated time [s]; `None` takes that of the scene.
    pub duration: Option<f64>,
}

fn plain<T, U>(list: Option<Vec<T>>, plain: impl Fn(T) -> U) -> Vec<U> {
    list.into_iter().flatten().map(plain).collect()
}

impl PrecisionTable {
    /// Validates the keys and returns the defaults; factors and steps exclude each other.
    pub(crate) fn read(self, at: &Place<'_>) -> Result<Precision, SceneError> {
        if self.factors.is_some() && self.steps_s.is_some() {
            return Err(at.key("steps_s").against(
                (&at.key("factors"), "this"),
                "steps are given twice",
                "and this",
                "give one: `factors` of the scene's step, or `steps_s` in seconds",
            ));
        }
        let integrators = self.integrators.unwrap_or_default();
        Ok(Precision {
            models: self.models.map_or(Vec::new(), Distinct::labels),
            integrators: schemes(&integrators, &at.key("integrators"))?,
            modes: plain(self.modes, |n| n.0),
            factors: plain(self.factors, f64::from),
            steps: plain(self.steps_s, f64::from),
            rtols: plain(self.rtols, f64::from),
            metrics: plain(self.metrics.map(|m| m.0), |m| m.0),
            duration: self.duration_s.map(f64::from),
        })
    }
}
