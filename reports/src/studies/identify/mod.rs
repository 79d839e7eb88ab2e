//! The study of identification: estimates with their intervals, data compared with the fitted model, and undetermined
//! parameters.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::studies::StudyReport;
pub use record::{
    ConstantSet, DataKind, DataRecord, FitHistory, FitRecord, IdentifyRecord, Outcome,
    ParameterRecord, ProfileRecord,
};

/// Returns the report of an identification.
pub(super) fn report(part: &IdentifyRecord) -> Result<StudyReport, DrawError> {
    let fits = &part.fits;
    Ok(StudyReport {
        finding: tables::finding(fits),
        tables: tables::tables(fits),
        charts: charts::charts(fits)?,
        details: tables::details(fits),
        csv: csv::tables(part),
        ..StudyReport::default()
    })
}
