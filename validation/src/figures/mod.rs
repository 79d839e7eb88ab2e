//! Figures of the documents: numbers that the README and the book quote from results.
//!
//! | file | content |
//! |---|---|
//! | `validation/figures.toml` | the commands that measure figures, and where each is in their records or output ([`sources`]) |
//! | `validation/results/figures.json` | the stored values with command, commit, time and processor |
//! | `validation/results/*.csv` | the results of long computations, a line for each case |
//! | `README.md`, `docs/**/*.md` | the figures, each with the name of its stored value in a comment ([`anchors`]), and tables with the name of their file ([`tables`]) |
//!
//! `gearbench-validation figures` measures them again, stores them and writes them into the documents. A test compares the
//! documents with the stored values.

mod anchors;
mod sources;
mod tables;

use anchors::{anchors, with_figures};
use gearbench::experiment::machine;
use serde::{Deserialize, Serialize};
use sources::sources;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use tables::tables;

/// Path of the stored values in the repository.
const STORED: &str = "validation/results/figures.json";

/// The values that one command measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct MeasuredValues {
    command: String,
    commit: String,
    created: String,
    cpu: String,
    values: BTreeMap<String, f64>,
}

/// The stored values of all commands, by the name of their source.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Figures(BTreeMap<String, MeasuredValues>);

/// A figure, or a row of a table, that differs from the stored one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    file: PathBuf,
    line: usize,
    id: String,
    printed: String,
    /// The stored value, rounded as the document prints it, or the row; `None` where nothing is stored.
    stored: Option<String>,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = self.file.display();
        write!(f, "{file}:{}: `{}` is {}", self.line, self.id, self.printed)?;
        match &self.stored {
            Some(x) => write!(f, ", stored is {x}"),
            None => f.write_str(", nothing is stored under this name"),
        }
    }
}

/// The root of the repository from which this program was built.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

impl Figures {
    /// Loads the stored values from the folder of the repository.
    ///
    /// # Errors
    /// The file cannot be read: which, and why.
    pub fn load(root: &Path) -> Result<Figures, String> {
        let path = root.join(STORED);
        let text = std::fs::read_to_string(&path);
        let text = text.map_err(|e| format!("{}: {e}", path.display()))?;
        serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))
    }

    /// Measures the figures of some sources, or of all, and stores them after each source.
    ///
    /// # Errors
    /// An unknown source, a command that fails, a figure that is not in its record or output.
    pub fn measure(
        &mut self,
        root: &Path,
        names: &[String],
        gearbench: &Path,
        print: &dyn Fn(&str),
    ) -> Result<(), String> {
        let all = sources()?;
        if let Some(name) = names.iter().find(|n| all.iter().all(|s| s.name != **n)) {
            let known: Vec<&str> = all.iter().map(|s| s.name.as_str()).collect();
            return Err(format!(
                "no source `{name}`; there are {}",
                known.join(", ")
            ));
        }
        self.0.retain(|name, _| all.iter().any(|s| s.name == *name));
        for source in all
            .iter()
            .filter(|s| names.is_empty() || names.contains(&s.name))
        {
            print(&format!("{}: {}", source.name, source.command));
            let values = source.measure(root, gearbench)?;
            let header = machine::header("", "", "");
            let measured = MeasuredValues {
                command: source.command.clone(),
                commit: header.commit,
                created: header.created,
                cpu: machine::machine().cpu,
                values,
            };
            self.0.insert(source.name.clone(), measured);
            let text = serde_json::to_string_pretty(&self).map_err(|e| e.to_string())?;
            let path = root.join(STORED);
            std::fs::write(&path, text + "\n").map_err(|e| format!("{}: {e}", path.display()))?;
        }
        Ok(())
    }

    /// Returns the value with a name, `source.key`.
    fn get(&self, id: &str) -> Option<f64> {
        let (source, key) = id.split_once('.')?;
        self.0.get(source)?.values.get(key).copied()
    }

    /// Returns the figures and rows of a document that differ from the stored ones.
    ///
    /// # Errors
    /// A comment that names no figure or no table, with its place; a file of a table that cannot be read.
    fn differences(&self, root: &Path, file: &Path, text: &str) -> Result<Vec<Difference>, String> {
        let fail = |e: String| format!("{}, {e}", file.display());
        let found = anchors(text).map_err(fail)?;
        let differs = |a: anchors::Anchor| {
            let stored = self.get(&a.id).map(|x| a.rounded(x));
            (stored.as_ref() != Some(&a.printed)).then_some(Difference {
                file: file.to_path_buf(),
                line: a.line,
                id: a.id,
                printed: a.printed,
                stored,
            })
        };
        let mut all: Vec<Difference> = found.into_iter().filter_map(differs).collect();
        for table in tables(text).map_err(fail)? {
            let stored = table.rows(root).map_err(fail)?;
            let printed: Vec<&str> = text[table.at.clone()].lines().collect();
            for i in 0..stored.len().max(printed.len()) {
                let (printed, stored) = (printed.get(i), stored.get(i));
                if printed.copied() != stored.map(String::as_str) {
                    all.push(Difference {
                        file: file.to_path_buf(),
                        line: table.line + i,
                        id: table.file.clone(),
                        printed: printed.map_or("missing", |row| row).to_owned(),
                        stored: stored.cloned(),
                    });
                }
            }
        }
        Ok(all)
    }

    /// Writes the stored values into all documents and returns the previous differences.
    ///
    /// # Errors
    /// A document that cannot be read or written, or a comment that names no figure or no table.
    pub fn write(&self, root: &Path) -> Result<Vec<Difference>, String> {
        let mut all = Vec::new();
        for (path, text) in documents(root)? {
            let differences = self.differences(root, &path, &text)?;
            if !differences.is_empty() {
                let mut new = with_figures(&text, &anchors(&text)?, |id| self.get(id));
                // From the last table to the first, as rows may become longer.
                for table in tables(&new)?.iter().rev() {
                    let rows = table
                        .rows(root)?
                        .iter()
                        .map(|r| format!("{r}\n"))
                        .collect::<String>();
                    new.replace_range(table.at.clone(), &rows);
                }
                let path = root.join(&path);
                std::fs::write(&path, new).map_err(|e| format!("{}: {e}", path.display()))?;
            }
            all.extend(differences);
        }
        Ok(all)
    }
}

/// Reads the documents that may contain figures, with their paths in the repository.
fn documents(root: &Path) -> Result<Vec<(PathBuf, String)>, String> {
    let mut found = vec![root.join("README.md")];
    let mut folders = vec![root.join("docs")];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder);
        for entry in entries.map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry.map_err(|e| e.to_string())?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path);
        let text = text.map_err(|e| format!("{}: {e}", path.display()))?;
        Ok((path.strip_prefix(root).unwrap_or(&path).to_path_buf(), text))
    };
    found.into_iter().map(read).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::Range;

    #[test]
    fn documents_quote_the_stored_figures() {
        let root = repository();
        let figures = Figures::load(&root).unwrap();
        let mut quoted = Vec::new();
        for (path, text) in documents(&root).unwrap() {
            let differences = figures.differences(&root, &path, &text).unwrap();
            assert!(
                differences.is_empty(),
                "{}\n`cargo run --release -p gearbench-validation -- figures --text` writes the stored figures",
                differences
                    .iter()
                    .map(Difference::to_string)
                    .collect::<Vec<_>>()
                    .join("\n")
            );
            quoted.extend(anchors(&text).unwrap().into_iter().map(|a| a.id));
        }
        for (source, measured) in &figures.0 {
            for key in measured.values.keys() {
                let id = format!("{source}.{key}");
                assert!(quoted.contains(&id), "no document quotes `{id}`");
            }
        }
    }

    /// Returns the text with another digit in a range, in the last place with a digit from 1 to 9, if any.
    fn changed(text: &str, at: Range<usize>) -> String {
        let last = text[at.clone()].rfind(|c: char| matches!(c, '1'..='9'));
        let last = last.or_else(|| text[at.clone()].rfind('0')).unwrap();
        let last = at.start + last;
        let other = if text[last..].starts_with('9') {
            "8"
        } else {
            "9"
        };
        let mut changed = text.to_owned();
        changed.replace_range(last..=last, other);
        changed
    }

    #[test]
    fn a_changed_digit_is_found() {
        let root = repository();
        let figures = Figures::load(&root).unwrap();
        let found = |path: &Path, text: &str| {
            let found = figures.differences(&root, path, text).unwrap();
            assert_eq!(found.len(), 1, "{}: {found:?}", path.display());
            (found[0].id.clone(), found[0].line)
        };
        let mut rows = 0;
        for (path, text) in documents(&root).unwrap() {
            for anchor in anchors(&text).unwrap() {
                let other = changed(&text, anchor.at.clone());
                assert_eq!(found(&path, &other), (anchor.id, anchor.line));
            }
            for table in tables(&text).unwrap() {
                let mut start = table.at.start;
                for (i, row) in text[table.at.clone()].split_inclusive('\n').enumerate() {
                    let other = changed(&text, start..start + row.len());
                    let place = (table.file.clone(), table.line + i);
                    assert_eq!(found(&path, &other), place);
                    let mut without = text.clone();
                    without.replace_range(start..start + row.len(), "");
                    let differences = figures.differences(&root, &path, &without).unwrap();
                    assert!(!differences.is_empty(), "{place:?} may be missing");
                    start += row.len();
                    rows += 1;
                }
            }
        }
        assert!(rows > 0, "no document has a table of a file");
    }

    #[test]
    fn stored_figures_are_those_of_the_sources() {
        let figures = Figures::load(&repository()).unwrap();
        let all = sources().unwrap();
        for source in &all {
            let stored = figures.0.get(&source.name);
            let stored = stored.unwrap_or_else(|| panic!("`{}` is not measured", source.name));
            assert_eq!(stored.command, source.command);
            let keys: Vec<&String> = stored.values.keys().collect();
            assert_eq!(keys, source.figures.keys().collect::<Vec<_>>());
        }
        assert_eq!(figures.0.len(), all.len());
    }
    #[test]
    fn summaries_are_those_of_the_stored_results() {
        let root = repository();
        let figures = Figures::load(&root).unwrap();
        let mut summaries = 0;
        for source in sources().unwrap() {
            let Some(files) = source.command.strip_prefix("gearbench-validation summary ") else {
                continue;
            };
            let files: Vec<PathBuf> = files.split(' ').map(|file| root.join(file)).collect();
            let lines = crate::summary::lines(&files).unwrap();
            let values = source.printed(&lines.join("\n")).unwrap();
            assert_eq!(figures.0[&source.name].values, values, "{}", source.name);
            summaries += 1;
        }
        assert!(summaries > 0, "no figures come from a summary");
    }
}
