//! The table of cells by columns: `cells.parquet` has the rows of `cells.csv`, with numbers as numbers.
//!
//! It is written from the CSV file in groups of rows, so that its length is limited by the disk alone. Programs for
//! tables read single columns of it, which for millions of rows is many times as fast.

use super::axis::{Axis, AxisValues, text};
use super::table::{CELL, MESSAGE, MIDDLE, TableError, TableRow, read_rows};
use crate::cli::files::StagedFile;
use gearbench_reports::scan::ScanConfiguration;
use parquet::basic::{Compression, ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};
use std::path::Path;
use std::sync::Arc;

/// Name of the file.
pub const CELLS_BY_COLUMN: &str = "cells.parquet";
/// Number of rows that are stored together.
const GROUP: usize = 1 << 16;

impl From<ParquetError> for TableError {
    fn from(e: ParquetError) -> Self {
        TableError::Content(e.to_string())
    }
}

/// Values of a column in a group of rows.
enum Column {
    Cells(Vec<i64>),
    /// Numbers, with 1 where there is one.
    Numbers(Vec<f64>, Vec<i16>),
    Texts(Vec<ByteArray>),
}

impl Column {
    fn number(&mut self, x: Option<f64>) {
        if let Column::Numbers(values, levels) = self {
            values.extend(x);
            levels.push(x.is_some().into());
        }
    }

    fn text(&mut self, text: &str) {
        if let Column::Texts(values) = self {
            values.push(text.into());
        }
    }

    fn len(&self) -> usize {
        match self {
            Column::Cells(values) => values.len(),
            Column::Numbers(_, levels) => levels.len(),
            Column::Texts(values) => values.len(),
        }
    }

    fn clear(&mut self) {
        match self {
            Column::Cells(values) => values.clear(),
            Column::Numbers(values, levels) => {
                values.clear();
                levels.clear();
            }
            Column::Texts(values) => values.clear(),
        }
    }

    fn schema(&self, name: &str) -> Result<TypePtr, ParquetError> {
        let (physical, repetition, converted) = match self {
            Column::Cells(_) => (Physical::INT64, Repetition::REQUIRED, ConvertedType::NONE),
            Column::Numbers(..) => (Physical::DOUBLE, Repetition::OPTIONAL, ConvertedType::NONE),
            Column::Texts(_) => (
                Physical::BYTE_ARRAY,
                Repetition::REQUIRED,
                ConvertedType::UTF8,
            ),
        };
        let column = Type::primitive_type_builder(name, physical);
        let column = column
            .with_repetition(repetition)
            .with_converted_type(converted);
        Ok(Arc::new(column.build()?))
    }
}

/// The columns of the table, in the order of the CSV file.
fn columns(axes: &[Axis], outputs: &[String]) -> Vec<(String, Column)> {
    let texts = || Column::Texts(Vec::new());
    let numbers = || Column::Numbers(Vec::new(), Vec::new());
    let of_key = |axis: &Axis, k: usize| match &axis.values {
        AxisValues::Listed(all)
            if all
                .iter()
                .any(|entry| text(&entry[k]).parse::<f64>().is_err()) =>
        {
            texts()
        }
        _ => numbers(),
    };
    let keys = axes.iter().flat_map(|axis| {
        let keys = axis.keys.iter().enumerate();
        keys.map(move |(k, key)| (key.to_string(), of_key(axis, k)))
    });
    std::iter::once((CELL.to_owned(), Column::Cells(Vec::new())))
        .chain(keys)
        .chain(MIDDLE.map(|name| (name.to_owned(), texts())))
        .chain(outputs.iter().map(|name| (name.clone(), numbers())))
        .chain([(MESSAGE.to_owned(), texts())])
        .collect()
}

/// Writes the file from the rows of `cells.csv`.
///
/// # Errors
/// [`TableError`] when the CSV file cannot be read or the folder not written.
pub fn write(
    folder: &Path,
    cells: &Path,
    axes: &[Axis],
    (configurations, outputs): (&[ScanConfiguration], &[String]),
) -> Result<(), TableError> {
    let mut columns = columns(axes, outputs);
    let fields = columns.iter().map(|(name, c)| c.schema(name));
    let schema = Type::group_type_builder("cells")
        .with_fields(fields.collect::<Result<_, _>>()?)
        .build()?;
    let properties = WriterProperties::builder().set_compression(Compression::LZ4_RAW);
    let file = StagedFile::begin(&folder.join(CELLS_BY_COLUMN))?;
    let mut writer =
        SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties.build()))?;
    let keys = axes.iter().map(|a| a.keys.len()).sum();
    let mut failed = None;
    let add = |columns: &mut [(String, Column)], row: &TableRow<'_>| {
        let configuration = &configurations[row.configuration];
        let middle = [&configuration.label, &configuration.integrator, row.status];
        let mut all = columns.iter_mut().map(|(_, column)| column);
        if let Some(Column::Cells(values)) = all.next() {
            values.push(row.cell as i64 + 1);
        }
        for (text, column) in row.values.iter().zip(all.by_ref()) {
            column.number(text.parse().ok());
            column.text(text);
        }
        for (text, column) in middle.into_iter().zip(all.by_ref().take(MIDDLE.len())) {
            column.text(text);
        }
        for (x, column) in row.outputs.iter().zip(all.by_ref().take(row.outputs.len())) {
            column.number(x.is_finite().then_some(*x));
        }
        all.for_each(|column| column.text(row.message));
    };
    read_rows(
        cells,
        (keys, configurations.len(), outputs.len()),
        &mut |row| {
            add(&mut columns, &row);
            if columns[0].1.len() >= GROUP && failed.is_none() {
                failed = put(&mut writer, &mut columns).err();
            }
        },
    )?;
    if let Some(e) = failed {
        return Err(e.into());
    }
    put(&mut writer, &mut columns)?;
    Ok(writer.into_inner()?.commit()?)
}

/// Writes a group of rows and empties its columns.
fn put(
    writer: &mut SerializedFileWriter<StagedFile>,
    columns: &mut [(String, Column)],
) -> Result<(), ParquetError> {
    if columns[0].1.len() == 0 {
        return Ok(());
    }
    let mut group = writer.next_row_group()?;
    for (_, column) in columns.iter_mut() {
        let Some(mut to) = group.next_column()? else {
            break;
        };
        match column {
            Column::Cells(values) => to.typed::<Int64Type>().write_batch(values, None, None)?,
            Column::Numbers(values, levels) => {
                let to = to.typed::<DoubleType>();
                to.write_batch(values, Some(levels.as_slice()), None)?
            }
            Column::Texts(values) => to
                .typed::<ByteArrayType>()
                .write_batch(values, None, None)?,
        };
        to.close()?;
        column.clear();
    }
    group.close().map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::scan::design::Design;
    use crate::studies::scan::table::{CELLS, CellRun, TableWriter, header};
    use gearbench_reports::record::Status;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::{Field, RowAccessor};

    /// The file has the rows of the table, more than one group of them, with numbers as numbers.
    #[test]
    fn columns_have_the_rows_of_the_table() {
        let rows = GROUP + 10;
        let axes: Vec<Axis> = vec![
            "a.b=uniform(1,2)".parse().unwrap(),
            "c=x,y".parse().unwrap(),
        ];
        let design = Design::new(axes, (Default::default(), Some(rows / 2), 1), false).unwrap();
        let outputs = vec!["peak_force_n".to_owned()];
        let configurations = vec![ScanConfiguration {
            label: "rigid".into(),
            integrator: "rk4".into(),
        }];
        let folder = tempfile::tempdir().unwrap();
        let mut writer = TableWriter::begin(folder.path(), &header(&design, &outputs)).unwrap();
        for cell in 0..design.cells() {
            let failed = cell % 7 == 0;
            let run = match failed {
                true => CellRun::without_result(Status::Timeout, "too long, \"really\"".into(), 1),
                false => CellRun {
                    outputs: vec![Some(0.1 * cell as f64)],
                    ..CellRun::default()
                },
            };
            let values = design.texts(cell);
            writer
                .write(cell, &values, &configurations, &[run])
                .unwrap();
        }
        writer.commit().unwrap();
        let cells = folder.path().join(CELLS);
        write(
            folder.path(),
            &cells,
            design.axes(),
            (&configurations, &outputs),
        )
        .unwrap();
        let file = std::fs::File::open(folder.path().join(CELLS_BY_COLUMN)).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        assert_eq!(reader.metadata().num_row_groups(), 2);
        let mut read = 0;
        for (cell, row) in reader.get_row_iter(None).unwrap().enumerate() {
            let row = row.unwrap();
            let texts = design.texts(cell as u64);
            assert_eq!(row.get_long(0).unwrap(), cell as i64 + 1);
            assert_eq!(row.get_double(1).unwrap(), texts[0].parse::<f64>().unwrap());
            assert_eq!(row.get_string(2).unwrap(), &texts[1]);
            assert_eq!(row.get_string(3).unwrap(), "rigid");
            let peak = row.get_column_iter().nth(6).map(|(_, field)| field.clone());
            let expected = match cell % 7 {
                0 => Field::Null,
                _ => Field::Double(0.1 * cell as f64),
            };
            assert_eq!(peak, Some(expected));
            read += 1;
        }
        assert_eq!(read, design.cells());
    }
}
