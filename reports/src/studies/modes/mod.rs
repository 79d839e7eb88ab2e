//! The study of natural frequencies: frequencies and damping, distribution of the energies, and mode shapes.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::studies::StudyReport;
pub use record::{
    LinearisedState, MemberPlace, MemberShape, MeshState, ModeRecord, ModelModes, ModesRecord,
};

/// Returns the report of natural frequencies.
pub(super) fn report(vibrations: &[ModelModes]) -> Result<StudyReport, DrawError> {
    Ok(StudyReport {
        finding: tables::finding(vibrations),
        tables: tables::tables(vibrations),
        charts: charts::charts(vibrations)?,
        csv: csv::tables(vibrations),
        ..StudyReport::default()
    })
}
