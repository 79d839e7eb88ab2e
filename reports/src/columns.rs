//! Columns of tables, each declared once: key, meaning, value in a row, and, where a page shows it, heading and format.
//!
//! The CSV file, its table in `docs/data.md` and the table of the page come from the declaration; the unit is the one
//! at the end of the key. Names that depend on the data (gears, references, numbers of harmonics) are arguments of the
//! function that declares the columns. The dictionary calls it with placeholders in capitals.

use crate::csv_table::{CsvTable, named_unit, number};
use crate::markup::column::{Format, Rank};
use crate::record::Status;
use serde::{Deserialize, Serialize};

/// The value of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Value {
    /// No value: an empty cell.
    Absent,
    /// A count.
    Count(u64),
    /// A number in SI units.
    Number(f64),
    /// A text.
    Text(String),
}

impl Value {
    /// Returns the text of the cell in a CSV file: numbers with ten digits.
    fn csv(self) -> String {
        match self {
            Value::Absent => String::new(),
            Value::Number(x) => number(x),
            Value::Count(n) => n.to_string(),
            Value::Text(text) => text,
        }
    }

    /// Returns the value as a text; `None` of numbers.
    pub fn as_text(&self) -> Option<&str> {
        match self {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Returns the value as a finite number.
    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Number(x) => Some(*x).filter(|x| x.is_finite()),
            Value::Count(n) => Some(*n as f64),
            Value::Absent | Value::Text(_) => None,
        }
    }
}

/// Declares conversions into a [`Value`].
macro_rules! values {
    ($($from:ty, $x:ident => $value:expr;)+) => {
        $(impl From<$from> for Value {
            fn from($x: $from) -> Self {
                $value
            }
        })+
    };
}

values! {
    f64, x => Value::Number(x);
    u64, n => Value::Count(n);
    u32, n => Value::Count(n.into());
    usize, n => Value::Count(n as u64);
    bool, is => Value::Text(is.to_string());
    String, text => Value::Text(text);
    &str, text => Value::Text(text.into());
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(x: Option<T>) -> Self {
        x.map_or(Value::Absent, Into::into)
    }
}

/// A column: its heading and format where pages show it, and its value in a row.
pub struct Column<'c, R> {
    /// Name of the column in CSV files, with its SI unit at the end.
    pub key: String,
    /// Meaning in words, for the dictionary.
    pub meaning: String,
    /// Heading and format on pages; `None` for a column of the CSV file alone.
    pub shown: Option<(String, Format)>,
    /// Rank among the columns of a page.
    pub rank: Rank,
    /// Value in a row.
    pub value: Box<dyn Fn(&R) -> Value + 'c>,
}

impl<R> Column<'_, R> {
    /// Returns the unit at the end of the key.
    pub fn unit(&self) -> &'static str {
        named_unit(&self.key).1
    }
}

/// The columns of a file.
#[must_use]
pub struct Columns<'c, R> {
    file: String,
    rows: String,
    /// The columns, in the order of the file.
    pub all: Vec<Column<'c, R>>,
}

/// The description of a file in the dictionary.
#[derive(Clone, Debug)]
pub struct FileDescription {
    /// Name of the file, with placeholders in capitals.
    pub file: String,
    /// Sentence on its rows.
    pub rows: String,
    /// Key and meaning of each column.
    pub columns: Vec<(String, String)>,
}

/// Returns the numbers from 1 to `n` as texts.
pub fn up_to(n: usize) -> Vec<String> {
    (1..=n).map(|k| k.to_string()).collect()
}

impl<'c, R: 'c> Columns<'c, R> {
    /// Makes a declaration without columns from the name of the file and a sentence on its rows.
    pub fn of(file: &str, rows: &str) -> Self {
        Self {
            file: file.into(),
            rows: rows.into(),
            all: Vec::new(),
        }
    }

    /// Adds a column.
    pub fn add<T: Into<Value>>(
        mut self,
        key: impl Into<String>,
        meaning: impl Into<String>,
        value: impl Fn(&R) -> T + 'c,
    ) -> Self {
        self.all.push(Column {
            key: key.into(),
            meaning: meaning.into(),
            shown: None,
            rank: Rank::Detail,
            value: Box::new(move |row| value(row).into()),
        });
        self
    }

    /// Adds a column for each of some numbers, which replaces the last `N` of the key.
    pub fn numbered<T: Into<Value>>(
        self,
        numbers: &[String],
        key: &str,
        meaning: &str,
        value: impl Fn(&R, usize) -> T + Copy + 'c,
    ) -> Self {
        let (before, after) = key.rsplit_once('N').unwrap_or((key, ""));
        let numbers = numbers.iter().enumerate();
        numbers.fold(self, |all, (i, n)| {
            all.add(format!("{before}{n}{after}"), meaning, move |row| {
                value(row, i)
            })
        })
    }

    /// Keeps the columns of some keys, in this order.
    pub fn only(mut self, keys: &[&str]) -> Self {
        let place = |c: &Column<'_, R>| keys.iter().position(|key| *key == c.key);
        self.all.retain(|c| place(c).is_some());
        self.all.sort_by_key(place);
        self
    }

    /// Adds the columns of a part of the row; their cells are empty in a row without the part.
    pub fn join<P: 'c>(
        mut self,
        part: Columns<'c, P>,
        of: impl Fn(&R) -> Option<P> + Clone + 'c,
    ) -> Self {
        self.all.extend(part.all.into_iter().map(|c| {
            let of = of.clone();
            Column {
                key: c.key,
                meaning: c.meaning,
                shown: c.shown,
                rank: c.rank,
                value: Box::new(move |row| of(row).map_or(Value::Absent, |p| (c.value)(&p))),
            }
        }));
        self
    }

    /// Adds the column of the model.
    pub fn model(self, value: impl Fn(&R) -> String + 'c) -> Self {
        let meaning = "model, with its distinguishing settings";
        self.add("model", meaning, value)
    }

    /// Adds the column of the integrator.
    pub fn integrator(self, value: impl Fn(&R) -> String + 'c) -> Self {
        self.add("integrator", "integrator with its parameters", value)
    }

    /// Adds the column of the fixed step.
    pub fn step(self, value: impl Fn(&R) -> Option<f64> + 'c) -> Self {
        self.add("step_s", "fixed step", value)
    }

    /// Adds the column of the relative tolerance.
    pub fn rtol(self, value: impl Fn(&R) -> Option<f64> + 'c) -> Self {
        self.add("rtol", "relative tolerance of an adaptive method", value)
    }

    /// Adds the column of the mesh frequency.
    pub fn mesh_frequency(self, value: impl Fn(&R) -> f64 + 'c) -> Self {
        self.add("mesh_frequency_hz", "mesh frequency", value)
    }

    /// Adds the column of the number of modes.
    pub fn modes(self, value: impl Fn(&R) -> Option<usize> + 'c) -> Self {
        let meaning = "greatest number of dynamic modes of a gear";
        self.add("modes", meaning, value)
    }

    /// Adds the column of the status of a run.
    pub fn status(self, value: impl Fn(&R) -> Status + 'c) -> Self {
        let meaning = "end of the run: `converged`, `unchecked`, `inaccurate`, or how it failed";
        self.add("status", meaning, value)
    }

    /// Adds the column of the reference of a comparison.
    pub fn against<T: Into<Value>>(self, value: impl Fn(&R) -> T + 'c) -> Self {
        let meaning =
            "reference of the errors in this row; `self`: the converged solution of the same model";
        self.add("against", meaning, value)
    }

    /// Adds the column of messages.
    pub fn message<T: Into<Value>>(self, value: impl Fn(&R) -> T + 'c) -> Self {
        self.add("message", "reason of a failure, or a note", value)
    }

    /// Shows the last column on pages.
    pub fn shown(mut self, heading: &str, format: Format) -> Self {
        if let Some(column) = self.all.last_mut() {
            column.shown = Some((heading.into(), format));
        }
        self
    }

    /// Ranks the last column as a result of the table on the page.
    pub fn result(mut self) -> Self {
        if let Some(column) = self.all.last_mut() {
            column.rank = Rank::Result;
        }
        self
    }

    /// Returns the CSV file with some rows.
    pub fn table(&self, rows: impl IntoIterator<Item = R>) -> CsvTable {
        let cells = |row: R| self.all.iter().map(|c| (c.value)(&row).csv()).collect();
        CsvTable {
            file: self.file.clone(),
            header: self.all.iter().map(|c| c.key.clone()).collect(),
            rows: rows.into_iter().map(cells).collect(),
        }
    }

    /// Returns the description of the file.
    pub fn described(self) -> FileDescription {
        FileDescription {
            file: self.file,
            rows: self.rows,
            columns: (self.all.into_iter()).map(|c| (c.key, c.meaning)).collect(),
        }
    }
}
