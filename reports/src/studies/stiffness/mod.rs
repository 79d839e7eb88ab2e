//! The study of static stiffness: mesh stiffness, load sharing and transmission error over a mesh cycle under a load.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::studies::StudyReport;
pub use record::{
    LinePressure, ModelStiffness, PER_MM_UM, PairLoad, StiffnessPosition, StiffnessRecord,
};

/// Returns the report of static stiffness.
pub(super) fn report(stiffness: &[ModelStiffness]) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(stiffness),
        tables: tables::tables(stiffness),
        charts: charts::charts(stiffness)?,
        csv: csv::tables(stiffness),
        ..StudyReport::default()
    })
}
