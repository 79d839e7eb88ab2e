//! The study of loaded running over a sequence of speeds: transmission error, bearing forces, spectra.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::record::{Run, Status};
use crate::studies::StudyReport;
use crate::view::View;
pub(super) use csv::steady_columns;
use maud::html;
pub use record::{
    Bearing, Bistable, Branch, ShaftOrders, StaticCycle, Steady, SweepRecord, bistable,
};

/// Runs of a model by mesh frequency, on one branch.
pub struct SweptBranch<'a> {
    /// Label of the model.
    pub label: String,
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
                style: g.style,
                branch,
                first: i == 0,
                runs: of(Status::holds),
                unsettled: of(|s| s == Status::Inaccurate),
                failed: of(Status::is_failure)
                    .iter()
                    .map(|(s, _)| s.mesh_frequency_hz)
                    .collect(),
                statics: statics.iter().find(|s| s.label == g.label),
            });
        }
    }
    all
}

/// Returns the resonance of the mesh by the last model that has one, the most detailed of a scene [Hz].
pub fn resonance(all: &[SweptBranch<'_>]) -> Option<f64> {
    all.iter().rev().find_map(|s| s.statics?.resonance_hz)
}

/// Returns the report of a sweep.
pub(super) fn report(view: &View<'_>, statics: &[StaticCycle]) -> Result<StudyReport, DrawError> {
    let all = swept(view, statics);
    let two = bistable(view.results);
    Ok(StudyReport {
        finding: tables::finding(view, &all, &two),
        tables: tables::tables(&all),
        charts: charts::sweep(&all, statics, &two)?,
        details: html! { (tables::speeds(&all)) (runs::failures(view)) },
        csv: csv::tables(view.results, statics),
        ..StudyReport::default()
    })
}
