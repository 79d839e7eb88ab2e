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

/// Name of the column of the scene in tables of several scenes.
pub(crate) const SCENE: &str = "scene";

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

    /// Returns the tables of one or several scenes. Rows of several scenes are in one file, with the name of the scene
    /// in front and the columns of all.
    pub(crate) fn of_scenes<'s>(
        scenes: impl IntoIterator<Item = (Option<&'s str>, Vec<Self>)>,
    ) -> Vec<Self> {
        let mut files: Vec<Self> = Vec::new();
        for (scene, tables) in scenes {
            let Some(scene) = scene else {
                files.extend(tables);
                continue;
            };
            for table in tables {
                let known = files.iter().position(|f| f.file == table.file);
                let place = known.unwrap_or_else(|| {
                    files.push(Self {
                        file: table.file.clone(),
                        header: vec![SCENE.into()],
                        rows: Vec::new(),
                    });
                    files.len() - 1
                });
                files[place].append(scene, table);
            }
        }
        files
    }

    /// Appends the rows of a table of a scene to those of others.
    fn append(&mut self, scene: &str, table: Self) {
        for name in &table.header {
            if !self.header.contains(name) {
                self.header.push(name.clone());
                self.rows.iter_mut().for_each(|row| row.push(String::new()));
            }
        }
        let place = |name: &String| self.header.iter().position(|own| own == name);
        let places: Vec<Option<usize>> = table.header.iter().map(place).collect();
        for row in table.rows {
            let mut cells = vec![String::new(); self.header.len()];
            cells[0] = scene.to_owned();
            for (cell, place) in row.into_iter().zip(&places) {
                if let Some(place) = place {
                    cells[*place] = cell;
                }
            }
            self.rows.push(cells);
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
