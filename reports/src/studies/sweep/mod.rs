//! The study of loaded running at speed after speed: transmission error, bearing forces, spectra.

mod charts;
mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::studies::StudyReport;
use crate::view::View;
use maud::html;
pub use record::{Bearing, StaticCycle, Steady, SweepRecord};

/// What the study says of a record.
///
/// # Errors
/// [`DrawError`] when the drawing backend refuses.
pub(super) fn report(view: &View<'_>, statics: &[StaticCycle]) -> Result<StudyReport, DrawError> {
    let all = charts::swept(view, statics);
    Ok(StudyReport {
        finding: vec![tables::finding(view, &all)],
        tables: tables::tables(&all),
        charts: charts::sweep(&all, statics)?,
        details: html! { (tables::speeds(&all)) (runs::failures(view)) },
        csv: csv::tables(view.results, statics),
    })
}
