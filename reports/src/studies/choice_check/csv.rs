//! CSV table of validated choices, a row per scene.

use super::ValidatedChoice;
use crate::csv_table::{CsvTable, number, text};

/// Returns the table with a row per scene.
pub fn tables(choices: &[ValidatedChoice]) -> Vec<CsvTable> {
    vec![CsvTable::new(
        "choice_check.csv",
        choices,
        &[
            ("scene", &|s| s.scene.clone()),
            ("kind", &|s| s.kind.clone()),
            ("gears", &|s| s.gears.clone()),
            ("duration_s", &|s| number(s.duration_s)),
            ("metric", &|s| s.metric.to_string()),
            ("tolerance", &|s| s.tolerance.to_string()),
            ("reference", &|s| s.reference.clone()),
            ("reference_error", &|s| number(s.reference_error)),
            ("mesh_error", &|s| number(s.mesh_error)),
            ("given_error", &|s| number(s.given_error)),
            ("full_error", &|s| number(s.full_error)),
            ("densest_error", &|s| number(s.densest_error)),
            ("rejected", &|s| s.rejected.to_string()),
            ("candidates", &|s| s.candidates.to_string()),
            ("failed", &|s| s.failed.to_string()),
            ("cut_short", &|s| s.cut_short.to_string()),
            ("outcome", &|s| s.outcome.to_string()),
            ("chosen", &|s| text(&s.chosen)),
            ("predicted_error", &|s| number(s.predicted_error)),
            ("error", &|s| number(s.error)),
            ("predicted_cost_s", &|s| number(s.predicted_cost_s)),
            ("cost_s", &|s| number(s.cost_s)),
            ("cheapest", &|s| text(&s.cheapest)),
            ("cheapest_error", &|s| number(s.cheapest_error)),
            ("cheapest_cost_s", &|s| number(s.cheapest_cost_s)),
            ("cost_ratio", &|s| number(s.cost_ratio())),
            ("least_error", &|s| number(s.least_error)),
            ("choosing_s", &|s| number(s.choosing_s)),
            ("refining_s", &|s| number(s.refining_s)),
            ("note", &|s| text(&s.note)),
        ],
    )]
}
