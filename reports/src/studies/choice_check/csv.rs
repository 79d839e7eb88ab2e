//! CSV table of validated choices, a row per scene.

use super::ValidatedChoice;
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;

/// Returns the table with a row per scene.
pub fn tables(choices: &[ValidatedChoice]) -> Vec<CsvTable> {
    vec![columns().table(choices)]
}

/// Returns the columns of scenes.
#[rustfmt::skip]
pub fn columns<'a>() -> Columns<'a, &'a ValidatedChoice> {
    Columns::<&ValidatedChoice>::of("choice_check.csv", "Check of choices: one row per scene.")
        .add("scene", "name of the scene", |s| s.scene.clone()).shown("Scene", Format::Text)
        .add("kind", "kind of the scene", |s| s.kind.clone()).shown("Kind", Format::Text)
        .add("gears", "its gears", |s| s.gears.clone())
        .add("duration_s", "simulated time", |s| s.duration_s)
        .add("metric", "requested metric", |s| s.metric)
        .add("tolerance", "requested tolerance", |s| s.tolerance.to_string())
        .add("reference", "reference of the choice", |s| s.reference.clone()).shown("Against", Format::Text)
        .add("reference_error", "error of that reference", |s| s.reference_error).shown("Error of the yardstick", Format::Percents(2))
        .add("mesh_error", "error of the mesh of the scene against the reference, with the same contact", |s| s.mesh_error).shown("Mesh of the scene", Format::Percents(2))
        .add("given_error", "error of mesh and contact of the scene against the reference", |s| s.given_error).shown("Mesh and contact of the scene", Format::Percents(2))
        .add("full_error", "error of the choice against full finite elements on a finer mesh", |s| s.full_error).shown("Error against finite elements", Format::Percents(2))
        .add("densest_error", "error of the elastic model with most modes against these", |s| s.densest_error)
        .add("rejected", "refused candidates", |s| s.rejected)
        .add("candidates", "number of candidates", |s| s.candidates)
        .add("failed", "failed candidates", |s| s.failed)
        .add("cut_short", "candidates that exceeded the time limit", |s| s.cut_short)
        .add("outcome", "result of the choice", |s| s.outcome).shown("Outcome", Format::Text).result()
        .add("chosen", "the choice", |s| s.chosen.clone())
        .add("predicted_error", "predicted error", |s| s.predicted_error).shown("Predicted error", Format::Percents(2))
        .add("error", "error of the choice", |s| s.error).shown("Error", Format::Percents(2)).result()
        .add("predicted_cost_s", "predicted processor time of one run of the whole scene", |s| s.predicted_cost_s)
        .add("cost_s", "time of the chosen run", |s| s.cost_s)
        .add("cheapest", "cheapest adequate candidate", |s| s.cheapest.clone())
        .add("cheapest_error", "its error", |s| s.cheapest_error)
        .add("cheapest_cost_s", "its time", |s| s.cheapest_cost_s)
        .add("cost_ratio", "time of the chosen run over that", |s| s.cost_ratio())
        .add("least_error", "least error of all candidates", |s| s.least_error)
        .add("choosing_s", "processor time of choosing", |s| s.choosing_s)
        .add("refining_s", "set-up time of the finer mesh", |s| s.refining_s)
        .add("note", "note", |s| s.note.clone())
}
