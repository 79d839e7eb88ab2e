//! Why a deck is declined: where, what was expected, what was found, and a way out.

use std::fmt;

/// What kind of trouble a [`DeckError`] reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DeckErrorKind {
    /// A file cannot be read.
    Io,
    /// A line is malformed.
    Syntax,
    /// The deck is well-formed but uses what is not supported.
    Unsupported,
    /// Something named is not defined, or defined twice.
    Reference,
    /// A stated limit is passed.
    Limit,
    /// The mesh is not what a gear needs.
    Gear,
    /// A flank is no grid of faces.
    Grid,
    /// A body has no material, or a part of one.
    Material,
}

/// A deck was declined. The text reads `file:line: context: expected ..., found ...; way out`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeckError {
    /// Kind of trouble.
    pub kind: DeckErrorKind,
    /// File, as the deck was named.
    pub file: Box<str>,
    /// Line, from 1; 0 when the trouble belongs to no single line.
    pub line: usize,
    /// The keyword line or the set in question; may be empty.
    pub context: Box<str>,
    /// What was expected.
    pub expected: Box<str>,
    /// What was found.
    pub found: Box<str>,
    /// What to do about it; may be empty.
    pub help: Box<str>,
}

impl fmt::Display for DeckError {
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

impl std::error::Error for DeckError {}

/// A line of a deck.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// File, as the deck was named.
    pub file: std::sync::Arc<str>,
    /// Line, from 1.
    pub line: usize,
}

impl Place {
    /// An error at this line.
    pub(crate) fn error(
        &self,
        kind: DeckErrorKind,
        context: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
        help: impl Into<String>,
    ) -> DeckError {
        DeckError {
            kind,
            file: self.file.to_string().into(),
            line: self.line,
            context: context.into().into(),
            expected: expected.into().into(),
            found: found.into().into(),
            help: help.into().into(),
        }
    }
}

/// Text of a deck for a message: short, and without control characters.
pub(crate) fn quote(text: &str) -> String {
    let mut short: String = text
        .chars()
        .take(60)
        .map(|c| if c.is_control() { '?' } else { c })
        .collect();
    if text.chars().nth(60).is_some() {
        short.push_str("...");
    }
    format!("`{short}`")
}
