//! Text of a CSV file: preamble, header line and rows.
//!
//! Encodings are UTF-8 with or without a byte order mark, or Latin-1. Delimiters are commas, semicolons or tabs. Lines
//! that begin with `#` and empty lines are ignored anywhere; spreadsheets write `sep=;` in the first line. Cells may
//! be in double quotes, but not over several lines.

use std::fmt;
use std::ops::Range;

/// Rows that are read at most.
pub(super) const MOST_ROWS: usize = 10_000_000;
/// Columns that are read at most.
const MOST_COLUMNS: usize = 10_000;

/// Delimiter between the cells of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the variants are the signs")]
pub enum Delimiter {
    Comma,
    Semicolon,
    Tab,
}

impl Delimiter {
    pub(super) fn byte(self) -> u8 {
        match self {
            Delimiter::Comma => b',',
            Delimiter::Semicolon => b';',
            Delimiter::Tab => b'\t',
        }
    }

    /// Returns the name of the delimiter.
    pub fn words(self) -> &'static str {
        match self {
            Delimiter::Comma => "comma",
            Delimiter::Semicolon => "semicolon",
            Delimiter::Tab => "tab",
        }
    }
}

/// Refusal of a table: position, expected and actual content, and remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableError {
    /// Line, from 1; 0 where it is about the whole file.
    pub line: u64,
    /// Where in the decoded text.
    pub at: Range<usize>,
    /// The column by number, from 1, and name; empty where it is about a whole line.
    pub column: String,
    /// Expected content.
    pub expected: String,
    /// Actual content.
    pub found: String,
    /// Remedy of the problem.
    pub help: String,
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        if !self.column.is_empty() {
            write!(f, "{}: ", self.column)?;
        }
        write!(f, "expected {}, found {}", self.expected, self.found)
    }
}

impl std::error::Error for TableError {}

/// Shortens text of a file for a message and removes terminal control characters.
pub(super) fn shown(text: &str) -> String {
    let cut: String = text.chars().take(40).collect();
    format!("`{}`", cut.escape_debug())
}

/// The text of a file, and whether it was Latin-1.
///
/// # Errors
/// [`TableError`] of what is no text.
pub fn decode(bytes: &[u8]) -> Result<(String, bool), TableError> {
    let whole = |found: &str, help: &str| TableError {
        line: 0,
        at: 0..0,
        column: String::new(),
        expected: "a table of text".into(),
        found: found.into(),
        help: help.into(),
    };
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(whole("UTF-16", "save it as UTF-8"));
    }
    if bytes.contains(&0) {
        let help = "export the data as CSV: text with a line of names";
        return Err(whole("a binary file", help));
    }
    let bytes = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => (text.to_owned(), false),
        Err(_) => (bytes.iter().map(|&b| char::from(b)).collect(), true),
    })
}

/// A row: its cells, its line, and where it begins.
#[derive(Clone, Debug, Default)]
pub(super) struct Row {
    pub cells: csv::StringRecord,
    pub line: u64,
    pub start: usize,
}

/// The rows of a text, the line of names first.
pub(super) struct Rows<'t> {
    text: &'t str,
    from: usize,
    first_line: u64,
    reader: csv::Reader<&'t [u8]>,
    pub delimiter: Delimiter,
}

/// Lines of a text from a place on, with their beginnings.
fn lines(text: &str, from: usize) -> impl Iterator<Item = (usize, &str)> {
    let mut at = from;
    text[from..].split_inclusive('\n').map(move |line| {
        let start = at;
        at += line.len();
        (start, line)
    })
}

fn passed_over(line: &str) -> bool {
    let line = line.trim();
    line.is_empty() || line.starts_with('#')
}

/// The comments of a text, without their signs.
pub(super) fn comments(text: &str) -> impl Iterator<Item = &str> {
    (text.lines()).filter_map(|l| l.trim().strip_prefix('#').map(str::trim))
}

impl<'t> Rows<'t> {
    /// Splits a text into rows; by default the delimiter is that of the header line.
    pub fn of(text: &'t str, given: Option<Delimiter>) -> Self {
        let mut heads = lines(text, 0).filter(|(_, l)| !passed_over(l));
        let (mut start, mut head) = heads.next().unwrap_or((text.len(), ""));
        let named = head.trim().strip_prefix("sep=").and_then(|s| match s {
            "," => Some(Delimiter::Comma),
            ";" => Some(Delimiter::Semicolon),
            "\\t" | "" => Some(Delimiter::Tab),
            _ => None,
        });
        if named.is_some() {
            (start, head) = heads.next().unwrap_or((text.len(), ""));
        }
        let delimiter = given.or(named).unwrap_or_else(|| {
            if head.contains('\t') {
                Delimiter::Tab
            } else if head.contains(';') {
                Delimiter::Semicolon
            } else {
                Delimiter::Comma
            }
        });
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .delimiter(delimiter.byte())
            .trim(csv::Trim::All)
            .from_reader(&text.as_bytes()[start..]);
        Rows {
            text,
            from: start,
            first_line: text[..start].matches('\n').count() as u64,
            reader,
            delimiter,
        }
    }

    /// The next row that is not empty; false at the end.
    pub fn next(&mut self, row: &mut Row) -> Result<bool, TableError> {
        loop {
            let position = self.reader.position().clone();
            let more = self.reader.read_record(&mut row.cells);
            // The reader's place is that before comments and empty lines.
            let place = (position.byte() as usize).saturating_add(self.from);
            let skipped = (lines(self.text, self.boundary(place)))
                .take_while(|(_, l)| passed_over(l))
                .fold((self.boundary(place), 0), |(at, n), (_, l)| {
                    (at + l.len(), n + 1)
                });
            row.start = skipped.0;
            row.line = position.line() + self.first_line + skipped.1;
            match more {
                Err(e) => return Err(self.error(row, "", "a row of cells", &e.to_string(), "")),
                Ok(false) => return Ok(false),
                Ok(true) => {}
            }
            if row.cells.len() > MOST_COLUMNS {
                let found = format!("{} cells", row.cells.len());
                let expected = format!("at most {MOST_COLUMNS} columns");
                return Err(self.error(
                    row,
                    "",
                    &expected,
                    &found,
                    "keep only the columns that are needed",
                ));
            }
            if row.cells.iter().any(|c| c.contains('\n')) {
                let found = "a cell with several lines";
                let help = "close the double quote, or remove the quotes";
                return Err(self.error(row, "", "cells within one line", found, help));
            }
            if row.cells.iter().any(|c| !c.is_empty()) {
                return Ok(true);
            }
        }
    }

    fn boundary(&self, at: usize) -> usize {
        let mut at = at.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at += 1;
        }
        at
    }

    /// Creates a refusal of a row, or of one of its cells.
    pub fn error(
        &self,
        row: &Row,
        column: &str,
        expected: &str,
        found: &str,
        help: &str,
    ) -> TableError {
        let start = self.boundary(row.start);
        let line = self.text[start..].lines().next().unwrap_or_default();
        TableError {
            line: row.line,
            at: start..start + line.len(),
            column: column.to_owned(),
            expected: expected.to_owned(),
            found: found.to_owned(),
            help: help.to_owned(),
        }
    }

    /// Creates a refusal of a cell, with the position of the cell.
    pub fn error_in(
        &self,
        row: &Row,
        (index, name): (usize, &str),
        expected: &str,
        help: &str,
    ) -> TableError {
        let cell = row.cells.get(index).unwrap_or_default();
        let column = format!("column {} {}", index + 1, shown(name));
        let found = if cell.is_empty() {
            "an empty cell".to_owned()
        } else {
            shown(cell)
        };
        let mut error = self.error(row, &column, expected, &found, help);
        // Quoted delimiters would lead to another place: then the whole line is shown.
        let line = &self.text[error.at.clone()];
        if !line.contains('"') {
            let sign = char::from(self.delimiter.byte());
            let before: usize = line.split(sign).take(index).map(|c| c.len() + 1).sum();
            let length = line.get(before..).and_then(|l| l.split(sign).next());
            if let Some(cell) = length {
                let from = error.at.start + before;
                error.at = from..from + cell.len();
            }
        }
        error
    }
}
