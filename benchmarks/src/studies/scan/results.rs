//! The record of a scan from its table.

use super::design::Design;
use super::statistics::{Statistics, Visit};
use super::table::{CELLS, TableError, read_rows};
use gearbench_reports::record::{Part, Results, Status};
use gearbench_reports::scan::{FailureCount, ScanRecord, ShownRow};
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
    record.failures = failures(&path, sizes)?;
    if record.shard.is_some() {
        return Ok(());
    }
    record.unaffected = unaffected(&path, sizes, design.cells())?;
    let rows = |visit: &mut Visit<'_>| {
        read_rows(&path, sizes, &mut |row| {
            visit(row.cell, row.configuration, row.outputs)
        })
    };
    let found = Statistics::of(design, (sizes.1, sizes.2), &rows)?;
    (record.statistics, record.indices) = (found.samples, found.indices);
    record.shown = shown(record, design, &path, sizes)?;
    Ok(())
}

/// Counts of failed runs by configuration and status, in the order of their first cells.
fn failures(path: &Path, sizes: (usize, usize, usize)) -> Result<Vec<FailureCount>, TableError> {
    let mut all: Vec<FailureCount> = Vec::new();
    read_rows(path, sizes, &mut |row| {
        let status = Status::ALL.into_iter().find(|s| s.as_str() == row.status);
        let status = status.unwrap_or_default();
        if !status.is_failure() {
            return;
        }
        let same =
            |f: &&mut FailureCount| (f.configuration, f.status) == (row.configuration, status);
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
    })?;
    Ok(all)
}

/// Configurations whose outputs are the same in all cells, of which there are several.
fn unaffected(
    path: &Path,
    sizes: (usize, usize, usize),
    cells: u64,
) -> Result<Vec<usize>, TableError> {
    let mut first: Vec<Option<Vec<f64>>> = vec![None; sizes.1];
    let mut same = vec![cells > 1; sizes.1];
    let equal = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
    read_rows(path, sizes, &mut |row| match &first[row.configuration] {
        None => first[row.configuration] = Some(row.outputs.to_vec()),
        Some(first) => same[row.configuration] &= equal(first, row.outputs),
    })?;
    let has_values = |c: &usize| first[*c].iter().flatten().any(|x| x.is_finite());
    Ok((0..sizes.1)
        .filter(|c| same[*c])
        .filter(has_values)
        .collect())
}

/// Rows of charts: of samples the first ones, which are a scan with fewer samples; of listed values evenly spaced ones.
fn shown(
    record: &ScanRecord,
    design: &Design,
    path: &Path,
    sizes: (usize, usize, usize),
) -> Result<Vec<ShownRow>, TableError> {
    let most = (MOST_SHOWN / record.configurations.len().max(1) as u64).max(1);
    let step = match design.is_sampled() {
        true => 1,
        // An odd number, so that the last axis does not show one value alone.
        false => design.cells().div_ceil(most) | 1,
    };
    let mut all = Vec::new();
    let mut cells = 0;
    let mut last = None;
    read_rows(path, sizes, &mut |row| {
        let place = design.place(row.cell);
        if place.variant > 1 || row.cell % step != 0 {
            return;
        }
        if last != Some(row.cell) {
            last = Some(row.cell);
            cells += 1;
        }
        if cells > most {
            return;
        }
        let mut values = row.values.iter();
        let firsts = design.axes().iter().map(|axis| {
            let first = values.next().and_then(|text| text.parse::<f64>().ok());
            (1..axis.keys.len()).for_each(|_| {
                values.next();
            });
            first
        });
        all.push(ShownRow {
            cell: row.cell + 1,
            configuration: row.configuration,
            at: design.positions(place.combination),
            values: firsts.collect(),
            outputs: row
                .outputs
                .iter()
                .map(|x| x.is_finite().then_some(*x))
                .collect(),
        });
    })?;
    Ok(all)
}
