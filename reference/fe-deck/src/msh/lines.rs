//! Reader of the values of a mesh of Gmsh, text or binary, by one interface.
//!
//! As text a record is a line, and values are its words. Binary, records follow one another without ends, whole numbers
//! have four bytes (tags of nodes and elements and counts of version 4.1 eight), numbers eight, in the order of the number 1
//! that follows the format line. Lines that open and close sections, names and the counts of version 2.2 are text there too.

use crate::error::{DeckError, DeckErrorKind, Place, quote};
use gearbench_solid_fe::Vec3;
use std::sync::Arc;

/// Order of the bytes of a binary mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bytes {
    LowFirst,
    HighFirst,
}

/// The file, and how far it was read.
pub(super) struct Lines<'a> {
    file: Arc<str>,
    all: &'a [u8],
    /// Where the next line or value starts.
    at: usize,
    /// Lines before it; of a binary mesh those before its first binary section.
    line: usize,
    /// Rest of the present line of text.
    words: &'a [u8],
    section: &'static str,
    binary: Option<Bytes>,
    /// Tags of nodes and elements and counts have eight bytes.
    wide: bool,
    /// The values of the section that is being read are binary.
    raw: bool,
}

impl<'a> Lines<'a> {
    pub(super) fn new(file: &str, all: &'a [u8]) -> Self {
        let mark = "\u{feff}".as_bytes();
        Lines {
            file: file.into(),
            at: if all.starts_with(mark) { mark.len() } else { 0 },
            all,
            line: 0,
            words: &[],
            section: "",
            binary: None,
            wide: false,
            raw: false,
        }
    }

    /// The next line that is not blank, trimmed.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            let rest = self.all.get(self.at..).filter(|r| !r.is_empty())?;
            let end = rest.iter().position(|&b| b == b'\n');
            let line = rest[..end.unwrap_or(rest.len())].trim_ascii();
            self.at += end.map_or(rest.len(), |e| e + 1);
            self.line += 1;
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    /// Goes on behind the data of a section that is not read: at the line that closes it.
    pub(super) fn skip_to(&mut self, end: &str) {
        let rest = self.all.get(self.at..).unwrap_or_default();
        let mut lines = rest.split_inclusive(|&b| b == b'\n');
        let mut passed = 0;
        // A closing line starts behind the end of a line, which binary data have too.
        let found = lines.find(|line| {
            let closes = line.trim_ascii() == end.as_bytes();
            if !closes {
                passed += line.len();
                self.line += 1;
            }
            closes
        });
        self.at += if found.is_some() { passed } else { rest.len() };
    }

    /// The line that was read last.
    pub(super) fn place(&self) -> Place {
        Place {
            file: self.file.clone(),
            line: self.line,
        }
    }

    pub(super) fn error(
        &self,
        kind: DeckErrorKind,
        expected: impl Into<String>,
        found: impl Into<String>,
        help: &str,
    ) -> DeckError {
        let context = match self.raw {
            true => format!("{}, byte {}", self.section, self.at),
            false => self.section.to_owned(),
        };
        (self.place()).error(kind, context, expected, found, help)
    }

    fn malformed(&self, expected: &str, found: String) -> DeckError {
        self.error(DeckErrorKind::Syntax, expected, found, "")
    }

    fn cut(&self, expected: &str) -> DeckError {
        let kind = DeckErrorKind::Syntax;
        self.error(kind, expected, "the end of the file", "is the file whole?")
    }

    /// Begins a section, whose values are binary where the mesh is.
    pub(super) fn begin(&mut self, section: &'static str) {
        self.section = section;
        self.raw = self.binary.is_some();
    }

    /// Begins a section of lines.
    pub(super) fn begin_text(&mut self, section: &'static str) {
        self.section = section;
        self.raw = false;
    }

    /// Returns true if the values of this section are binary.
    pub(super) fn is_raw(&self) -> bool {
        self.raw
    }

    /// Switches to binary values; reads the number 1 that determines the order of bytes.
    pub(super) fn turn_binary(&mut self, wide: bool) -> Result<(), DeckError> {
        let one = self.take(4, "the number 1 as four bytes")?;
        self.binary = match one {
            [1, 0, 0, 0] => Some(Bytes::LowFirst),
            [0, 0, 0, 1] => Some(Bytes::HighFirst),
            other => {
                let kind = DeckErrorKind::Syntax;
                let help = "was the binary file transferred as text?";
                let expected = "the number 1 as four bytes";
                return Err(self.error(kind, expected, format!("{other:02x?}"), help));
            }
        };
        self.wide = wide;
        Ok(())
    }

    /// The next record of a section: as text its line.
    pub(super) fn row(&mut self, what: &str) -> Result<(), DeckError> {
        if self.raw {
            return Ok(());
        }
        match self.next() {
            Some(line) if !line.starts_with(b"$") => {
                self.words = line;
                Ok(())
            }
            found => {
                let kind = DeckErrorKind::Syntax;
                let found = found.map_or("the end of the file".to_owned(), shown);
                Err(self.error(kind, what, found, "is the file whole?"))
            }
        }
    }

    /// Returns the next word of a line, empty after the last one.
    fn word(&mut self) -> &'a str {
        let rest = self.words.trim_ascii_start();
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
        self.words = rest;
        std::str::from_utf8(word).unwrap_or("?")
    }

    /// Returns the rest of a line.
    pub(super) fn rest(&mut self) -> String {
        let rest = std::mem::take(&mut self.words).trim_ascii();
        let text = String::from_utf8_lossy(rest);
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], DeckError> {
        let end = self.at.checked_add(count);
        let Some(bytes) = end.and_then(|end| self.all.get(self.at..end)) else {
            return Err(self.cut(what));
        };
        self.at += count;
        Ok(bytes)
    }

    fn bytes<const N: usize>(&mut self, what: &str) -> Result<[u8; N], DeckError> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N, what)?);
        if self.binary == Some(Bytes::HighFirst) {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub(super) fn parsed<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, DeckError> {
        let word = self.word();
        word.parse().map_err(|_| self.malformed(what, quote(word)))
    }

    /// A whole number of four bytes.
    fn int(&mut self, what: &str) -> Result<i32, DeckError> {
        match self.raw {
            true => Ok(i32::from_le_bytes(self.bytes(what)?)),
            false => self.parsed(what),
        }
    }

    /// A whole number of eight bytes in version 4.1, of four in 2.2.
    fn size(&mut self, what: &str) -> Result<u64, DeckError> {
        match (self.raw, self.wide) {
            (true, true) => Ok(u64::from_le_bytes(self.bytes(what)?)),
            (true, false) => {
                let value = self.int(what)?;
                u64::try_from(value).map_err(|_| self.malformed(what, value.to_string()))
            }
            (false, _) => self.parsed(what),
        }
    }

    /// How many of something follow.
    pub(super) fn count(&mut self, what: &str) -> Result<usize, DeckError> {
        let count = self.size(what)?;
        usize::try_from(count).map_err(|_| self.malformed(what, count.to_string()))
    }

    /// The tag of a node or an element: a whole number from 1 on.
    pub(super) fn tag(&mut self, what: &str) -> Result<u32, DeckError> {
        let tag = self.size(what)?;
        let whole = u32::try_from(tag).ok().filter(|t| *t > 0);
        whole.ok_or_else(|| self.malformed(what, tag.to_string()))
    }

    /// A type or a small count that has four bytes in all versions.
    pub(super) fn small(&mut self, what: &str) -> Result<u32, DeckError> {
        let value = self.int(what)?;
        u32::try_from(value).map_err(|_| self.malformed(what, value.to_string()))
    }

    /// A tag of an entity or a group, which may be negative where only its direction counts.
    pub(super) fn signed(&mut self, what: &str) -> Result<u32, DeckError> {
        Ok(self.int(what)?.unsigned_abs())
    }

    pub(super) fn dimension(&mut self) -> Result<usize, DeckError> {
        let what = "a dimension from 0 to 3";
        match self.int(what)? {
            d @ 0..=3 => Ok(d as usize),
            d => Err(self.malformed(what, d.to_string())),
        }
    }

    fn number(&mut self) -> Result<f64, DeckError> {
        let what = "a finite number";
        let x: f64 = match self.raw {
            true => f64::from_le_bytes(self.bytes(what)?),
            false => self.parsed(what)?,
        };
        match x.is_finite() {
            true => Ok(x),
            false => Err(self.malformed(what, x.to_string())),
        }
    }

    pub(super) fn position(&mut self) -> Result<Vec3, DeckError> {
        Ok(Vec3::new(self.number()?, self.number()?, self.number()?))
    }

    /// Skips numbers without meaning here, which a line of text may leave unread.
    pub(super) fn pass_numbers(&mut self, count: usize) -> Result<(), DeckError> {
        let bytes = if self.raw { count.saturating_mul(8) } else { 0 };
        self.take(bytes, "a number").map(|_| ())
    }

    /// Whole numbers of four bytes likewise, behind their count.
    pub(super) fn pass_list(&mut self, what: &str) -> Result<(), DeckError> {
        if self.raw {
            let count = self.count(what)?;
            self.take(count.saturating_mul(4), what)?;
        }
        Ok(())
    }
}

/// A line for a message.
pub(super) fn shown(line: &[u8]) -> String {
    quote(&String::from_utf8_lossy(line))
}
