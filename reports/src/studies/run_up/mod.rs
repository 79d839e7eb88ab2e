//! The study of run-ups: spectra and orders over the speed, and where orders peak.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::studies::StudyReport;
use crate::view::View;
pub use record::{
    ModelRunUp, NaturalFrequency, Peak, RunUpChannel, RunUpMap, RunUpRecord, TrackedOrder,
    strongest,
};

/// Returns the report of run-ups.
pub(super) fn report(view: &View<'_>, run_ups: &[ModelRunUp]) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(run_ups),
        tables: tables::tables(run_ups),
        charts: charts::charts(run_ups)?,
        details: runs::all(view),
        csv: csv::tables(run_ups),
        ..StudyReport::default()
    })
}
