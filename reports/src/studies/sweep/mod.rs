//! The study of loaded running at speed after speed: transmission error, bearing forces, spectra.

mod charts;
mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::record::Run;
use crate::studies::StudyReport;
use crate::view::View;
use maud::html;
pub use record::{Bearing, StaticCycle, Steady, SweepRecord};

/// A model with its runs by mesh frequency.
pub struct Swept<'a> {
    /// Its name.
    pub label: String,
    /// Place in the order of appearance.
    pub style: usize,
    /// Runs that settled, ascending in mesh frequency.
    pub runs: Vec<(&'a Steady, &'a Run)>,
    /// Mesh frequencies at which it failed \[Hz\].
    pub failed: Vec<f64>,
    /// Its static limit.
    pub statics: Option<&'a StaticCycle>,
}

impl Swept<'_> {
    /// The speed with the largest transmission error.
    pub fn peak(&self) -> Option<&Steady> {
        let rms = |s: &Steady| s.error_rms_m;
        (self.runs.iter())
            .max_by(|a, b| rms(a.0).total_cmp(&rms(b.0)))
            .map(|(s, _)| *s)
    }
}

/// The models of a sweep.
pub fn swept<'a>(view: &View<'a>, statics: &'a [StaticCycle]) -> Vec<Swept<'a>> {
    (view.groups.iter())
        .map(|g| {
            let steady = |ok: bool| {
                g.runs
                    .iter()
                    .filter(move |(_, r)| r.status.is_failure() != ok)
                    .filter_map(|(_, r)| Some((r.steady.as_ref()?, *r)))
            };
            let mut runs: Vec<(&Steady, &Run)> = steady(true).collect();
            runs.sort_by(|a, b| a.0.mesh_frequency_hz.total_cmp(&b.0.mesh_frequency_hz));
            Swept {
                label: g.label.clone(),
                style: g.style,
                runs,
                failed: steady(false).map(|(s, _)| s.mesh_frequency_hz).collect(),
                statics: statics.iter().find(|s| s.label == g.label),
            }
        })
        .filter(|s| !s.runs.is_empty() || !s.failed.is_empty())
        .collect()
}

/// Resonance of the mesh: that of the last model that has one, the most detailed of a scene.
pub fn resonance(all: &[Swept<'_>]) -> Option<f64> {
    all.iter().rev().find_map(|s| s.statics?.resonance_hz)
}

/// What the study says of a record.
pub(super) fn report(view: &View<'_>, statics: &[StaticCycle]) -> Result<StudyReport, DrawError> {
    let all = swept(view, statics);
    Ok(StudyReport {
        finding: tables::finding(view, &all),
        tables: tables::tables(&all),
        charts: charts::sweep(&all, statics)?,
        details: html! { (tables::speeds(&all)) (runs::failures(view)) },
        csv: csv::tables(view.results, statics),
    })
}
