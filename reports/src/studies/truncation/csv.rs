//! CSV table of runs by number of modes.

use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::metrics::Metric;
use crate::record::{Metrics, Results, Run};
use crate::studies::runs::{identity, work};

type Row<'a> = (&'a Run, &'a Metrics);

/// Returns the table with a row per run and reference.
pub fn tables(results: &Results) -> Vec<CsvTable> {
    let rows = (results.runs.iter()).flat_map(|r| r.metrics.iter().map(move |m| (r, m)));
    vec![columns().table(rows)]
}

#[rustfmt::skip]
pub fn columns<'a>() -> Columns<'a, Row<'a>> {
    let errors = [Metric::ForceL2, Metric::PeakForceRel, Metric::ImpulseRel];
    let columns = Columns::<Row<'_>>::of("truncation.csv", "`truncation`: one row per run and reference.")
        .add("model", "model", |(r, _)| r.model.clone())
        .add("variant", "distinguishing settings", |(r, _)| r.variant.clone())
        .join(identity().only(&["modes", "highest_hz", "residual", "choose", "integrator", "step_s", "status"]), |(r, _)| Some(*r))
        .against(|(_, m)| m.against.clone());
    (errors.into_iter())
        .fold(columns, |all, e| all.add(e.key(), e.meaning(), move |(_, m)| m.get(e)))
        .join(work().only(&["wall_s", "steps", "setup_s"]), |(r, _)| Some(*r))
}
