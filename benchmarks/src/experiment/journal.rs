//! The journal of a study: every finished run is a line of its own, on disk before the next is asked for.
//!
//! The first line says which plan the lines belong to. A program that is killed leaves at worst a last line without
//! its end, which the next one cuts off; what stands in the journal is not computed again. A line is appended by one
//! write and synced, so that neither a kill nor a loss of power takes more than the runs under way.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Name of the journal in the folder of a study.
pub const JOURNAL: &str = "journal.jsonl";
/// Version of its format.
const VERSION: u32 = 1;

/// First line.
#[derive(Debug, Serialize, Deserialize)]
struct Header {
    /// Version of the format.
    #[serde(alias = "stability_journal")]
    journal: u32,
    /// What the plan consists of.
    plan: Vec<(String, String)>,
}

/// A finished run, or whatever else a line holds.
pub trait Finished: Serialize + DeserializeOwned {
    /// Which run of the plan.
    fn key(&self) -> String;
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
    /// It belongs to another plan.
    #[error(
        "{}: the folder holds the journal of another plan: {what}; write to another folder with --out, or start over with --fresh",
        path.display()
    )]
    OtherPlan {
        /// The journal.
        path: PathBuf,
        /// The first difference.
        what: String,
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

/// An open journal.
#[derive(Debug)]
pub struct Journal<L> {
    path: PathBuf,
    file: File,
    lines: HashMap<String, L>,
}

impl<L: Finished> Journal<L> {
    /// Opens the journal at a path for a plan, with what it holds already; `fresh` empties it first.
    ///
    /// # Errors
    /// [`JournalError`] when it belongs to another plan or is damaged before its last line.
    pub fn open(path: &Path, plan: &[(String, String)], fresh: bool) -> Result<Self, JournalError> {
        let io = |source| JournalError::Io {
            path: path.to_owned(),
            source,
        };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(io)?;
        }
        let mut file = OpenOptions::new()
            .read(true)
            .append(true)
            .create(true)
            .open(path)
            .map_err(io)?;
        if fresh {
            file.set_len(0).map_err(io)?;
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(io)?;
        let whole = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
        if whole < bytes.len() {
            file.set_len(whole as u64).map_err(io)?;
        }
        let mut journal = Journal {
            path: path.to_owned(),
            file,
            lines: HashMap::new(),
        };
        if whole == 0 {
            journal.append(&Header {
                journal: VERSION,
                plan: plan.to_vec(),
            })?;
            return Ok(journal);
        }
        journal.read(&bytes[..whole], plan)?;
        Ok(journal)
    }

    /// Takes the whole lines of a journal.
    fn read(&mut self, bytes: &[u8], plan: &[(String, String)]) -> Result<(), JournalError> {
        let damaged = |line: usize, reason: String| JournalError::Damaged {
            path: self.path.clone(),
            line: line + 1,
            reason,
        };
        let text = std::str::from_utf8(bytes).map_err(|e| damaged(0, e.to_string()))?;
        for (i, line) in text.lines().enumerate() {
            if i == 0 {
                let header: Header =
                    serde_json::from_str(line).map_err(|e| damaged(0, e.to_string()))?;
                if let Some(what) = difference(&header, plan) {
                    return Err(JournalError::OtherPlan {
                        path: self.path.clone(),
                        what,
                    });
                }
                continue;
            }
            let line: L = serde_json::from_str(line).map_err(|e| damaged(i, e.to_string()))?;
            self.lines.entry(line.key()).or_insert(line);
        }
        Ok(())
    }

    fn append(&mut self, line: &impl Serialize) -> Result<String, JournalError> {
        let io = |source| JournalError::Io {
            path: self.path.clone(),
            source,
        };
        let mut text = serde_json::to_string(line).map_err(|e| io(e.into()))?;
        text.push('\n');
        self.file.write_all(text.as_bytes()).map_err(io)?;
        self.file.sync_data().map_err(io)?;
        Ok(text)
    }

    /// Stores a finished run. What is kept is what the file says, so that a map that was resumed holds the same
    /// numbers to the last bit.
    pub fn store(&mut self, line: &L) -> Result<(), JournalError> {
        let text = self.append(line)?;
        let kept: L = serde_json::from_str(&text).map_err(|e| JournalError::Damaged {
            path: self.path.clone(),
            line: self.lines.len() + 2,
            reason: e.to_string(),
        })?;
        self.lines.entry(kept.key()).or_insert(kept);
        Ok(())
    }

    /// A finished run by its name.
    pub fn get(&self, key: &str) -> Option<&L> {
        self.lines.get(key)
    }

    /// Number of finished runs.
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// Whether nothing is finished.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }
}

/// The first difference between the plan of a journal and another.
fn difference(header: &Header, plan: &[(String, String)]) -> Option<String> {
    if header.journal != VERSION {
        return Some(format!(
            "its format is {}, this program writes {VERSION}",
            header.journal
        ));
    }
    let short = |text: &str| match text.char_indices().nth(120) {
        Some((at, _)) => format!("{} ...", &text[..at]),
        None => text.to_owned(),
    };
    for (i, (name, value)) in plan.iter().enumerate() {
        match header.plan.get(i) {
            Some((n, v)) if n == name && v == value => {}
            Some((n, v)) if n == name => {
                return Some(format!(
                    "{name} is `{}` there and `{}` here",
                    short(v),
                    short(value)
                ));
            }
            Some((n, _)) => return Some(format!("it has `{n}` where this one has `{name}`")),
            None => return Some(format!("it has no `{name}`")),
        }
    }
    (header.plan.get(plan.len())).map(|(n, _)| format!("it has `{n}` as well"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    fn plan(step: &str) -> Vec<(String, String)> {
        vec![
            ("scene".into(), "test".into()),
            ("steps".into(), step.into()),
        ]
    }

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Line {
        key: String,
        x: f64,
    }

    impl Finished for Line {
        fn key(&self) -> String {
            self.key.clone()
        }
    }

    fn line(key: &str) -> Line {
        Line {
            key: key.into(),
            x: 0.1 + 0.2,
        }
    }

    /// Opens the journal of a folder for the plan with some steps.
    fn open(folder: &TempDir, step: &str, fresh: bool) -> Result<Journal<Line>, JournalError> {
        Journal::open(&folder.path().join(JOURNAL), &plan(step), fresh)
    }

    #[test]
    fn a_torn_last_line_is_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(JOURNAL);
        let mut journal = open(&folder, "a", false).unwrap();
        journal.store(&line("m0/c0")).unwrap();
        let kept = journal.get("m0/c0").unwrap().clone();
        journal.store(&line("m0/c1")).unwrap();
        drop(journal);
        let whole = std::fs::read(&file).unwrap();
        let first = whole.iter().position(|b| *b == b'\n').unwrap() + 1;
        let second = first + whole[first..].iter().position(|b| *b == b'\n').unwrap() + 1;
        // Torn at every byte, also in the header.
        for end in (0..whole.len()).rev() {
            std::fs::write(&file, &whole[..end]).unwrap();
            let journal = open(&folder, "a", false).unwrap();
            assert_eq!(journal.len(), usize::from(end >= second));
            if end >= second {
                assert_eq!(journal.get("m0/c0"), Some(&kept));
            }
            let left = std::fs::read(&file).unwrap();
            assert!(left.ends_with(b"\n") && whole.starts_with(&left));
        }
        // It goes on where it was cut.
        let mut journal = open(&folder, "a", false).unwrap();
        for key in ["m0/c0", "m0/c1"] {
            journal.store(&line(key)).unwrap();
        }
        assert_eq!(std::fs::read(&file).unwrap(), whole);
    }

    #[test]
    fn another_plan_is_refused_with_a_way_out() {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = open(&folder, "1e-7", false).unwrap();
        journal.store(&line("m0/c0")).unwrap();
        drop(journal);
        let text = open(&folder, "2e-7", false).unwrap_err().to_string();
        for word in ["steps is `1e-7` there and `2e-7` here", "--fresh", "--out"] {
            assert!(text.contains(word), "{text}");
        }
        let longer = [plan("1e-7"), plan("1e-7")].concat();
        let file = folder.path().join(JOURNAL);
        assert!(Journal::<Line>::open(&file, &longer, false).is_err());
        assert!(open(&folder, "2e-7", true).unwrap().is_empty());
        assert!(open(&folder, "2e-7", false).is_ok());
    }

    #[test]
    fn a_damaged_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(JOURNAL);
        let mut journal = open(&folder, "a", false).unwrap();
        journal.store(&line("m0/c0")).unwrap();
        journal.store(&line("m0/c1")).unwrap();
        drop(journal);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.replacen("\"key\":\"m0/c0\"", "\"ke", 1)).unwrap();
        let error = open(&folder, "a", false).unwrap_err();
        assert!(error.to_string().contains(".jsonl:2:"), "{error}");
    }
}
