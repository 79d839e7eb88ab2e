//! Refusal of a file: position, expected and actual content, and remedy.

use std::fmt;

/// A refused file. The text reads `file:line: context: expected ..., found ...; way out`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal<K> {
    /// Kind of the problem.
    pub kind: K,
    /// File, as it was named.
    pub file: Box<str>,
    /// Line, from 1; 0 when the trouble belongs to no single line.
    pub line: usize,
    /// The keyword line, the set or the array in question; may be empty.
    pub context: Box<str>,
    /// Expected content.
    pub expected: Box<str>,
    /// Actual content.
    pub found: Box<str>,
    /// Remedy; may be empty.
    pub help: Box<str>,
}

impl<K> Refusal<K> {
    /// Creates a refusal without file and line.
    pub fn new(
        kind: K,
        context: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Refusal {
            kind,
            file: "".into(),
            line: 0,
            context: context.into().into(),
            expected: expected.into().into(),
            found: found.into().into(),
            help: help.into().into(),
        }
    }

    /// Adds the name of the file and the line.
    #[must_use]
    pub fn at(mut self, file: &str, line: usize) -> Self {
        (self.file, self.line) = (file.into(), line);
        self
    }
}

impl<K> fmt::Display for Refusal<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        if !self.context.is_empty() {
            write!(f, ": {}", self.context)?;
        }
        write!(f, ": expected {}, found {}", self.expected, self.found)?;
        if !self.help.is_empty() {
            write!(f, "; {}", self.help)?;
        }
        Ok(())
    }
}

impl<K: fmt::Debug> std::error::Error for Refusal<K> {}
