//! Flank modifications that vary over the face width: end relief, helix slope, twist, and measured topography.
//!
//! ```toml
//! end_relief = { low = { amount_m = 10e-6, length_m = 2e-3 }, high = { amount_m = 10e-6, length_m = 2e-3, shape = "parabolic" } }
//! helix_slope_m = { left = 8e-6 }
//! twist_m = 5e-6
//! topography = { unit_m = 1e-6, left = "left.csv", right = [[0, 1, 0], [0, 0, 0], [2, 3, 2]] }
//! ```

use super::error::SceneError;
use super::geometry::geometry;
use super::measured::DataFiles;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::Positive;
use gearbench_models::geometry::{EndRelief, ReliefShape, Topography};
use gearbench_reference::data::decode;
use gearbench_reference::files;
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;

/// Largest size of a topography file [bytes].
const MOST_BYTES: u64 = 64 << 20;

keys! {
    /// Relief at the ends of the face.
    struct EndReliefTable {
        /// at the lower end of the face, along the gear's axis: { amount_m, length_m, shape = "linear" or "parabolic" }
        low: Option<EndTable>,
        /// the same at the upper end
        high: Option<EndTable>,
    }

    /// Relief at one end of the face.
    struct EndTable {
        /// material removed at the end of the face, normal to the flank, in metres
        amount_m: f64,
        /// distance from the end at which the relief starts in metres
        length_m: f64,
        /// "linear" (default) or "parabolic"
        shape: Option<ReliefShape>,
    }

    /// Values of the two sides of the teeth.
    struct SideTable {
        /// of left (counter-clockwise) flanks in metres, default 0
        left: Option<f64>,
        /// of right flanks in metres, default 0
        right: Option<f64>,
    }

    /// Measured flanks on a grid.
    struct TopographyTable {
        /// material removed of left flanks: rows from root to tip, each from the lower to the upper end of the face, as a list of lists or a CSV file of numbers
        left: Option<AmountTable>,
        /// the same of right flanks
        right: Option<AmountTable>,
        /// the same of both sides
        both: Option<AmountTable>,
        /// length of one unit of the amounts in metres, default 1; for micrometres 1e-6
        unit_m: Option<Positive>,
        /// radii of the first and the last row in metres; left out, form circle and tip
        radii_m: Option<[f64; 2]>,
        /// heights of the first and the last column from the middle of the face in metres; left out, its ends
        heights_m: Option<[f64; 2]>,
    }
}

/// One value for both sides of the teeth, or one for each.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum PerSide {
    /// One value for both sides [m].
    #[serde(rename = "<number>")]
    Both(f64),
    /// Values by side.
    #[serde(rename = "<table>")]
    Each(SideTable),
}

/// Amounts of removed material on a grid.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum AmountTable {
    /// Path of a CSV file.
    #[serde(rename = "<text>")]
    File(String),
    /// Rows from root to tip.
    #[serde(rename = "<list>")]
    Rows(Vec<Vec<f64>>),
}

/// Reads the end reliefs at the lower and upper end of the face.
pub(super) fn end_reliefs(keys: Option<&EndReliefTable>) -> [Option<EndRelief>; 2] {
    let of = |end: &EndTable| EndRelief {
        amount: end.amount_m,
        length: end.length_m,
        shape: end.shape.unwrap_or(ReliefShape::Linear),
    };
    keys.map_or([None, None], |keys| {
        [&keys.low, &keys.high].map(|end| end.as_ref().map(of))
    })
}

/// Values of left and right flanks; 0 if not given.
pub(super) fn per_side(keys: Option<&PerSide>) -> [f64; 2] {
    match keys {
        None => [0.0; 2],
        Some(PerSide::Both(value)) => [*value; 2],
        Some(PerSide::Each(sides)) => [sides.left, sides.right].map(Option::unwrap_or_default),
    }
}

/// Measured flanks of both sides.
pub(super) type MeasuredFlanks = [Option<Arc<Topography>>; 2];

/// Reads the topographies of a gear.
pub(super) fn topography(
    keys: Option<&TopographyTable>,
    files: &DataFiles<'_>,
    at: &Place<'_>,
) -> Result<MeasuredFlanks, SceneError> {
    let mut measured = MeasuredFlanks::default();
    let Some(keys) = keys else {
        return Ok(measured);
    };
    let sides = [("left", &keys.left), ("right", &keys.right)];
    if let (Some(_), Some((key, _))) = (&keys.both, sides.iter().find(|(_, k)| k.is_some())) {
        return Err(at.key("both").against(
            (&at.key(key), "this"),
            format!("`both` and `{key}` define the removed material of the same flanks"),
            "and this",
            "remove one",
        ));
    }
    if keys.both.is_none() && sides.iter().all(|(_, k)| k.is_none()) {
        return at.refuse(
            "the topography contains no amounts",
            "here",
            "add `both`, `left` or `right`: rows from root to tip, or a CSV file",
        );
    }
    let unit = keys.unit_m.map_or(1.0, f64::from);
    let read = |key: &str, amounts: &AmountTable| {
        let place = at.key(key);
        let mut rows = match amounts {
            AmountTable::Rows(rows) => rows.clone(),
            AmountTable::File(file) => rows_of(&files.path(file), &place)?,
        };
        rows.iter_mut().flatten().for_each(|x| *x *= unit);
        let grid = Topography::new(&rows, keys.radii_m, keys.heights_m);
        grid.map(Arc::new).map_err(|e| geometry(at, &e))
    };
    if let Some(both) = &keys.both {
        let grid = read("both", both)?;
        return Ok([Some(grid.clone()), Some(grid)]);
    }
    for (i, (key, amounts)) in sides.into_iter().enumerate() {
        let grid = amounts.as_ref().map(|a| read(key, a)).transpose()?;
        measured[i] = grid;
    }
    Ok(measured)
}

/// Rows of numbers of a CSV file: commas, semicolons, tabs or blanks between them, lines that begin with `#` passed over;
/// with anything else than commas a comma may be the decimal sign.
fn rows_of(path: &Path, at: &Place<'_>) -> Result<Vec<Vec<f64>>, SceneError> {
    let shown = path.display();
    let refuse =
        |found: String, help: &str| at.refuse(format!("`{shown}` {found}"), "this file", help);
    let bytes = match files::read(path, MOST_BYTES) {
        Ok(bytes) => bytes,
        Err(e) => {
            let help = match e.kind() {
                ErrorKind::NotFound => "paths are relative to the folder of the scene file",
                ErrorKind::FileTooLarge => "give at most 1000 rows of 1000 amounts",
                _ => "give the path of a readable CSV file of numbers",
            };
            return refuse(format!("cannot be read: {e}"), help);
        }
    };
    let (text, _) = match decode(&bytes) {
        Ok(text) => text,
        Err(e) => return refuse(format!("is {}, not {}", e.found, e.expected), &e.help),
    };
    let mut rows = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let sign = [';', '\t', ','].into_iter().find(|c| line.contains(*c));
        let cells: Vec<&str> = match sign {
            Some(sign) => line.split(sign).map(str::trim).collect(),
            None => line.split_whitespace().collect(),
        };
        let mut row = Vec::with_capacity(cells.len());
        for (j, cell) in cells.iter().enumerate() {
            let decimal = match sign {
                Some(',') => (*cell).to_owned(),
                _ => cell.replace(',', "."),
            };
            let Ok(value) = decimal.parse::<f64>() else {
                let found = format!(
                    "has `{}` in line {}, column {}, where a number is expected",
                    cell.chars().take(40).collect::<String>(),
                    i + 1,
                    j + 1
                );
                return refuse(found, "start lines of names with `#`");
            };
            row.push(value);
        }
        rows.push(row);
    }
    Ok(rows)
}
