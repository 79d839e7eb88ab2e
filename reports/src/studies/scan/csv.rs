//! CSV tables of a scan: statistics and sensitivity indices. The study writes the rows of all cells to `cells.csv` and
//! their times to `timings.csv` one by one, without a record in between.

use super::{SampleStatistics, ScanRecord, SensitivityIndex};
use crate::columns::{Columns, FileDescription};
use crate::csv_table::CsvTable;
use crate::markup::column::Format;
use crate::metrics::Metric;

/// Statistics with their record.
pub type Statistics<'a> = (&'a ScanRecord, &'a SampleStatistics);
/// An index with its record.
pub type Index<'a> = (&'a ScanRecord, &'a SensitivityIndex);

/// Returns the tables of statistics and indices.
pub fn tables(record: &ScanRecord) -> Vec<CsvTable> {
    let all = [
        statistics().table(record.statistics.iter().map(|s| (record, s))),
        indices().table(record.indices.iter().map(|s| (record, s))),
    ];
    all.into_iter().filter(|t| !t.rows.is_empty()).collect()
}

/// Returns the columns of statistics.
#[rustfmt::skip]
pub fn statistics<'a>() -> Columns<'a, Statistics<'a>> {
    let quantile = |k: usize| move |(_, s): &Statistics<'_>| s.quantiles[k];
    Columns::<Statistics<'_>>::of("scan_statistics.csv", "`scan` with samples: one row per model, quantity and combination of listed values.")
        .model(|(r, s)| r.configurations[s.configuration].label.clone())
        .integrator(|(r, s)| r.configurations[s.configuration].integrator.clone())
        .add("quantity", "key of the quantity", |(r, s)| r.outputs[s.output].clone())
        .add("at", "values of the listed axes", |(r, s)| r.at_text(&s.at)).shown("At", Format::Text)
        .add("count", "number of samples with a value", |(_, s)| s.count)
        .add("missing", "number of samples without one", |(_, s)| s.missing)
        .add("mean", "mean, in the unit of the quantity as all that follows", |(_, s)| s.mean)
        .add("standard_deviation", "standard deviation of a sample", |(_, s)| s.deviation)
        .add("least", "least value", quantile(0))
        .add("quantile_5", "value that 5 % of the samples do not exceed", quantile(1))
        .add("quantile_25", "value that 25 % of the samples do not exceed", quantile(2))
        .add("median", "median", quantile(3))
        .add("quantile_75", "value that 75 % of the samples do not exceed", quantile(4))
        .add("quantile_95", "value that 95 % of the samples do not exceed", quantile(5))
        .add("greatest", "greatest value", quantile(6))
}

/// Returns the columns of sensitivity indices.
#[rustfmt::skip]
pub fn indices<'a>() -> Columns<'a, Index<'a>> {
    let first = |k: usize| move |(_, s): &Index<'_>| s.first[k];
    let total = |k: usize| move |(_, s): &Index<'_>| s.total[k];
    Columns::<Index<'_>>::of("scan_indices.csv", "`scan --indices`: one row per model, quantity, combination of listed values, and axis.")
        .model(|(r, s)| r.configurations[s.configuration].label.clone()).shown("Model", Format::Text)
        .integrator(|(r, s)| r.configurations[s.configuration].integrator.clone())
        .add("quantity", "key of the quantity", |(r, s)| r.outputs[s.output].clone())
        .add("at", "values of the listed axes", |(r, s)| r.at_text(&s.at)).shown("At", Format::Text)
        .add("axis", "keys of the axis", |(r, s)| r.axes[s.axis].keys.join(" | ")).shown("Axis", Format::Text)
        .add("first_order", "first-order index: share of the variance that the axis causes alone", first(0)).shown("First order", Format::Numbers(3)).result()
        .add("first_order_low_95", "lower end of its 95 % interval", first(1))
        .add("first_order_high_95", "upper end of its 95 % interval", first(2))
        .add("total", "total index: share that it causes alone and together with other axes", total(0)).shown("Total", Format::Numbers(3)).result()
        .add("total_low_95", "lower end of its 95 % interval", total(1))
        .add("total_high_95", "upper end of its 95 % interval", total(2))
}

/// Returns the description of the table of cells, with every quantity that it can have.
pub fn cells() -> FileDescription {
    let own = [
        ("cell", "number of the cell, from 1"),
        ("SECTION.KEY", "value of a varied key of the scene"),
        ("model", "model, with its distinguishing settings"),
        ("integrator", "integrator with its step or tolerance"),
        ("status", "end of the run"),
        (
            "efficiency",
            "power taken out over power put in by loads and drives, means over the second half of a settled run",
        ),
        ("steps", "accepted steps"),
        (
            "speed_end_GEAR_rad_s",
            "final angular velocity of the gear, with `speeds_end` of all gears",
        ),
        ("message", "reason of a failure"),
    ];
    let metrics = Metric::ALL.map(|m| (m.key(), m.meaning()));
    let all = own[..5].iter().chain(&metrics).chain(&own[5..]);
    described(
        "cells.csv",
        "`scan`: one row per run. Of the quantities it has those of `--outputs`.",
        all,
    )
}

/// Returns the description of the table of times.
pub fn times_of_cells() -> FileDescription {
    let columns = [
        ("cell", "number of the cell, from 1"),
        ("model", "model, with its distinguishing settings"),
        ("integrator", "integrator with its step or tolerance"),
        ("cpu_s", "processor time of the run"),
    ];
    described("timings.csv", "`scan`: one row per run.", &columns)
}

fn described<'a>(
    file: &str,
    rows: &str,
    columns: impl IntoIterator<Item = &'a (&'static str, &'static str)>,
) -> FileDescription {
    FileDescription {
        file: file.into(),
        rows: rows.into(),
        columns: (columns.into_iter())
            .map(|(key, meaning)| ((*key).into(), (*meaning).into()))
            .collect(),
    }
}
