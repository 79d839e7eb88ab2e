//! The study of the frequency response to tooth meshing: transmission errors, mesh forces and forces of mounts.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::studies::StudyReport;
pub use record::{
    GroupResponse, MeshLimit, MeshPoint, ModelResponse, MountPoint, ResponsePoint, ResponseRecord,
};

/// Returns the report of a frequency response.
pub(super) fn report(responses: &[ModelResponse]) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(responses),
        tables: tables::tables(responses),
        charts: charts::charts(responses)?,
        csv: csv::tables(responses),
        ..StudyReport::default()
    })
}
