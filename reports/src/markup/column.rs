//! Columns of the tables of a page: their rank, and their width.

use crate::drawing::canvas::text_width;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Width of the text of a page on a screen, and of a table in print at its smaller type \[px\].
pub const PAGE: f64 = 918.0;
/// Font size of tables, and space between columns \[px\].
const SIZE: f64 = 12.5;
const BETWEEN: f64 = 12.0;
/// Text wraps beyond this \[px\].
const WRAP: f64 = 150.0;
/// Rank of a column, by which it is kept in the table at a glance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Rank {
    /// The column identifies the row.
    Key,
    /// The column contains the result of the table.
    Result,
    /// Further information, dropped first where the page is too narrow.
    #[default]
    Detail,
}

/// Format of the cells of a column.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// Left-aligned text.
    #[default]
    Text,
    /// Text or number as it is, right-aligned.
    Plain,
    /// Counts, with their digits in groups of three; a column of zeros is left out.
    Counts,
    /// Numbers with this many digits and one prefix by their typical magnitude; none without a unit.
    Numbers(usize),
    /// Numbers with this many digits, each with a prefix of its own.
    Quantities(usize),
    /// Times, each in the unit that suits it, from nanoseconds to days.
    Durations,
    /// Numbers with at most this many digits, without prefix.
    Short(usize),
    /// Numbers with this many digits in the unit of the column; magnitudes below 1e-6 are zero.
    Fixed(usize),
    /// Numbers over a factor, in a unit and with this many digits.
    Scaled(f64, Cow<'static, str>, usize),
    /// Residuals, always as powers of ten.
    Powers,
    /// Ratios in per cent with this many digits.
    Percents(usize),
    /// Deviations in per cent, with their sign.
    Deviations,
}

/// A column: its heading, unit, and one cell per row.
pub struct Column {
    pub rank: Rank,
    pub heading: String,
    pub unit: String,
    pub cells: Vec<Option<String>>,
    pub text: bool,
}

impl Column {
    /// True if a cell holds a text that is too long for one line.
    pub fn wraps(&self) -> bool {
        let long = |t: &String| text_width(t, SIZE) > WRAP;
        self.text && self.cells.iter().flatten().any(long)
    }

    /// Returns the width on the page \[px\]; text and headings wrap at their spaces.
    pub fn width(&self) -> f64 {
        let cells = self.cells.iter().flatten();
        let widest = cells.map(|t| text_width(t, SIZE)).fold(0.0, f64::max);
        let widest = if self.wraps() { WRAP } else { widest };
        let words = self.heading.split(' ').chain([self.unit.as_str()]);
        let head = words
            .map(|w| 1.08 * text_width(w, SIZE))
            .fold(0.0, f64::max);
        BETWEEN + widest.max(head)
    }
}

/// Returns the width of adjacent columns \[px\].
pub fn width(columns: &[&Column]) -> f64 {
    columns.iter().map(|c| c.width()).sum()
}
