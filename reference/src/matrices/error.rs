//! Why matrices or mode shapes of another program are refused.

use crate::Refusal;

/// Kind of the problem in a [`MatrixError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MatrixErrorKind {
    /// A file cannot be read.
    Io,
    /// A line or an array is malformed.
    Syntax,
    /// A stated limit is passed.
    Limit,
    /// The data do not belong to the mesh.
    Mesh,
    /// The matrices are not those of an unconstrained elastic body.
    Body,
}

/// A file of matrices or mode shapes was refused.
pub type MatrixError = Refusal<MatrixErrorKind>;

/// A refusal of a whole file.
pub(super) fn refused(
    kind: MatrixErrorKind,
    file: &str,
    expected: impl Into<String>,
    found: impl Into<String>,
    help: impl Into<String>,
) -> MatrixError {
    Refusal::new(kind, "", expected, found, help).at(file, 0)
}
