//! Tables in CSV: SI units in the header, ten digits per number, empty cells for missing values.

use crate::escape;

/// A table that a study writes to a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CsvTable {
    /// Name of the file in the study's folder.
    pub file: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// Texts of the cells, row by row, as many per row as the header has names.
    pub rows: Vec<Vec<String>>,
}

/// Endings of column names, each with its unit.
const UNITS: [(&str, &str); 10] = [
    ("_rad_s", "rad/s"),
    ("_n_per_m", "N/m"),
    ("_rad", "rad"),
    ("_m_s", "m/s"),
    ("_nm", "N m"),
    ("_hz", "Hz"),
    ("_pa", "Pa"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
];

/// Returns the name of a column without its unit, and the unit, which is empty for a name without one.
pub fn named_unit(column: &str) -> (&str, &'static str) {
    let mut endings = UNITS.iter();
    let found = endings.find_map(|(ending, unit)| Some((column.strip_suffix(ending)?, *unit)));
    found.unwrap_or((column, ""))
}

/// A column of rows of a kind: its name, and its cell in a row.
pub type CsvColumn<'c, R> = (&'c str, &'c dyn Fn(&R) -> String);

impl CsvTable {
    /// Makes a table from rows of data and columns with the text of their cells.
    pub fn new<R>(
        file: &str,
        rows: impl IntoIterator<Item = R>,
        columns: &[CsvColumn<'_, R>],
    ) -> Self {
        let cells = |row: R| columns.iter().map(|(_, cell)| cell(&row)).collect();
        Self {
            file: file.into(),
            header: columns.iter().map(|(name, _)| (*name).into()).collect(),
            rows: rows.into_iter().map(cells).collect(),
        }
    }

    /// Returns the text of the file.
    pub fn text(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        // Writing to memory cannot fail; a refused row would be one of unequal length.
        for row in std::iter::once(&self.header).chain(&self.rows) {
            for cell in row {
                let _ = writer.write_field(escape::cell(cell).as_bytes());
            }
            let _ = writer.write_record(None::<&[u8]>);
        }
        String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
    }
}

/// Returns a number with ten digits, or an empty text for a missing one.
pub fn number(x: impl Into<Option<f64>>) -> String {
    let finite = x.into().filter(|x| x.is_finite());
    finite.map_or(String::new(), |x| format!("{x:.9e}"))
}

/// Formats a number with all its digits.
pub fn exact(x: f64) -> String {
    format!("{x:e}")
}

/// Returns the text of a value, or an empty text for `None`.
pub fn text<T: ToString>(x: &Option<T>) -> String {
    x.as_ref().map_or(String::new(), T::to_string)
}
