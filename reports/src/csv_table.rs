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
const UNITS: [(&str, &str); 15] = [
    ("_rad_s", "rad/s"),
    ("_n_per_m", "N/m"),
    ("_n_per_m2", "N/m per m"),
    ("_pa_per_m", "Pa/m"),
    ("_rad", "rad"),
    ("_m_s", "m/s"),
    ("_nm", "N m"),
    ("_ns", "N s"),
    ("_hz", "Hz"),
    ("_pa", "Pa"),
    ("_j", "J"),
    ("_w", "W"),
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

impl CsvTable {
    /// Removes the columns in which no row has a value.
    #[must_use]
    pub(crate) fn without_empty_columns(mut self) -> Self {
        let kept: Vec<bool> = (0..self.header.len())
            .map(|i| self.rows.iter().any(|row| !row[i].is_empty()))
            .collect();
        for cells in self.rows.iter_mut().chain([&mut self.header]) {
            let mut kept = kept.iter();
            cells.retain(|_| kept.next() == Some(&true));
        }
        self
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
