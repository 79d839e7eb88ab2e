//! Why a stored reduction is refused.

use crate::Refusal;

/// Kind of the problem in a [`StoreError`].
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
    /// An array has another type of number, or another order of its axes.
    Type,
    /// An array has another shape.
    Shape,
    /// Numbers that cannot be right.
    Value,
    /// The file was written by a newer program.
    Newer,
}

/// A stored reduction was refused; the context is the array in question.
pub type StoreError = Refusal<StoreErrorKind>;

/// Remedy for a file that cannot be read.
pub(super) const MAKE_AGAIN: &str = "make it again with `gearbench reduce`";

/// A refusal of an array (or of no array in particular), with a way out.
pub(super) fn refused(
    kind: StoreErrorKind,
    array: &str,
    expected: impl Into<String>,
    found: impl Into<String>,
    help: impl Into<String>,
) -> StoreError {
    let context = match array.is_empty() {
        true => String::new(),
        false => format!("`{array}`"),
    };
    Refusal::new(kind, context, expected, found, help)
}

/// A file that cannot be read or written.
pub(super) fn unusable_file(file: &str, expected: &str, found: String, help: &str) -> StoreError {
    refused(StoreErrorKind::Io, "", expected, found, help).at(file, 0)
}

/// A refusal that only another file helps against.
pub(super) fn unusable(
    kind: StoreErrorKind,
    array: &str,
    expected: impl Into<String>,
    found: impl Into<String>,
) -> StoreError {
    refused(kind, array, expected, found, MAKE_AGAIN)
}

/// The refusal of a value.
pub(super) fn value(
    array: &str,
    expected: impl Into<String>,
    found: impl Into<String>,
) -> StoreError {
    unusable(StoreErrorKind::Value, array, expected, found)
}
