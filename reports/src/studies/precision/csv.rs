//! CSV table of cost and error of all runs against all references.

use super::{Cost, Precision, WorkPrecision, WorkPrecisionPoint};
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::metrics::Metric;
use crate::record::{Metrics, Results, Run, SELF};
use crate::studies::runs::{identity, work};

/// A run with its metrics against a reference, and whether it is on the front.
type Row<'a> = (&'a Run, &'a Metrics, bool);

/// Returns the table with a row per run and reference.
pub fn tables(results: &Results) -> Vec<CsvTable> {
    let study = Precision::of(results);
    let clouds: Vec<WorkPrecision<'_>> = (study.references.iter().map(String::as_str))
        .chain([SELF])
        .map(|id| study.cloud(id, study.headline_against(id), Cost::Processor))
        .collect();
    // The front of each reference, of the model's own converged solution that of each model.
    let on_front = |r: &Run, m: &Metrics| {
        let own = |s: &WorkPrecisionPoint<'_>| {
            m.against != SELF || s.run.model_label() == r.model_label()
        };
        let Some(cloud) = clouds.iter().find(|c| c.against == m.against) else {
            return false;
        };
        let front = cloud.front(own);
        let mut runs = front.iter().map(|i| cloud.shown[*i].run);
        runs.any(|run| std::ptr::eq(run, r))
    };
    let none = Metrics::default();
    let rows = results.runs.iter().flat_map(|r| {
        let alone = r.metrics.is_empty().then_some(&none);
        r.metrics.iter().chain(alone).map(move |m| (r, m))
    });
    let rows = rows.map(|(r, m)| (r, m, on_front(r, m)));
    vec![columns().table(rows)]
}

#[rustfmt::skip]
pub fn columns<'a>() -> Columns<'a, Row<'a>> {
    let columns = Columns::<Row<'_>>::of("precision.csv", "`precision`: one row per run and reference.")
        .join(identity().only(&["model", "modes", "integrator", "step_s", "rtol", "status", "fitted_to"]), |(r, ..)| Some(*r))
        .against(|(_, m, _)| m.against.clone())
        .add("on_front", "no run of the record is both cheaper and more accurate", |(.., on_front)| *on_front);
    let errors = Metric::ALL.into_iter().filter(|m| m.is_error());
    errors
        .fold(columns, |all, e| all.add(e.key(), e.meaning(), move |(_, m, _)| m.get(e)))
        .join(work(), |(r, ..)| Some(*r))
        .message(|(r, ..)| r.message.clone())
}
