//! CSV table of runs by number of modes.

use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::metrics::Metric;
use crate::record::{Metrics, Results, Run};

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
        .modes(|(r, _)| r.modes)
        .add("highest_hz", "highest frequency among the modes", |(r, _)| r.highest_hz)
        .add("residual", "whether the truncated modes are represented by residual compliance", |(r, _)| r.residual)
        .add("choose", "choice of the modes", |(r, _)| r.choose.clone())
        .integrator(|(r, _)| r.integrator.clone())
        .step(|(r, _)| r.step)
        .status(|(r, _)| r.status)
        .against(|(_, m)| m.against.clone());
    (errors.into_iter())
        .fold(columns, |all, e| all.add(e.key(), e.meaning(), move |(_, m)| m.get(e)))
        .add("wall_s", "wall time, median of the repeats", |(r, _)| r.wall_s)
        .add("steps", "accepted steps", |(r, _)| r.steps)
        .add("setup_s", "wall time before the first step", |(r, _)| r.setup_s)
}
