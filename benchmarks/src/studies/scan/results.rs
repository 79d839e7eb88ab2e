//! The record of a scan from its table.

use super::design::Design;
use super::statistics::{Statistics, Visit};
use super::table::{CELLS, TableError, TableRow, read_rows};
use gearbench_reports::record::{Part, Results, Status};
use gearbench_reports::scan::{FailureCount, ShownRow};
use std::path::Path;

/// Largest number of rows that a record keeps for charts.
const MOST_SHOWN: u64 = 3000;

/// Adds failures, statistics, indices and rows of charts to a record, all computed from the table in a folder. The
/// record of a part has failures alone.
///
/// # Errors
/// [`TableError`] when the table cannot be read.
pub fn summarise_table(
    results: &mut Results,
    design: &Design,
    folder: &Path,
) -> Result<(), TableError> {
    let Part::Scan(record) = &mut results.part else {
        return Ok(());
    };
    let keys = design.axes().iter().map(|a| a.keys.len()).sum();
    let sizes = (keys, record.configurations.len(), record.outputs.len());
    let path = folder.join(CELLS);
    let whole = record.shard.is_none();
    let mut unaffected = Unaffected::of(sizes.1, design.cells());
    let mut shown = ShownRows::of(design, sizes.1);
    read_rows(&path, sizes, &mut |row| {
        count_failure(&mut record.failures, &row);
        if whole {
            unaffected.see(&row);
            shown.see(&row);
        }
    })?;
    #[cfg(feature = "parquet")]
    super::parquet::write(
        folder,
        &path,
        design.axes(),
        (&record.configurations, &record.outputs),
    )?;
    if !whole {
        return Ok(());
    }
    (record.unaffected, record.shown) = (unaffected.configurations(), shown.rows);
    let rows = |visit: &mut Visit<'_>| {
        read_rows(&path, sizes, &mut |row| {
            visit(row.cell, row.configuration, row.outputs)
        })
    };
    let found = Statistics::of(design, (sizes.1, sizes.2), &rows)?;
    (record.statistics, record.indices) = (found.samples, found.indices);
    Ok(())
}

/// Counts a failed run by configuration and status, in the order of their first cells.
fn count_failure(all: &mut Vec<FailureCount>, row: &TableRow<'_>) {
    let status = Status::ALL.into_iter().find(|s| s.as_str() == row.status);
    let status = status.unwrap_or_default();
    if !status.is_failure() {
        return;
    }
    let same = |f: &&mut FailureCount| (f.configuration, f.status) == (row.configuration, status);
    match all.iter_mut().find(same) {
        Some(known) => known.count += 1,
        None => all.push(FailureCount {
            configuration: row.configuration,
            status,
            count: 1,
            first_cell: row.cell + 1,
            message: row.message.to_owned(),
        }),
    }
}

/// Finds the configurations whose outputs are the same in all cells, of which there are several.
struct Unaffected {
    /// Outputs of the first cell of each configuration.
    first: Vec<Option<Vec<f64>>>,
    same: Vec<bool>,
}

impl Unaffected {
    fn of(configurations: usize, cells: u64) -> Self {
        Unaffected {
            first: vec![None; configurations],
            same: vec![cells > 1; configurations],
        }
    }

    fn see(&mut self, row: &TableRow<'_>) {
        let equal = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
        match &self.first[row.configuration] {
            None => self.first[row.configuration] = Some(row.outputs.to_vec()),
            Some(first) => self.same[row.configuration] &= equal(first, row.outputs),
        }
    }

    fn configurations(&self) -> Vec<usize> {
        let has_values = |c: &usize| self.first[*c].iter().flatten().any(|x| x.is_finite());
        let all = (0..self.same.len()).filter(|c| self.same[*c]);
        all.filter(has_values).collect()
    }
}

/// Rows of charts: of samples the first ones, which are a scan with fewer samples; of listed values evenly spaced ones.
struct ShownRows<'d> {
    design: &'d Design,
    /// Largest number of cells.
    most: u64,
    /// Distance between cells.
    step: u64,
    cells: u64,
    last: Option<u64>,
    rows: Vec<ShownRow>,
}

impl<'d> ShownRows<'d> {
    fn of(design: &'d Design, configurations: usize) -> Self {
        let most = (MOST_SHOWN / configurations.max(1) as u64).max(1);
        ShownRows {
            design,
            most,
            step: match design.is_sampled() {
                true => 1,
                // An odd number, so that the last axis does not show one value alone.
                false => design.cells().div_ceil(most) | 1,
            },
            cells: 0,
            last: None,
            rows: Vec::new(),
        }
    }

    fn see(&mut self, row: &TableRow<'_>) {
        let place = self.design.place(row.cell);
        if place.variant > 1 || !row.cell.is_multiple_of(self.step) {
            return;
        }
        if self.last.replace(row.cell) != Some(row.cell) {
            self.cells += 1;
        }
        if self.cells > self.most {
            return;
        }
        let mut values = row.values.iter();
        let firsts = self.design.axes().iter().map(|axis| {
            let mut own = values.by_ref().take(axis.keys.len());
            let first = own.next().and_then(|text| text.parse::<f64>().ok());
            own.for_each(drop);
            first
        });
        let finite = |x: &f64| x.is_finite().then_some(*x);
        self.rows.push(ShownRow {
            cell: row.cell + 1,
            configuration: row.configuration,
            at: self.design.positions(place.combination),
            values: firsts.collect(),
            outputs: row.outputs.iter().map(finite).collect(),
        });
    }
}
