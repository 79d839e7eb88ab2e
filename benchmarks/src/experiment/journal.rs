//! The journal of a study, in which every finished piece of work is one line, written to disk before the next piece
//! begins.
//! The first line names the program and the study of the lines: another program may compute other results, and starts
//! over. A line contains the key of a piece, which covers all its inputs ([`Key`](super::key::Key)), its result, and a
//! checksum of both. After a kill or a loss of power the last line may be incomplete, and the next start cuts it off. A
//! damaged line before an intact one is an error, and the journal is not used. Pieces in the journal are not computed
//! again. A line is appended by one write and synced, so that a kill or a loss of power costs no more than the runs in
//! progress. The lock of the folder ensures that one process at a time writes a journal.
//! takes more than the runs under way. One process at a time writes a journal: the lock of the folder sees to that.

use super::machine;
use gearbench_reference::hash::Hash;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Name of the journal in the folder of a study.
pub const JOURNAL: &str = "journal.jsonl";
/// Version of the journal format.
const VERSION: u32 = 3;
/// Largest length of the first line [bytes].
const LONGEST_HEADER: u64 = 1 << 16;
/// First bytes of a journal of any version.
const BEGIN: &[u8] = b"{\"journal\":";

/// Identity of the study of a journal or record; it distinguishes studies that would use the same folder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Subject {
    /// Id of the study.
    pub study: String,
    /// Name of a shipped scene, or path of a scene file.
    pub scene: String,
    /// Labels of the selected models, separated by commas, in alphabetical order; `None` for the models of the scene.
    pub models: Option<String>,
}

/// The first line of a journal: format, program and study.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Header {
    /// Version of the format.
    journal: u32,
    /// Version of the program that wrote the journal.
    program: String,
    /// The study that the pieces belong to.
    #[serde(default)]
    subject: Subject,
}

impl Header {
    fn of(subject: &Subject) -> Self {
        Header {
            journal: VERSION,
            program: format!(
                "gearbench {} {}{}",
                env!("CARGO_PKG_VERSION"),
                machine::commit(),
                build()
            ),
            subject: subject.clone(),
        }
    }
}

/// Time of the build, which distinguishes builds of one commit with uncommitted changes; empty for a clean tree.
fn build() -> String {
    let changed = machine::commit().ends_with('+');
    let built = || std::env::current_exe()?.metadata()?.modified();
    let time = changed.then(built).and_then(Result::ok);
    time.map_or_else(String::new, |t| format!(" {t:?}"))
}

/// A line of the journal: a finished piece of work.
#[derive(Debug, Serialize, Deserialize)]
struct JournalLine<'a> {
    key: String,
    /// Checksum of the key and of the text of the result.
    sum: String,
    #[serde(borrow)]
    result: &'a RawValue,
}

impl<'a> JournalLine<'a> {
    fn new(key: &str, result: &'a RawValue) -> Self {
        JournalLine {
            key: key.to_owned(),
            sum: sum(key, result),
            result,
        }
    }

    /// Reads a line and verifies its checksum.
    fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let line: JournalLine<'_> = serde_json::from_slice(bytes).map_err(|e| e.to_string())?;
        if !bytes.ends_with(b"\n") {
            return Err("its end is missing".into());
        }
        match sum(&line.key, line.result) == line.sum {
            true => Ok(line),
            false => Err("its checksum does not match its key and result".into()),
        }
    }
}

fn sum(key: &str, result: &RawValue) -> String {
    let mut hash = Hash::START;
    hash.text(key);
    hash.text(result.get());
    hash.to_string()
}

/// Place of the line of a finished piece in the file; results are read when they are needed.
#[derive(Clone, Copy, Debug)]
struct LinePosition {
    line: usize,
    offset: u64,
    length: usize,
}

/// Reason why a journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// Path of the journal.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A line before an intact one is damaged.
    #[error(
        "{}:{line}: the line is damaged ({reason}); repeat all runs with --fresh",
        path.display()
    )]
    Damaged {
        /// Path of the journal.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// Why the line cannot be read.
        reason: String,
    },
    /// The path of the journal is occupied by something else.
    #[error(
        "{}: {found} in the place of the journal of the study; name another folder with --out, or remove it",
        path.display()
    )]
    Foreign {
        /// Path where the journal belongs.
        path: PathBuf,
        /// The kind of file found at the path.
        found: &'static str,
    },
    /// The journal contains finished pieces of another study.
    #[error(
        "{}: {pieces} finished pieces of another, interrupted study ({}); name another folder with --out, continue that \
         study, or discard its pieces with --fresh",
        path.display(), of(subject)
    )]
    Other {
        /// Path of the journal.
        path: PathBuf,
        /// Number of finished pieces.
        pieces: usize,
        /// The study that the pieces belong to.
        subject: Subject,
    },
}

/// Describes a study in words.
fn of(subject: &Subject) -> String {
    let models = subject.models.as_ref();
    let models = models.map_or_else(String::new, |m| format!(", models {m}"));
    format!("{} of {}{models}", subject.study, subject.scene)
}

impl From<JournalError> for String {
    fn from(e: JournalError) -> String {
        e.to_string()
    }
}

/// A journal that is open for reading and appending.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    places: HashMap<String, LinePosition>,
    lines: usize,
    length: u64,
}

impl Journal {
    /// Opens the journal of a study at a path and reads its finished pieces; `fresh`, or another program, empties it
    /// first.
    ///
    /// # Errors
    /// [`JournalError`] when the file refuses, is no journal, has pieces of another study, or is damaged before a sound
    /// line.
    pub fn open(path: &Path, subject: &Subject, fresh: bool) -> Result<Self, JournalError> {
        let io = |source| JournalError::Io {
            path: path.to_owned(),
            source,
        };
        let foreign = |found| JournalError::Foreign {
            path: path.to_owned(),
            found,
        };
        match std::fs::symlink_metadata(path) {
            Ok(m) if m.is_symlink() => return Err(foreign("a link")),
            Ok(m) if !m.is_file() => return Err(foreign("not a regular file")),
            _ => {}
        }
        let file = (OpenOptions::new().read(true).append(true).create(true))
            .open(path)
            .map_err(io)?;
        let mut journal = Journal {
            path: path.to_owned(),
            file,
            places: HashMap::new(),
            lines: 1,
            length: 0,
        };
        let mut reader = BufReader::new(journal.file.try_clone().map_err(io)?);
        let mut first = Vec::new();
        (&mut reader)
            .take(LONGEST_HEADER)
            .read_until(b'\n', &mut first)
            .map_err(io)?;
        let header = serde_json::from_slice::<Header>(&first);
        let own = Header::of(subject);
        let whole = header.is_ok() && first.ends_with(b"\n");
        // A first line without its end is that of a program that was killed, or of a loss of power.
        let torn = first.iter().all(|b| *b == 0)
            || BEGIN.starts_with(&first)
            || (first.starts_with(BEGIN) && !first.ends_with(b"\n"));
        match header {
            Ok(found)
                if whole && !fresh && found.program == own.program && found.journal == VERSION =>
            {
                journal.length = first.len() as u64;
                journal.read(&mut reader)?;
                if found.subject != *subject && !journal.is_empty() {
                    return Err(JournalError::Other {
                        path: path.to_owned(),
                        pieces: journal.len(),
                        subject: found.subject,
                    });
                }
                if found.subject == *subject {
                    return Ok(journal);
                }
            }
            Err(_) if !torn => return Err(foreign("a file that is not gearbench's")),
            _ => {}
        }
        (journal.places, journal.lines, journal.length) = (HashMap::new(), 1, 0);
        journal.file.set_len(0).map_err(io)?;
        journal.append(&own)?;
        Ok(journal)
    }

    fn damaged(&self, line: usize, reason: &dyn std::fmt::Display) -> JournalError {
        JournalError::Damaged {
            path: self.path.clone(),
            line,
            reason: reason.to_string(),
        }
    }

    /// Reads the intact lines of a journal behind the first one. An incomplete last line is cut off.
    fn read(&mut self, from: &mut impl BufRead) -> Result<(), JournalError> {
        let mut unsound: Option<(usize, String)> = None;
        let mut bytes = Vec::new();
        for number in 2.. {
            bytes.clear();
            let length = from.read_until(b'\n', &mut bytes).map_err(|e| self.io(e))?;
            if length == 0 {
                break;
            }
            match (JournalLine::read(&bytes), &unsound) {
                (Ok(line), None) => self.add_place(line.key, length),
                (Ok(_), Some((at, reason))) => return Err(self.damaged(*at, reason)),
                (Err(reason), None) => unsound = Some((number, reason)),
                (Err(_), Some(_)) => {}
            }
        }
        match unsound {
            Some(_) => self.file.set_len(self.length).map_err(|e| self.io(e)),
            None => Ok(()),
        }
    }

    /// Registers the line that follows the last known one.
    fn add_place(&mut self, key: String, length: usize) {
        self.lines += 1;
        let place = LinePosition {
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

    /// Appends a line and returns its length. An incomplete line is removed again.
    fn write(&mut self, line: &impl Serialize) -> Result<usize, JournalError> {
        let mut text = serde_json::to_string(line).map_err(|e| self.io(e.into()))?;
        text.push('\n');
        let written = self.file.write_all(text.as_bytes());
        written.and_then(|()| self.file.sync_data()).map_err(|e| {
            let _ = self.file.set_len(self.length);
            self.io(e)
        })?;
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
        let result = serde_json::value::to_raw_value(result).map_err(|e| self.io(e.into()))?;
        let length = self.write(&JournalLine::new(key, &result))?;
        self.add_place(key.to_owned(), length);
        Ok(())
    }

    /// Reads a result by its key.
    ///
    /// # Errors
    /// [`JournalError::Damaged`] when the line is not the one that was read at the start, or its result none of this type,
    /// [`JournalError::Io`] when the file refuses.
    pub fn get<T: DeserializeOwned>(&mut self, key: &str) -> Result<Option<T>, JournalError> {
        let Some(place) = self.places.get(key).copied() else {
            return Ok(None);
        };
        let mut bytes = vec![0; place.length];
        (self.file.seek(SeekFrom::Start(place.offset)))
            .and_then(|_| self.file.read_exact(&mut bytes))
            .map_err(|e| self.io(e))?;
        let read = JournalLine::read(&bytes).and_then(|line| match line.key == key {
            true => serde_json::from_str(line.result.get()).map_err(|e| e.to_string()),
            false => Err("its key belongs to another piece".into()),
        });
        read.map(Some).map_err(|e| self.damaged(place.line, &e))
    }

    /// Number of finished pieces.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// True if the journal has no finished pieces.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    fn open(folder: &TempDir, fresh: bool) -> Result<Journal, JournalError> {
        Journal::open(&folder.path().join(JOURNAL), &Subject::default(), fresh)
    }

    /// A number with 17 significant digits.
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
        // The study continues where the journal was cut.
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

    /// A journal of three pieces as text, with its file.
    fn three(folder: &TempDir) -> (PathBuf, String) {
        let mut journal = open(folder, true).unwrap();
        for (key, x) in [("a", 1.25), ("b", 2.5), ("c", 3.75)] {
            journal.store(key, &x).unwrap();
        }
        drop(journal);
        let file = folder.path().join(JOURNAL);
        let text = std::fs::read_to_string(&file).unwrap();
        (file, text)
    }

    #[test]
    fn a_damaged_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let (file, text) = three(&folder);
        assert!(open(&folder, false).unwrap().get::<String>("b").is_err());
        let lines: Vec<&str> = text.lines().collect();
        let (a, b) = (lines[1], lines[2]);
        // A digit, two keys that are exchanged, a line that is cut, zeros.
        let exchanged = text
            .replace("\"key\":\"a\"", "\"key\":\"x\"")
            .replace("\"key\":\"b\"", "\"key\":\"a\"")
            .replace("\"key\":\"x\"", "\"key\":\"b\"");
        for (changed, line) in [
            (text.replace("1.25", "1.35"), 2),
            (text.replace("2.5}", "2.6}"), 3),
            (exchanged, 2),
            (text.replace(a, &a[..a.len() / 2]), 2),
            (text.replace(b, &"\0".repeat(b.len())), 3),
        ] {
            assert_ne!(changed, text);
            std::fs::write(&file, &changed).unwrap();
            let error = open(&folder, false).unwrap_err().to_string();
            let place = format!(".jsonl:{line}:");
            assert!(
                error.contains(&place) && error.contains("--fresh"),
                "{error}"
            );
            assert_eq!(std::fs::read_to_string(&file).unwrap(), changed);
        }
        assert!(open(&folder, true).unwrap().is_empty());
    }

    /// A loss of power leaves zeros in the place of the last line, with or without a line feed.
    #[test]
    fn a_last_line_of_zeros_or_with_another_digit_is_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let (file, text) = three(&folder);
        let last = text.lines().last().unwrap();
        let sound = &text[..text.len() - last.len() - 1];
        for tail in [
            "\0".repeat(last.len() + 1),
            "\0".repeat(last.len()) + "\n",
            last.replace("3.75", "3.85") + "\n",
        ] {
            std::fs::write(&file, format!("{sound}{tail}")).unwrap();
            let mut journal = open(&folder, false).unwrap();
            assert_eq!(journal.len(), 2);
            assert_eq!(journal.get::<f64>("b").unwrap(), Some(2.5));
            journal.store("c", &3.75).unwrap();
            assert_eq!(journal.get::<f64>("c").unwrap(), Some(3.75));
            assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
        }
    }

    /// A line that was replaced by one of equal length while the journal was open is detected.
    #[test]
    fn a_result_is_that_of_its_key() {
        let folder = tempfile::tempdir().unwrap();
        let (file, text) = three(&folder);
        let mut journal = open(&folder, false).unwrap();
        let mut lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1].len(), lines[3].len());
        lines.swap(1, 3);
        std::fs::write(&file, lines.join("\n") + "\n").unwrap();
        let error = journal.get::<f64>("a").unwrap_err().to_string();
        assert!(error.contains("key belongs to another piece"), "{error}");
    }

    #[test]
    fn what_is_no_journal_or_of_another_study_stays() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(JOURNAL);
        for foreign in [
            "{\"time\": 1}\n{\"time\": 2}\n",
            "notes",
            "{\"journal\": \"mine\"}\n",
        ] {
            std::fs::write(&file, foreign).unwrap();
            for fresh in [false, true] {
                let error = open(&folder, fresh).unwrap_err().to_string();
                assert!(error.contains("not gearbench's"), "{error}");
            }
            assert_eq!(std::fs::read_to_string(&file).unwrap(), foreign);
        }
        let (_, text) = {
            std::fs::remove_file(&file).unwrap();
            three(&folder)
        };
        let other = Subject {
            study: "sweep".into(),
            scene: "s.toml".into(),
            models: Some("rigid".into()),
        };
        let error = Journal::open(&file, &other, false).unwrap_err().to_string();
        assert!(error.contains("3 finished pieces"), "{error}");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
        assert!(Journal::open(&file, &other, true).unwrap().is_empty());
        // One without pieces is nobody's.
        assert!(open(&folder, false).unwrap().is_empty());
        #[cfg(unix)]
        {
            std::fs::rename(&file, folder.path().join("mine")).unwrap();
            std::os::unix::fs::symlink(folder.path().join("mine"), &file).unwrap();
            let error = open(&folder, true).unwrap_err().to_string();
            assert!(error.contains("a link"), "{error}");
        }
    }
}
