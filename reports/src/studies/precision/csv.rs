//! CSV table of cost and error of all runs against all references.

use super::{Cost, Precision, WorkPrecision, WorkPrecisionPoint};
use crate::csv_table::{CsvColumn, CsvTable, number, text};
use crate::metrics::Metric;
use crate::record::{Metrics, Results, Run, SELF};
use crate::studies::runs::work;

type Row<'a> = (&'a Run, &'a Metrics);

/// Returns the table with a row per run and reference.
pub fn tables(results: &Results) -> Vec<CsvTable> {
    let study = Precision::of(results);
    let clouds: Vec<WorkPrecision<'_>> = (study.references.iter().map(String::as_str))
        .chain([SELF])
        .map(|id| study.cloud(id, study.headline_against(id), Cost::Processor))
        .collect();
    // The front of each reference, of the model's own converged solution that of each model.
    let on_front = |(r, m): &Row<'_>| {
        let own = |s: &WorkPrecisionPoint<'_>| {
            m.against != SELF || s.run.model_label() == r.model_label()
        };
        let Some(cloud) = clouds.iter().find(|c| c.against == m.against) else {
            return false.to_string();
        };
        let front = cloud.front(own);
        let mut runs = front.iter().map(|i| cloud.shown[*i].run);
        runs.any(|run| std::ptr::eq(run, *r)).to_string()
    };
    let none = Metrics::default();
    let rows = results.runs.iter().flat_map(|r| {
        let alone = r.metrics.is_empty().then_some(&none);
        r.metrics.iter().chain(alone).map(move |m| (r, m))
    });
    let errors: Vec<Metric> = (Metric::ALL.into_iter()).filter(|m| m.is_error()).collect();
    let cells: Vec<_> = (errors.iter())
        .map(|e| move |(_, m): &Row<'_>| number(m.get(*e)))
        .collect();
    let mut columns: Vec<CsvColumn<'_, Row<'_>>> = vec![
        ("model", &|(r, _)| r.model_label()),
        ("modes", &|(r, _)| text(&r.modes)),
        ("integrator", &|(r, _)| r.integrator.clone()),
        ("step_s", &|(r, _)| number(r.step)),
        ("rtol", &|(r, _)| number(r.rtol)),
        ("status", &|(r, _)| r.status.to_string()),
        ("fitted_to", &|(r, _)| text(&r.fitted_to)),
        ("against", &|(_, m)| m.against.clone()),
        ("on_front", &on_front),
    ];
    for (metric, cell) in errors.iter().zip(&cells) {
        columns.push((metric.key(), cell));
    }
    let work = work();
    let of_run: Vec<_> = (work.iter())
        .map(|(_, cell)| move |(r, _): &Row<'_>| cell(r))
        .collect();
    for ((name, _), cell) in work.iter().zip(&of_run) {
        columns.push((name, cell));
    }
    columns.push(("message", &|(r, _)| text(&r.message)));
    vec![CsvTable::new("precision.csv", rows, &columns)]
}
