//! CSV table of runs by penalty.

use crate::csv_table::{CsvTable, number};
use crate::record::Results;

/// Returns the table with a row per run.
pub fn tables(results: &Results) -> Vec<CsvTable> {
    vec![CsvTable::new(
        "penalty.csv",
        &results.runs,
        &[
            ("model", &|r| r.model_label()),
            ("penalty_pa_per_m", &|r| number(r.penalty_pa_per_m)),
            ("hard", &|r| r.hard.unwrap_or(false).to_string()),
            ("status", &|r| r.status.to_string()),
            ("peak_force_n", &|r| {
                number(r.metrics.first().and_then(|m| m.peak_force_n))
            }),
            ("impulse_ns", &|r| {
                number(r.metrics.first().and_then(|m| m.impulse_ns))
            }),
            ("static_transmission_error_m", &|r| number(r.static_error_m)),
            ("force_l2_to_hard", &|r| {
                number(r.against("hard").and_then(|m| m.force_l2))
            }),
            ("peak_force_rel_to_hard", &|r| {
                number(r.against("hard").and_then(|m| m.peak_force_rel))
            }),
            ("impulse_rel_to_hard", &|r| {
                number(r.against("hard").and_then(|m| m.impulse_rel))
            }),
            ("integrator", &|r| r.integrator.clone()),
            ("step_s", &|r| number(r.step)),
            ("wall_s", &|r| number(r.wall_s)),
        ],
    )]
}
