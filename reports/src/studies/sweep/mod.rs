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
pub use record::{Bearing, StaticCycle, Steady};

/// What the study says of a record.
///
/// # Errors
/// [`DrawError`] when the drawing backend refuses.
pub(super) fn report(view: &View<'_>) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: vec![tables::finding(view)],
        tables: tables::tables(view),
        charts: charts::sweep(view)?,
        details: html! { (tables::speeds(view)) (runs::failures(view)) },
        csv: csv::tables(view.results),
    })
}
