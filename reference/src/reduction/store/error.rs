//! Why a stored reduction is refused: file, array, what was expected, what was found, and a way out.

use std::fmt;

/// What kind of trouble a [`StoreError`] reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum StoreErrorKind {
    /// The file cannot be read or written.
    Io,
    /// The file is not a zip archive.
    NotZip,
    /// The archive or an array in it is damaged.
    Damaged,
    /// An array or an entry of `meta` is missing.
    Missing,
    /// An array holds another type of number, or another order of its axes.
    Type,
    /// An array has another shape.
    Shape,
    /// Numbers that cannot be right.
    Value,
    /// The file was written by a newer program.
    Newer,
}

/// A stored reduction was refused. The text reads `file: array: expected ..., found ...; way out`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoreError {
    /// Kind of trouble.
    pub kind: StoreErrorKind,
    /// File, as it was named.
    pub file: Box<str>,
    /// The array in question; may be empty.
    pub array: Box<str>,
    /// What was expected.
    pub expected: Box<str>,
    /// What was found.
    pub found: Box<str>,
    /// What to do about it.
    pub help: Box<str>,
}

/// What to do about a file that no reading can repair.
pub(super) const MAKE_AGAIN: &str = "make it again with `gearbench reduce`";

impl StoreError {
    pub(super) fn new(
        kind: StoreErrorKind,
        array: &str,
        expected: impl Into<String>,
        found: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        StoreError {
            kind,
            file: "".into(),
            array: array.into(),
            expected: expected.into().into(),
            found: found.into().into(),
            help: help.into().into(),
        }
    }

    /// A file that cannot be read or written.
    pub(super) fn io(expected: &str, found: impl Into<String>, help: &str) -> Self {
        StoreError::new(StoreErrorKind::Io, "", expected, found, help)
    }

    /// The same with the file's name.
    pub(super) fn of(mut self, file: &str) -> Self {
        self.file = file.into();
        self
    }
}

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if !self.array.is_empty() {
            write!(f, ": `{}`", self.array)?;
        }
        write!(f, ": expected {}, found {}", self.expected, self.found)?;
        if !self.help.is_empty() {
            write!(f, "; {}", self.help)?;
        }
        Ok(())
    }
}

impl std::error::Error for StoreError {}
