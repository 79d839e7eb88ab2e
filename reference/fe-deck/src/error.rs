//! Why a deck is declined, and the lines that messages name.

use crate::refusal::Refusal;

/// Kind of the problem in a [`DeckError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DeckErrorKind {
    /// A file cannot be read.
    Io,
    /// A line is malformed.
    Syntax,
    /// The deck is well-formed but uses an unsupported feature.
    Unsupported,
    /// Something named is not defined, or defined twice.
    Reference,
    /// A stated limit is passed.
    Limit,
    /// The mesh is not suitable for a gear.
    Gear,
    /// A flank is no grid of faces.
    Grid,
    /// A body or a part of it has no material.
    Material,
}

/// A deck was declined.
pub type DeckError = Refusal<DeckErrorKind>;

/// A line of a deck.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// File, as the deck was named.
    pub file: std::sync::Arc<str>,
    /// Line number, from 1.
    pub line: usize,
}

impl Place {
    /// Returns an error at this line.
    pub fn error(
        &self,
        kind: DeckErrorKind,
        context: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
        help: impl Into<String>,
    ) -> DeckError {
        Refusal::new(kind, context, expected, found, help).at(&self.file, self.line)
    }
}

/// Returns a text of a deck for a message: short, in quotes and without control characters.
pub fn quote(text: &str) -> String {
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
