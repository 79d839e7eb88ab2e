//! The study of accuracy against cost: families of runs, their points, and the cheapest families within limits of the
//! error.
//!
//! A family is a model under an integrator, at every step, tolerance and number of modes. The report compares two
//! groups: elastic models with residual compliance under a method that solves their linear part exactly ([`is_reduced_exactly`]),
//! and all others.

mod charts;
pub(super) mod csv;
pub mod pareto;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::metrics::Metric;
use crate::numbers::{quantity, round_quantity, short};
use crate::record::{Results, Run, Status};
use crate::studies::precision::pareto::{Point, front, lead};
use crate::studies::{Part, StudyReport};
use crate::view::{NOTHING, View, metric_against, resolution};
use serde::{Deserialize, Serialize};

/// Limits of the error at which families are compared.
pub const LEVELS: [f64; 4] = [0.05, 0.02, 0.01, 0.005];
/// Factor by which the error of a point of a front must be below that of the last marked point to be marked itself.
const IMPROVEMENT: f64 = 0.95;

/// The part of a record that is specific to a study of accuracy against cost.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PrecisionRecord {
    /// Metrics that the study is about, the first one above all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub metrics: Vec<Metric>,
}

/// Measure of the cost of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Processor time \[s\].
    Processor,
    /// Evaluations of the force.
    Evaluations,
}

impl Cost {
    /// Returns the cost of a run, if it was measured.
    pub fn of(self, run: &Run) -> Option<f64> {
        let x = match self {
            Cost::Processor => run.cost_s(),
            Cost::Evaluations => run.force_evaluations as f64,
        };
        (x.is_finite() && x > 0.0).then_some(x)
    }
}

/// A run that reached its end, as a point.
#[derive(Clone, Copy, Debug)]
pub struct WorkPrecisionPoint<'a> {
    /// Run of the point.
    pub run: &'a Run,
    /// Place of its model in the order of appearance.
    pub style: usize,
    /// Cost and error of the run.
    pub point: Point,
}

impl WorkPrecisionPoint<'_> {
    /// True if the constants of the run were fitted to a reference of the record.
    pub fn is_fitted(&self) -> bool {
        self.run.fitted_to.is_some()
    }
}

/// The points of a record against one reference.
pub struct WorkPrecision<'a> {
    /// Id of the reference.
    pub against: String,
    /// Runs that reached their end and have an error, in the order of the record.
    pub shown: Vec<WorkPrecisionPoint<'a>>,
    /// Runs of the same models that failed, with the place of their model.
    pub failed: Vec<(&'a Run, usize)>,
}

/// A record seen as accuracy against cost.
pub struct Precision<'a> {
    /// Record of the study.
    pub results: &'a Results,
    /// Labels of the models in the order of appearance.
    pub models: Vec<String>,
    /// References that runs are compared with, in the order of the record.
    pub references: Vec<String>,
    /// Metrics of the study, the headline first.
    pub metrics: Vec<Metric>,
}

/// True if the run belongs to the models whose lead is reported: residual compliance, and a method that solves the
/// linear part exactly.
pub fn is_reduced_exactly(run: &Run) -> bool {
    run.residual == Some(true) && run.exact_linear
}

/// Returns the id of an integrator without its parameters.
pub fn id_of(integrator: &str) -> &str {
    integrator.split('(').next().unwrap_or(integrator).trim()
}

/// Returns the name of a run's family: model and integrator.
pub fn family(run: &Run) -> String {
    format!("{} under {}", run.model_label(), run.integrator)
}

/// Returns number of modes, and step or tolerance of a run, for labels.
pub fn modes_and_step(run: &Run) -> String {
    let resolution = match run.step {
        Some(h) => round_quantity(h, "s", 3),
        None => resolution(run),
    };
    match run.modes {
        Some(n) => format!("{n}\u{a0}modes, {resolution}"),
        None => resolution,
    }
}

impl<'a> Precision<'a> {
    /// Makes the view of accuracy against cost from a record.
    pub fn of(results: &'a Results) -> Self {
        let mut models: Vec<String> = Vec::new();
        for run in &results.runs {
            let label = run.model_label();
            if !models.contains(&label) {
                models.push(label);
            }
        }
        let references = (results.references.iter())
            .map(|r| r.id.clone())
            .filter(|id| results.runs.iter().any(|r| r.against(id).is_some()))
            .collect();
        let mut metrics = match &results.part {
            Part::Precision(part) => part.metrics.clone(),
            _ => Vec::new(),
        };
        if metrics.is_empty() {
            metrics.push(Metric::default());
        }
        Self {
            results,
            models,
            references,
            metrics,
        }
    }

    /// Returns the first metric of the study.
    pub fn headline(&self) -> Metric {
        self.metrics.first().copied().unwrap_or_default()
    }

    /// Returns the headline metric against a reference. Errors against a model's own converged solution have a metric
    /// of their own.
    pub fn headline_against(&self, id: &str) -> Metric {
        metric_against(self.results, id, self.headline())
    }

    fn style(&self, run: &Run) -> usize {
        let label = run.model_label();
        self.models.iter().position(|m| *m == label).unwrap_or(0)
    }

    /// Returns the points of all runs against a reference.
    pub fn cloud(&self, against: &str, metric: Metric, cost: Cost) -> WorkPrecision<'a> {
        let runs = &self.results.runs;
        let compared: Vec<String> = (runs.iter())
            .filter(|r| r.against(against).is_some())
            .map(Run::model_label)
            .collect();
        let shown = (runs.iter())
            .filter(|r| !r.status.is_failure())
            .filter_map(|run| {
                let error = run.against(against)?.get(metric)?.abs();
                let point = Point {
                    cost: cost.of(run)?,
                    error,
                };
                (point.is_sound() && error > NOTHING).then(|| WorkPrecisionPoint {
                    run,
                    style: self.style(run),
                    point,
                })
            })
            .collect();
        let failed = (runs.iter())
            .filter(|r| r.status.is_failure() && compared.contains(&r.model_label()))
            .map(|r| (r, self.style(r)))
            .collect();
        WorkPrecision {
            against: against.to_owned(),
            shown,
            failed,
        }
    }
}

impl<'a> WorkPrecision<'a> {
    fn points(&self, keep: impl Fn(&WorkPrecisionPoint<'a>) -> bool) -> (Vec<usize>, Vec<Point>) {
        let kept = (0..self.shown.len()).filter(|&i| keep(&self.shown[i]));
        kept.map(|i| (i, self.shown[i].point)).unzip()
    }

    /// Returns the indices of the Pareto front of selected points, ascending in cost.
    pub fn front(&self, keep: impl Fn(&WorkPrecisionPoint<'a>) -> bool) -> Vec<usize> {
        let (kept, points) = self.points(keep);
        front(&points).into_iter().map(|i| kept[i]).collect()
    }

    /// Returns the cheapest of selected runs within a limit of the error.
    pub fn cheapest(
        &self,
        limit: f64,
        keep: impl Fn(&WorkPrecisionPoint<'a>) -> bool,
    ) -> Option<&WorkPrecisionPoint<'a>> {
        let (kept, points) = self.points(keep);
        pareto::cheapest(&points, limit).map(|i| &self.shown[kept[i]])
    }

    /// True if any of the models was fitted to a reference of the record.
    pub fn has_fitted(&self) -> bool {
        self.shown.iter().any(WorkPrecisionPoint::is_fitted)
    }

    /// Returns the cheapest runs within a limit of the error, among all models or among those that were not fitted;
    /// `None` when no run with [`is_reduced_exactly`] is within it.
    pub fn cheapest_runs(&self, limit: f64, fitted_too: bool) -> Option<CheapestRuns<'_, 'a>> {
        let among = |rival: &dyn Fn(&WorkPrecisionPoint<'a>) -> bool| {
            let (kept, points) = self.points(|s| {
                (fitted_too || !s.is_fitted()) && (is_reduced_exactly(s.run) || rival(s))
            });
            let mine: Vec<bool> = kept
                .iter()
                .map(|&i| is_reduced_exactly(self.shown[i].run))
                .collect();
            let lead = lead(&points, &mine, limit)?;
            let next = lead.next.map(|n| &self.shown[kept[n]]);
            Some((&self.shown[kept[lead.ours]], next.zip(lead.factor)))
        };
        let (ours, next) = among(&|_| true)?;
        let (_, other) = among(&|s| s.run.residual != Some(true))?;
        Some(CheapestRuns {
            limit,
            ours,
            next,
            other,
        })
    }

    /// Returns the points of a front whose error is at least 5 % below that of the last such point.
    pub fn improvements(&self, front: &[usize]) -> Vec<usize> {
        let mut last = f64::INFINITY;
        let mut kept = front.to_vec();
        kept.retain(|&i| {
            let error = self.shown[i].point.error;
            let is_news = error < IMPROVEMENT * last;
            if is_news {
                last = error;
            }
            is_news
        });
        kept
    }

    /// Returns the front as sections of one family each, all runs with [`is_reduced_exactly`] being one family: first point and
    /// least error of each.
    pub fn stretches(
        &self,
        keep: impl Fn(&WorkPrecisionPoint<'a>) -> bool,
    ) -> Vec<(&WorkPrecisionPoint<'a>, f64)> {
        let mut all: Vec<(&WorkPrecisionPoint<'a>, f64)> = Vec::new();
        let alike = |a: &Run, b: &Run| {
            (is_reduced_exactly(a) && is_reduced_exactly(b)) || family(a) == family(b)
        };
        for i in self.improvements(&self.front(keep)) {
            let s = &self.shown[i];
            match all.last_mut() {
                Some((first, least)) if alike(first.run, s.run) => *least = s.point.error,
                _ => all.push((s, s.point.error)),
            }
        }
        all
    }

    /// Returns the reasons of failures in the order of the format, each with its runs.
    pub fn reasons(&self) -> Vec<(Status, Vec<(&'a Run, usize)>)> {
        let of = |status: Status| {
            let all = self.failed.iter().filter(|(r, _)| r.status == status);
            (status, all.copied().collect::<Vec<_>>())
        };
        let all = Status::ALL.into_iter().map(of);
        all.filter(|(_, runs)| !runs.is_empty()).collect()
    }
}

/// The cheapest runs within a limit of the error, by group of models.
#[derive(Clone, Copy, Debug)]
pub struct CheapestRuns<'c, 'a> {
    /// Limit of the error [-].
    pub limit: f64,
    /// Cheapest run with [`is_reduced_exactly`].
    pub ours: &'c WorkPrecisionPoint<'a>,
    /// Cheapest run of all other families with its cost over that of `ours`; `None` when none is within the limit.
    pub next: Option<(&'c WorkPrecisionPoint<'a>, f64)>,
    /// The cheapest run of models without residual compliance with its cost over that of `ours`; `None` when none keeps
    /// the limit.
    pub other: Option<(&'c WorkPrecisionPoint<'a>, f64)>,
}

impl CheapestRuns<'_, '_> {
    /// Returns the limit, in words.
    pub fn level(&self) -> String {
        format!("\u{2264} {} %", short(100.0 * self.limit, 2))
    }

    /// Returns the description of `ours`: model, integrator, modes and step, time.
    pub fn own(&self) -> String {
        let run = self.ours.run;
        format!(
            "{} ({}) {}",
            run.model_label(),
            modes_and_step(run),
            quantity(run.cost_s(), "s", 2).replace('\u{a0}', " ")
        )
    }

    /// Returns the clause on the cheapest run of all, and the cost of the cheapest one of the other group.
    pub fn winner(&self) -> String {
        let named = |s: &WorkPrecisionPoint<'_>| {
            let time = quantity(s.run.cost_s(), "s", 2).replace('\u{a0}', " ");
            let integrator = id_of(&s.run.integrator);
            let fitted = if s.is_fitted() { ", fitted" } else { "" };
            let at = modes_and_step(s.run);
            format!(
                "{} under {integrator} ({at}{fitted}) {time}",
                s.run.model_label()
            )
        };
        match self.next {
            Some((rival, factor)) if factor < 1.0 => format!(
                "{}; the cheapest with all compliance of its teeth, {}, takes {} times as long",
                named(rival),
                named(self.ours),
                short(1.0 / factor, 2)
            ),
            Some((rival, factor)) => format!(
                "{}; the next family, {}, takes {} times as long",
                named(self.ours),
                named(rival),
                short(factor, 2)
            ),
            None => format!("{}; no other family keeps the limit", named(self.ours)),
        }
    }

    /// Returns the clause that compares `ours` with the next family.
    pub fn next_clause(&self) -> String {
        cost_clause(self.next)
    }

    /// Returns the clause that compares `ours` with the next model without residual compliance.
    pub fn other_clause(&self) -> String {
        cost_clause(self.other)
    }
}

/// Returns the clause on the ratio of costs between `ours` and a rival.
fn cost_clause(rival: Option<(&WorkPrecisionPoint<'_>, f64)>) -> String {
    let Some((rival, factor)) = rival else {
        return "no other is within the limit".into();
    };
    let fitted = if rival.is_fitted() { ", fitted" } else { "" };
    let (model, integrator) = (rival.run.model_label(), id_of(&rival.run.integrator));
    let name = format!("{model} under {integrator}{fitted}");
    if factor >= 1.0 {
        format!("\u{d7} {} faster than {name}", short(factor, 2))
    } else {
        format!("\u{d7} {} slower than {name}", short(1.0 / factor, 2))
    }
}

/// Returns the report of a study of accuracy against cost.
pub(super) fn report(view: &View<'_>) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(view),
        tables: tables::tables(view),
        charts: charts::precision(view)?,
        details: tables::runs(view),
        csv: csv::tables(view.results),
        ..StudyReport::default()
    })
}
