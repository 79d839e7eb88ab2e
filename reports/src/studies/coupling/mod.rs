//! The study of coupling: gears as a sub-system whose hubs are moved by a host, over the communication step.

mod charts;
pub(super) mod csv;
mod record;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::studies::StudyReport;
use crate::view::View;
pub use record::{Coupling, CouplingCell, CouplingRecord, Extrapolation, Motion};

/// Returns the report of a study of coupling.
pub(super) fn report(view: &View<'_>, couplings: &[Coupling]) -> Result<StudyReport, DrawError> {
    let limit = view.results.tolerance.as_ref().map(|t| t.limit);
    Ok(StudyReport {
        finding: tables::finding(couplings),
        tables: tables::tables(couplings),
        charts: charts::charts(couplings, limit)?,
        details: crate::markup::runs::all(view),
        csv: csv::tables(couplings),
        ..StudyReport::default()
    })
}

/// Returns the methods of coupling of a record, each once, in order.
fn manners(couplings: &[Coupling]) -> Vec<String> {
    unique(couplings.iter().map(Coupling::manner))
}

/// Returns the labels of the models of a record, each once, in order.
fn models(couplings: &[Coupling]) -> Vec<String> {
    unique(couplings.iter().map(Coupling::model_label))
}

fn unique(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for one in all {
        if !found.contains(&one) {
            found.push(one);
        }
    }
    found
}
