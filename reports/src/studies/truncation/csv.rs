//! CSV table of runs by number of modes.

use crate::csv_table::{CsvTable, number, text};
use crate::record::{Metrics, Results, Run};

type Row<'a> = (&'a Run, &'a Metrics);

/// Returns the table with a row per run and reference.
pub fn tables(results: &Results) -> Vec<CsvTable> {
    let rows = (results.runs.iter()).flat_map(|r| r.metrics.iter().map(move |m| (r, m)));
    vec![CsvTable::new::<Row<'_>>(
        "truncation.csv",
        rows,
        &[
            ("model", &|(r, _)| r.model.clone()),
            ("variant", &|(r, _)| text(&r.variant)),
            ("modes", &|(r, _)| text(&r.modes)),
            ("highest_hz", &|(r, _)| number(r.highest_hz)),
            ("residual", &|(r, _)| text(&r.residual)),
            ("choose", &|(r, _)| text(&r.choose)),
            ("integrator", &|(r, _)| r.integrator.clone()),
            ("step_s", &|(r, _)| number(r.step)),
            ("status", &|(r, _)| r.status.to_string()),
            ("against", &|(_, m)| m.against.clone()),
            ("force_l2", &|(_, m)| number(m.force_l2)),
            ("peak_force_rel", &|(_, m)| number(m.peak_force_rel)),
            ("impulse_rel", &|(_, m)| number(m.impulse_rel)),
            ("wall_s", &|(r, _)| number(r.wall_s)),
            ("steps", &|(r, _)| r.steps.to_string()),
            ("setup_s", &|(r, _)| number(r.setup_s)),
        ],
    )]
}
