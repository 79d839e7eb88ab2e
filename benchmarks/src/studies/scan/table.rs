//! The tables of a scan: `cells.csv` with a row for each run, and `timings.csv` with its processor time, which differs
//! from start to start. Both are written and read row by row, so that their length is limited by the disk alone.

use super::design::Design;
use crate::cli::files::StagedFile;
use gearbench_reports::record::Status;
use gearbench_reports::scan::ScanConfiguration;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::Path;

/// Rows of all runs.
pub const CELLS: &str = "cells.csv";
/// Processor times of all runs.
pub const TIMINGS: &str = "timings.csv";
/// Names of the columns that are not those of keys and outputs, in their order.
pub const CELL: &str = "cell";
pub const MIDDLE: [&str; 3] = ["model", "integrator", "status"];
pub const MESSAGE: &str = "message";
/// Names of the columns of `timings.csv`.
const HEADER_OF_TIMINGS: [&str; 4] = [CELL, MIDDLE[0], MIDDLE[1], "cpu_s"];

/// Result of one run of a cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CellRun {
    /// How the run ended.
    pub status: Status,
    /// Values of the outputs; absent where the run has none.
    pub outputs: Vec<Option<f64>>,
    /// Reason of a failure, or a remark.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub message: String,
    /// Processor time of the integration [s].
    pub cpu_s: f64,
}

impl CellRun {
    /// A run that has none of `outputs` results.
    pub fn without_result(status: Status, message: String, outputs: usize) -> Self {
        CellRun {
            status,
            outputs: vec![None; outputs],
            message,
            cpu_s: 0.0,
        }
    }
}

/// A reason why a table cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file is not a table of this scan.
    #[error("{0}")]
    Content(String),
}

impl From<csv::Error> for TableError {
    fn from(e: csv::Error) -> Self {
        match e.into_kind() {
            csv::ErrorKind::Io(e) => TableError::Io(e),
            other => TableError::Content(format!("{other:?}")),
        }
    }
}

/// Names of the columns of `cells.csv`.
pub fn header(design: &Design, outputs: &[String]) -> Vec<String> {
    let keys = design
        .axes()
        .iter()
        .flat_map(|a| &a.keys)
        .map(ToString::to_string);
    std::iter::once(CELL.to_owned())
        .chain(keys)
        .chain(MIDDLE.map(str::to_owned))
        .chain(outputs.iter().cloned())
        .chain([MESSAGE.to_owned()])
        .collect()
}

/// Both tables while they are written.
pub struct TableWriter {
    header: Vec<String>,
    cells: csv::Writer<BufWriter<StagedFile>>,
    timings: csv::Writer<BufWriter<StagedFile>>,
}

impl TableWriter {
    /// Begins the tables in a folder; they get their names when they are complete.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn begin(folder: &Path, header: &[String]) -> Result<Self, TableError> {
        let open = |name: &str| -> io::Result<_> {
            let file = StagedFile::begin(&folder.join(name))?;
            Ok(csv::Writer::from_writer(BufWriter::with_capacity(
                1 << 16,
                file,
            )))
        };
        let mut all = TableWriter {
            header: header.to_vec(),
            cells: open(CELLS)?,
            timings: open(TIMINGS)?,
        };
        all.cells.write_record(header)?;
        all.timings.write_record(HEADER_OF_TIMINGS)?;
        Ok(all)
    }

    /// Writes the rows of a cell, one for each configuration.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn write(
        &mut self,
        cell: u64,
        values: &[String],
        configurations: &[ScanConfiguration],
        runs: &[CellRun],
    ) -> Result<(), TableError> {
        let number = (cell + 1).to_string();
        for (configuration, run) in configurations.iter().zip(runs) {
            let names = [&configuration.label, &configuration.integrator];
            self.cells.write_field(&number)?;
            for value in values {
                self.cells.write_field(value)?;
            }
            for name in names {
                self.cells.write_field(name)?;
            }
            self.cells.write_field(run.status.as_str())?;
            for x in &run.outputs {
                // The shortest text that gives the same number again.
                self.cells
                    .write_field(x.map_or_else(String::new, |x| format!("{x:e}")))?;
            }
            self.cells
                .write_field(gearbench_reports::escape::cell(&run.message).as_bytes())?;
            self.cells.write_record(None::<&[u8]>)?;
            let cpu = format!("{:.6e}", run.cpu_s);
            self.timings
                .write_record([&number, names[0], names[1], &cpu])?;
        }
        Ok(())
    }

    /// Copies the rows of the tables of a part, whose cells must be `first` to `last`, counted from 1.
    ///
    /// # Errors
    /// [`TableError`] with what is wrong with the part.
    pub fn append(
        &mut self,
        folder: &Path,
        [first, last]: [u64; 2],
        runs: u64,
    ) -> Result<(), TableError> {
        let copy = |name: &str, to: &mut csv::Writer<BufWriter<StagedFile>>, header: &[String]| {
            let path = folder.join(name);
            let named = |e: TableError| TableError::Content(format!("{}: {e}", path.display()));
            let mut reader = reader(&path).map_err(named)?;
            let found = reader.headers().map_err(|e| named(e.into()))?;
            if found != header {
                return Err(named(TableError::Content(
                    "its columns are not those of the scan".into(),
                )));
            }
            let (mut record, mut rows) = (csv::StringRecord::new(), 0);
            while reader
                .read_record(&mut record)
                .map_err(|e| named(e.into()))?
            {
                let expected = first + rows / runs;
                if record.get(0) != Some(&expected.to_string()) || expected > last {
                    return Err(named(TableError::Content(format!(
                        "row {} is of cell {}, expected cell {expected}",
                        rows + 1,
                        record.get(0).unwrap_or_default()
                    ))));
                }
                to.write_record(&record)?;
                rows += 1;
            }
            let expected = (last + 1 - first) * runs;
            if rows != expected {
                let e = format!("it has {rows} rows, expected {expected}");
                return Err(named(TableError::Content(e)));
            }
            Ok(())
        };
        copy(CELLS, &mut self.cells, &self.header)?;
        copy(
            TIMINGS,
            &mut self.timings,
            &HEADER_OF_TIMINGS.map(str::to_owned),
        )
    }

    /// Completes the tables.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn commit(self) -> Result<(), TableError> {
        for writer in [self.cells, self.timings] {
            let mut buffer = writer.into_inner().map_err(|e| e.into_error())?;
            buffer.flush()?;
            buffer.into_inner().map_err(|e| e.into_error())?.commit()?;
        }
        Ok(())
    }
}

fn reader(path: &Path) -> Result<csv::Reader<BufReader<File>>, TableError> {
    let file = BufReader::with_capacity(1 << 16, File::open(path)?);
    Ok(csv::Reader::from_reader(file))
}

/// A row of `cells.csv` as statistics need it.
pub struct TableRow<'a> {
    /// Cell, from 0.
    pub cell: u64,
    /// Configuration, from 0.
    pub configuration: usize,
    /// Values of the keys.
    pub values: &'a [String],
    /// How the run ended, as text.
    pub status: &'a str,
    /// Values of the outputs, NaN where there are none.
    pub outputs: &'a [f64],
    /// Reason of a failure, or a remark.
    pub message: &'a str,
}

/// Reads the rows of `cells.csv` one after the other.
///
/// # Errors
/// [`TableError`] when the file cannot be read or is not a table of the design.
pub fn read_rows(
    path: &Path,
    (keys, configurations, outputs): (usize, usize, usize),
    each: &mut dyn FnMut(TableRow<'_>),
) -> Result<(), TableError> {
    let mut reader = reader(path)?;
    let mut record = csv::StringRecord::new();
    let mut values = vec![String::new(); keys];
    let mut numbers = vec![f64::NAN; outputs];
    let mut row = 0;
    while reader.read_record(&mut record)? {
        let expected = 1 + keys + MIDDLE.len() + outputs + 1;
        if record.len() != expected {
            let e = format!(
                "row {} has {} columns, expected {expected}",
                row + 1,
                record.len()
            );
            return Err(TableError::Content(e));
        }
        let broken = |what: &str| TableError::Content(format!("row {}: {what}", row + 1));
        let cell: u64 = record[0]
            .parse()
            .map_err(|_| broken("no number of a cell"))?;
        for (value, text) in values.iter_mut().zip(record.iter().skip(1)) {
            value.clear();
            value.push_str(text);
        }
        let begin = 1 + keys + MIDDLE.len();
        for (x, text) in numbers.iter_mut().zip(record.iter().skip(begin)) {
            *x = match text {
                "" => f64::NAN,
                text => text.parse().map_err(|_| broken("an output is no number"))?,
            };
        }
        each(TableRow {
            cell: cell
                .checked_sub(1)
                .ok_or_else(|| broken("cells count from 1"))?,
            configuration: (row % configurations as u64) as usize,
            values: &values,
            status: &record[begin - 1],
            outputs: &numbers,
            message: &record[begin + outputs],
        });
        row += 1;
    }
    Ok(())
}
