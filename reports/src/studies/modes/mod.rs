//! The study of natural frequencies: frequencies and damping, distribution of the energies, and mode shapes.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::studies::{StudyReport, moving_modes};
pub use record::{
    LinearisedState, MemberPlace, MemberShape, MeshState, ModeRecord, ModelModes, ModesRecord,
};

/// Returns the report of natural frequencies.
pub(super) fn report(vibrations: &[ModelModes]) -> Result<StudyReport, DrawError> {
    let (still, viewer) = moving_modes::of_modes(vibrations)?.unzip();
    Ok(StudyReport {
        finding: tables::finding(vibrations),
        first: still.into_iter().collect(),
        viewer,
        tables: tables::tables(vibrations),
        charts: charts::charts(vibrations)?,
        csv: csv::tables(vibrations),
        ..StudyReport::default()
    })
}
