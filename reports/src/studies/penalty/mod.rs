//! The study of penalties: force, impulse and transmission error over the penalty of a contact.

mod charts;
pub(super) mod csv;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::studies::StudyReport;
use crate::studies::compare::histories;
use crate::view::View;

/// Returns the report of a study of penalties.
pub(super) fn report(view: &View<'_>) -> Result<StudyReport, DrawError> {
    let mut charts = charts::penalty(view)?;
    charts.extend(histories::force(view)?);
    Ok(StudyReport {
        finding: tables::finding(view),
        tables: tables::tables(view),
        charts,
        details: runs::all(view),
        csv: csv::tables(view.results),
        ..StudyReport::default()
    })
}
