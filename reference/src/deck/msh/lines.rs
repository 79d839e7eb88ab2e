//! Lines of a mesh of Gmsh, and the numbers in them.

use crate::deck::error::{DeckError, DeckErrorKind, Place, quote};
use gearbench_models::Vec3;
use std::str::SplitWhitespace;
use std::sync::Arc;

/// The lines of the file, blank ones left out.
pub(super) struct Lines<'a> {
    file: Arc<str>,
    lines: std::str::Lines<'a>,
    at: usize,
}

/// A line with what is left of it.
pub(super) struct Row<'a> {
    pub(super) place: Place,
    section: &'static str,
    pub(super) words: SplitWhitespace<'a>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(file: &str, text: &'a str) -> Self {
        Lines {
            file: file.into(),
            lines: text.lines(),
            at: 0,
        }
    }

    /// The next line, trimmed.
    pub(super) fn next(&mut self) -> Option<&'a str> {
        loop {
            self.at += 1;
            let line = self.lines.next()?.trim();
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    /// The line that was read last.
    pub(super) fn place(&self) -> Place {
        Place {
            file: self.file.clone(),
            line: self.at,
        }
    }

    /// The next line of a section.
    pub(super) fn row(&mut self, section: &'static str, what: &str) -> Result<Row<'a>, DeckError> {
        match self.next() {
            Some(line) if !line.starts_with('$') => Ok(Row {
                place: self.place(),
                section,
                words: line.split_whitespace(),
            }),
            found => {
                let kind = DeckErrorKind::Syntax;
                let found = found.map_or("the end of the file".to_owned(), quote);
                Err((self.place()).error(kind, section, what, found, "is the file whole?"))
            }
        }
    }
}

impl Row<'_> {
    pub(super) fn error(
        &self,
        kind: DeckErrorKind,
        expected: &str,
        found: String,
        help: &str,
    ) -> DeckError {
        self.place.error(kind, self.section, expected, found, help)
    }

    pub(super) fn parsed<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, DeckError> {
        let word = self.words.next().unwrap_or_default();
        let value = word.parse();
        value.map_err(|_| self.error(DeckErrorKind::Syntax, what, quote(word), ""))
    }

    pub(super) fn count(&mut self, what: &str) -> Result<usize, DeckError> {
        self.parsed(what)
    }

    /// A tag: a whole number from 1 on.
    pub(super) fn tag(&mut self, what: &str) -> Result<u32, DeckError> {
        match self.parsed::<u32>(what)? {
            0 => Err(self.error(DeckErrorKind::Syntax, what, "0".into(), "")),
            tag => Ok(tag),
        }
    }

    /// A tag of an entity or a group, which may be negative where only its direction counts.
    pub(super) fn signed(&mut self, what: &str) -> Result<u32, DeckError> {
        Ok(self.parsed::<i32>(what)?.unsigned_abs())
    }

    pub(super) fn dimension(&mut self) -> Result<usize, DeckError> {
        match self.parsed::<usize>("a dimension from 0 to 3")? {
            d @ 0..=3 => Ok(d),
            d => Err(self.error(
                DeckErrorKind::Syntax,
                "a dimension from 0 to 3",
                d.to_string(),
                "",
            )),
        }
    }

    pub(super) fn position(&mut self) -> Result<Vec3, DeckError> {
        let mut x = Vec3::zeros();
        for k in 0..3 {
            x[k] = self.parsed("a finite number")?;
            if !x[k].is_finite() {
                let found = x[k].to_string();
                return Err(self.error(DeckErrorKind::Syntax, "a finite number", found, ""));
            }
        }
        Ok(x)
    }
}
