//! The journal of a study: every finished piece of work is a line of its own, on disk before the next is asked for.
//!
//! The first line says which program the lines belong to: another one may compute otherwise, and starts over. A line has
//! the name of a piece, which tells all that the piece depends on ([`Key`](super::key::Key)), and its result. A program
//! that is killed leaves at worst a last line without its end, which the next one cuts off; what stands in the journal is
//! not computed again. A line is appended by one write and synced, so that neither a kill nor a loss of power takes more
//! than the runs under way.

use super::machine;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Name of the journal in the folder of a study.
pub const JOURNAL: &str = "journal.jsonl";
/// Version of its format.
const VERSION: u32 = 2;

/// First line.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Header {
    /// Version of the format.
    journal: u32,
    /// The program that wrote it.
    program: String,
}

impl Header {
    fn own() -> Self {
        Header {
            journal: VERSION,
            program: format!(
                "gearbench {} {}{}",
                env!("CARGO_PKG_VERSION"),
                machine::COMMIT,
                build()
            ),
        }
    }
}

/// What tells builds of a tree with changes apart, which have one commit: when the program was built.
fn build() -> String {
    let changed = machine::COMMIT.ends_with('+');
    let built = || std::env::current_exe()?.metadata()?.modified();
    let time = changed.then(built).and_then(Result::ok);
    time.map_or_else(String::new, |t| format!(" {t:?}"))
}

/// A finished piece of work.
#[derive(Debug, Serialize)]
struct Line<'a, R> {
    key: &'a str,
    result: &'a R,
}

/// The same as it is read: the result as text.
#[derive(Debug, Deserialize)]
struct ReadLine<'a> {
    key: String,
    #[serde(borrow)]
    result: &'a RawValue,
}

/// Where the line of a finished piece is; results are read from there when they are asked for.
#[derive(Clone, Copy, Debug)]
struct Place {
    line: usize,
    offset: u64,
    length: usize,
}

/// Why a journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The file refuses.
    #[error("{}: {source}", path.display())]
    Io {
        /// The journal.
        path: PathBuf,
        /// Reason.
        source: std::io::Error,
    },
    /// A line that is not the last cannot be read.
    #[error(
        "{}:{line}: the line cannot be read ({reason}); start over with --fresh",
        path.display()
    )]
    Damaged {
        /// The journal.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Reason.
        reason: String,
    },
}

impl From<JournalError> for String {
    fn from(e: JournalError) -> String {
        e.to_string()
    }
}

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    places: HashMap<String, Place>,
    lines: usize,
    length: u64,
}

impl Journal {
    /// Opens the journal at a path, with what it holds already; `fresh` empties it first, and so does another program.
    ///
    /// # Errors
    /// [`JournalError`] when the file refuses, or is damaged before its last line.
    pub fn open(path: &Path, fresh: bool) -> Result<Self, JournalError> {
        let io = |source| JournalError::Io {
            path: path.to_owned(),
            source,
        };
        // A pipe in its place would keep the study waiting for ever.
        match path.metadata() {
            Ok(data) if !data.is_file() => {
                return Err(io(std::io::Error::other(
                    "it is no regular file; remove it",
                )));
            }
            _ => {}
        }
        let mut file = (OpenOptions::new().read(true).append(true).create(true))
            .open(path)
            .map_err(io)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(io)?;
        let ours = |line: &[u8]| {
            serde_json::from_slice::<Header>(line).is_ok_and(|found| found == Header::own())
        };
        let first = bytes.iter().position(|b| *b == b'\n').unwrap_or(0);
        let whole = if fresh || !ours(&bytes[..first]) {
            0
        } else {
            bytes.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1)
        };
        if whole < bytes.len() {
            file.set_len(whole as u64).map_err(io)?;
        }
        let mut journal = Journal {
            path: path.to_owned(),
            file,
            places: HashMap::new(),
            lines: 1,
            length: 0,
        };
        if whole == 0 {
            journal.append(&Header::own())?;
        } else {
            journal.length = first as u64 + 1;
            journal.read(&bytes[first + 1..whole])?;
        }
        Ok(journal)
    }

    fn damaged(&self, line: usize, reason: &dyn std::fmt::Display) -> JournalError {
        JournalError::Damaged {
            path: self.path.clone(),
            line,
            reason: reason.to_string(),
        }
    }

    /// Takes the whole lines of a journal, the first one left out.
    fn read(&mut self, bytes: &[u8]) -> Result<(), JournalError> {
        for line in bytes.split_inclusive(|b| *b == b'\n') {
            let found: ReadLine<'_> =
                serde_json::from_slice(line).map_err(|e| self.damaged(self.lines + 1, &e))?;
            self.keep(found.key, line.len());
        }
        Ok(())
    }

    /// Takes note of the line that follows what is known.
    fn keep(&mut self, key: String, length: usize) {
        self.lines += 1;
        let place = Place {
            line: self.lines,
            offset: self.length,
            length,
        };
        self.length += length as u64;
        self.places.entry(key).or_insert(place);
    }

    fn io(&self, source: std::io::Error) -> JournalError {
        JournalError::Io {
            path: self.path.clone(),
            source,
        }
    }

    /// Appends a line and returns its length.
    fn write(&mut self, line: &impl Serialize) -> Result<usize, JournalError> {
        let io = |source| JournalError::Io {
            path: self.path.clone(),
            source,
        };
        let mut text = serde_json::to_string(line).map_err(|e| io(e.into()))?;
        text.push('\n');
        self.file.write_all(text.as_bytes()).map_err(io)?;
        self.file.sync_data().map_err(io)?;
        Ok(text.len())
    }

    fn append(&mut self, header: &Header) -> Result<(), JournalError> {
        self.length = self.write(header)? as u64;
        Ok(())
    }

    /// Stores the result of a piece of work.
    ///
    /// # Errors
    /// [`JournalError::Io`] when the file refuses.
    pub fn store(&mut self, key: &str, result: &impl Serialize) -> Result<(), JournalError> {
        let length = self.write(&Line { key, result })?;
        self.keep(key.to_owned(), length);
        Ok(())
    }

    /// A result by its name.
    ///
    /// # Errors
    /// [`JournalError::Damaged`] when it is none of this type, [`JournalError::Io`] when the file refuses.
    pub fn get<T: DeserializeOwned>(&mut self, key: &str) -> Result<Option<T>, JournalError> {
        let Some(place) = self.places.get(key).copied() else {
            return Ok(None);
        };
        let mut bytes = vec![0; place.length];
        (self.file.seek(SeekFrom::Start(place.offset)))
            .and_then(|_| self.file.read_exact(&mut bytes))
            .map_err(|e| self.io(e))?;
        let read = serde_json::from_slice::<ReadLine<'_>>(&bytes)
            .and_then(|line| serde_json::from_str(line.result.get()));
        read.map(Some).map_err(|e| self.damaged(place.line, &e))
    }

    /// Number of finished pieces.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether nothing is finished.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    fn open(folder: &TempDir, fresh: bool) -> Result<Journal, JournalError> {
        Journal::open(&folder.path().join(JOURNAL), fresh)
    }

    /// A number that takes all its digits.
    const X: f64 = 0.1 + 0.2;

    #[test]
    fn a_torn_last_line_is_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(JOURNAL);
        let mut journal = open(&folder, false).unwrap();
        journal.store("a", &X).unwrap();
        journal.store("b", &[X, 2.0]).unwrap();
        drop(journal);
        let whole = std::fs::read(&file).unwrap();
        let first = whole.iter().position(|b| *b == b'\n').unwrap() + 1;
        let second = first + whole[first..].iter().position(|b| *b == b'\n').unwrap() + 1;
        // Torn at every byte, also in the header.
        for end in (0..whole.len()).rev() {
            std::fs::write(&file, &whole[..end]).unwrap();
            let mut journal = open(&folder, false).unwrap();
            assert_eq!(journal.len(), usize::from(end >= second));
            let kept = journal.get::<f64>("a").unwrap();
            assert_eq!(kept, (end >= second).then_some(X));
            let left = std::fs::read(&file).unwrap();
            assert!(left.ends_with(b"\n") && whole.starts_with(&left));
        }
        // It goes on where it was cut.
        let mut journal = open(&folder, false).unwrap();
        journal.store("a", &X).unwrap();
        journal.store("b", &[X, 2.0]).unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), whole);
    }

    #[test]
    fn another_program_starts_over() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(JOURNAL);
        open(&folder, false).unwrap().store("a", &X).unwrap();
        assert_eq!(open(&folder, false).unwrap().len(), 1);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.replacen("gearbench ", "gearbench 0.", 1)).unwrap();
        assert!(open(&folder, false).unwrap().is_empty());
        open(&folder, false).unwrap().store("a", &X).unwrap();
        assert!(open(&folder, true).unwrap().is_empty());
    }

    #[test]
    fn a_damaged_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(JOURNAL);
        let mut journal = open(&folder, false).unwrap();
        journal.store("a", &X).unwrap();
        journal.store("b", &X).unwrap();
        assert!(journal.get::<String>("b").is_err());
        drop(journal);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.replacen("\"key\":\"a\"", "\"ke", 1)).unwrap();
        let error = open(&folder, false).unwrap_err().to_string();
        assert!(
            error.contains(".jsonl:2:") && error.contains("--fresh"),
            "{error}"
        );
    }
}
