//! A set of scenes, gone through by several threads, with a journal: one line per scene as soon as it is judged, so that
//! a check that was stopped goes on where it ended.

use crate::sampling::{Set, draw, full_order};
use crate::validate::{JudgeError, judge};
use gearbench::experiment::machine::COMMIT;
use gearbench_reports::choice_check::JudgedChoice;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// What to check.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The set.
    pub set: Set,
    /// First and last scene.
    pub scenes: [usize; 2],
    /// Scenes that are judged at the same time.
    pub threads: usize,
    /// File that keeps what has been judged; `None` keeps nothing.
    pub journal: Option<PathBuf>,
}

/// First line of a journal: scenes of another set or of another version are not taken over.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Header {
    set: String,
    seed: u64,
    full_order: usize,
    commit: String,
}

impl Header {
    fn of(set: &Set) -> Self {
        Header {
            set: set.name.clone(),
            seed: set.seed,
            full_order: set.full_order,
            commit: COMMIT.into(),
        }
    }

    /// The version has no changes that a commit would not tell.
    fn is_clean(&self) -> bool {
        !self.commit.ends_with('+')
    }
}

/// Lines of a journal of the same set and version; what is broken, as the last line of a killed run, is left out.
fn judged_before(path: &Path, header: &Header) -> Vec<JudgedChoice> {
    let Ok(text) = std::fs::read_to_string(path) else {
        return Vec::new();
    };
    let mut lines = text.lines();
    let first = lines
        .next()
        .and_then(|l| serde_json::from_str::<Header>(l).ok());
    if first.as_ref() != Some(header) || !header.is_clean() {
        return Vec::new();
    }
    lines.filter_map(|l| serde_json::from_str(l).ok()).collect()
}

/// Opens a journal that holds what was judged before and nothing else.
fn open(path: &Path, header: &Header, before: &[JudgedChoice]) -> Result<File, JudgeError> {
    let refuse = |why: String| JudgeError::Journal {
        path: path.display().to_string(),
        why,
    };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|e| refuse(e.to_string()))?;
    }
    let mut text = line(header).map_err(refuse)?;
    for row in before {
        text.push_str(&line(row).map_err(refuse)?);
    }
    std::fs::write(path, text).map_err(|e| refuse(e.to_string()))?;
    (OpenOptions::new().append(true).open(path)).map_err(|e| refuse(e.to_string()))
}

fn line(row: &impl Serialize) -> Result<String, String> {
    let mut text = serde_json::to_string(row).map_err(|e| e.to_string())?;
    text.push('\n');
    Ok(text)
}

/// Judges the scenes of a plan; `progress` is told each as it is done, and how many are.
///
/// # Errors
/// [`JudgeError`]: a drawing that fails, a journal that cannot be written, an interruption. Scenes that cannot be judged
/// are rows.
pub fn check(
    plan: &Plan,
    cancel: Option<&AtomicBool>,
    progress: impl Fn(&JudgedChoice, usize, usize) + Sync,
) -> Result<Vec<JudgedChoice>, JudgeError> {
    let [first, last] = plan.scenes;
    let full = full_order(&plan.set)?;
    let header = Header::of(&plan.set);
    let mut done: BTreeMap<usize, JudgedChoice> = BTreeMap::new();
    let journal = match &plan.journal {
        Some(path) => {
            let before = judged_before(path, &header);
            let file = open(path, &header, &before)?;
            done.extend(before.into_iter().map(|row| (row.number, row)));
            Some(Mutex::new(file))
        }
        None => None,
    };
    let wanted: Vec<usize> = (first..=last).collect();
    let open: Vec<usize> = (wanted.iter().copied())
        .filter(|n| !done.contains_key(n))
        .collect();
    let counter = AtomicUsize::new(wanted.len() - open.len());
    let next = AtomicUsize::new(0);
    let failed: Mutex<Option<JudgeError>> = Mutex::new(None);
    let rows: Mutex<Vec<JudgedChoice>> = Mutex::new(Vec::new());
    let one = |number: usize| -> Result<(), JudgeError> {
        let drawn = draw(&plan.set, number)?;
        let row = judge(&drawn, full.contains(&number), cancel)?;
        if let (Some(file), Some(path)) = (&journal, &plan.journal) {
            let refuse = |why: String| JudgeError::Journal {
                path: path.display().to_string(),
                why,
            };
            let text = line(&row).map_err(refuse)?;
            let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
            (file.write_all(text.as_bytes())).map_err(|e| refuse(e.to_string()))?;
        }
        let so_far = counter.fetch_add(1, Ordering::Relaxed) + 1;
        progress(&row, so_far, wanted.len());
        rows.lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(row);
        Ok(())
    };
    std::thread::scope(|scope| {
        for _ in 0..plan.threads.clamp(1, open.len().max(1)) {
            scope.spawn(|| {
                while let Some(number) = open.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let mut stop = failed.lock().unwrap_or_else(PoisonError::into_inner);
                    if stop.is_some() {
                        return;
                    }
                    drop(stop);
                    if let Err(e) = one(*number) {
                        stop = failed.lock().unwrap_or_else(PoisonError::into_inner);
                        *stop = Some(e);
                        return;
                    }
                }
            });
        }
    });
    if let Some(e) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(e);
    }
    let new = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.extend(new.into_iter().map(|row| (row.number, row)));
    Ok(wanted.iter().filter_map(|n| done.remove(n)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A journal gives back what was judged; a torn last line, another version or another seed do not count.
    #[test]
    fn journals_go_on_where_they_ended() {
        let folder = std::env::temp_dir().join(format!("gearbench-journal-{}", std::process::id()));
        let path = folder.join("journal.jsonl");
        let header = Header {
            set: "tuning".into(),
            seed: 7,
            full_order: 0,
            commit: "abc".into(),
        };
        let row = |number| JudgedChoice {
            number,
            scene: format!("tuning-{number}"),
            error: Some(0.1),
            ..JudgedChoice::default()
        };
        let mut file = open(&path, &header, &[row(2)]).unwrap();
        file.write_all(line(&row(3)).unwrap().as_bytes()).unwrap();
        file.write_all(b"{\"scene\": \"tun").unwrap();
        drop(file);
        assert_eq!(judged_before(&path, &header), [row(2), row(3)]);
        let other = Header {
            seed: 8,
            ..header.clone()
        };
        assert!(judged_before(&path, &other).is_empty());
        let changed = Header {
            commit: "abc+".into(),
            ..header
        };
        open(&path, &changed, &[row(2)]).unwrap();
        assert!(judged_before(&path, &changed).is_empty());
        std::fs::remove_dir_all(folder).unwrap();
    }
}
