//! The study of loaded running over a sequence of speeds: transmission error, bearing forces, spectra.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::record::{Part, Run, Status};
use crate::studies::{StudyReport, findings, of_scene};
use crate::view::View;
pub(super) use csv::steady_columns;
use maud::html;
pub use record::{
    Bearing, Bistable, Branch, ShaftOrders, StaticCycle, Steady, SweepRecord, bistable,
};

/// Runs of a model by mesh frequency, on one branch.
pub struct SweptBranch<'a> {
    /// Label of the model, with its branch if it has several.
    pub label: String,
    /// Label of the model.
    pub model: String,
    /// Place of the model in the order of appearance.
    pub style: usize,
    /// Branch of the runs.
    pub branch: Branch,
    /// True if this is the first branch of its model.
    pub first: bool,
    /// Runs that settled, ascending in mesh frequency.
    pub runs: Vec<(&'a Steady, &'a Run)>,
    /// Runs that reached their end without settling, ascending in mesh frequency; their amplitude belongs to no steady
    /// state.
    pub unsettled: Vec<(&'a Steady, &'a Run)>,
    /// Mesh frequencies at which it failed \[Hz\].
    pub failed: Vec<f64>,
    /// Quasi-static mesh cycle of the model.
    pub statics: Option<&'a StaticCycle>,
}

impl SweptBranch<'_> {
    /// Returns the steady state with the largest root mean square of the transmission error.
    pub fn peak(&self) -> Option<&Steady> {
        let rms = |s: &Steady| s.error_rms_m;
        (self.runs.iter())
            .max_by(|a, b| rms(a.0).total_cmp(&rms(b.0)))
            .map(|(s, _)| *s)
    }
}

/// Returns the models of a sweep, one entry per branch.
pub fn swept<'a>(view: &View<'a>, statics: &'a [StaticCycle]) -> Vec<SweptBranch<'a>> {
    let mut all = Vec::new();
    for g in &view.groups {
        let steady = (g.runs.iter()).filter_map(|(_, r)| Some((r.steady.as_ref()?, *r)));
        let of_group: Vec<(&Steady, &Run)> = steady.collect();
        let mut branches: Vec<Branch> = of_group.iter().map(|(s, _)| s.branch).collect();
        branches.dedup();
        for (i, &branch) in branches.iter().enumerate() {
            let of = |wanted: fn(Status) -> bool| {
                let fits =
                    move |(s, r): &&(&'a Steady, &'a Run)| s.branch == branch && wanted(r.status);
                let mut runs: Vec<(&Steady, &Run)> =
                    of_group.iter().filter(fits).copied().collect();
                runs.sort_by(|a, b| a.0.mesh_frequency_hz.total_cmp(&b.0.mesh_frequency_hz));
                runs
            };
            all.push(SweptBranch {
                label: match branches.len() {
                    1 => g.label.clone(),
                    _ => format!("{}, {branch}", g.label),
                },
                model: g.label.clone(),
                style: g.style,
                branch,
                first: i == 0,
                runs: of(Status::holds),
                unsettled: of(|s| s == Status::Inaccurate),
                failed: of(Status::is_failure)
                    .iter()
                    .map(|(s, _)| s.mesh_frequency_hz)
                    .collect(),
                statics: statics.iter().find(|s| s.label == g.model),
            });
        }
    }
    all
}

/// Returns the resonance of the mesh by the last model that has one, the most detailed of a scene [Hz].
pub fn resonance(all: &[SweptBranch<'_>]) -> Option<f64> {
    all.iter().rev().find_map(|s| s.statics?.resonance_hz)
}

/// The static mesh cycle of a model of a scene.
pub struct ModelCycle<'a> {
    /// Label of the model, with several scenes after the name of its scene.
    pub label: String,
    /// Index of its scene.
    pub scene: usize,
    /// The cycle.
    pub cycle: &'a StaticCycle,
}

/// Returns the static cycles of a record.
fn statics_of<'a>(view: &View<'a>) -> &'a [StaticCycle] {
    match &view.results.part {
        Part::Sweep(part) => &part.statics,
        _ => &[],
    }
}

/// Returns the models of a scene with two steady states at one speed, under their labels on the page.
fn bistable_of(view: &View<'_>) -> Vec<Bistable> {
    let mut all = bistable(view.results);
    for two in &mut all {
        two.label = view.with_scene(&two.label);
    }
    all
}

/// Returns the report of a sweep of one or several scenes, whose curves share the charts.
pub(super) fn report(views: &[View<'_>]) -> Result<StudyReport, DrawError> {
    let all: Vec<SweptBranch<'_>> = (views.iter())
        .flat_map(|v| swept(v, statics_of(v)))
        .collect();
    let two: Vec<Bistable> = views.iter().flat_map(bistable_of).collect();
    let statics: Vec<ModelCycle<'_>> = (views.iter())
        .flat_map(|v| {
            statics_of(v).iter().map(|cycle| ModelCycle {
                label: v.with_scene(&cycle.label),
                scene: v.place,
                cycle,
            })
        })
        .collect();
    let (finding, answer) = findings(views, |view| {
        let all = swept(view, statics_of(view));
        (tables::finding(view, &all, &bistable_of(view)), 0)
    });
    Ok(StudyReport {
        finding,
        answer,
        tables: tables::tables(&all),
        charts: charts::sweep(&all, &statics, &two)?,
        details: html! {
            (tables::speeds(&all))
            @for view in views { (of_scene(view, &runs::failures(view))) }
        },
        ..StudyReport::default()
    })
}
