//! The result of a command: its exit code and, for programs, one JSON object (`--json`).
//!
//! An object has the keys `command`, `exit` (code and meaning) and `warnings`. A study adds the `results` of its record
//! without histories, under the keys of `results.json`, and the paths of `record` and `report`; other commands add keys
//! of their own. After bad input or a failed run the object is written to standard error, with `error` (message, file,
//! line, help).

use super::exit::Exit;
use gearbench_reports::record::Results;
use miette::{Diagnostic, Report};
use serde::Serialize;
use serde_json::{Map, Value, json};

/// Keys of a record that the JSON object leaves out: histories, which are in the record or in its files.
const LONG: [&str; 4] = ["series", "further", "histories", "contacts"];

/// The result of a command: exit code and the keys of its JSON object.
#[derive(Clone, Debug)]
pub struct CommandResult {
    /// How the command ended.
    pub exit: Exit,
    /// The record of a study with its histories, where the context has it [returned](crate::context::RecordUse).
    pub record: Option<Box<Results>>,
    found: Map<String, Value>,
}

impl CommandResult {
    /// A successful result without keys of its own.
    pub fn done() -> Self {
        CommandResult {
            exit: Exit::Done,
            record: None,
            found: Map::new(),
        }
    }

    /// The result of a study whose record is returned.
    pub fn returning(results: Results) -> Self {
        CommandResult {
            record: Some(Box::new(results)),
            ..CommandResult::done()
        }
    }

    /// A key of the JSON object.
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.found.get(key)
    }

    /// The keys of the JSON object of a command besides those of all commands.
    pub fn keys(&self) -> &Map<String, Value> {
        &self.found
    }

    /// The result of a study: key `results` with the record, histories removed.
    pub fn of(results: &Results) -> Self {
        let mut whole = value(results);
        without_histories(&mut whole);
        CommandResult::done().with("results", whole)
    }

    /// Replaces the exit code.
    #[must_use]
    pub fn ending(self, exit: Exit) -> Self {
        CommandResult { exit, ..self }
    }

    /// Adds a key to the JSON object; a number that is not finite becomes `null`.
    #[must_use]
    pub fn with(mut self, key: &str, found: impl Serialize) -> Self {
        self.found.insert(key.to_owned(), value(found));
        self
    }

    /// The JSON object of a successful command.
    pub(super) fn json(self, command: &str, warnings: Vec<String>) -> Value {
        let mut all = head(command, self.exit, warnings);
        all.extend(self.found);
        Value::Object(all)
    }
}

/// The JSON object of a command that was refused or failed.
pub(super) fn refusal(command: &str, exit: Exit, report: &Report, warnings: Vec<String>) -> Value {
    let mut error = Map::new();
    error.insert("message".into(), report.to_string().into());
    if let Some((file, line)) = place(report.as_ref()) {
        error.insert("file".into(), file.into());
        error.insert("line".into(), line.into());
    }
    if let Some(help) = report.help() {
        error.insert("help".into(), help.to_string().into());
    }
    let mut all = head(command, exit, warnings);
    all.insert("error".into(), error.into());
    Value::Object(all)
}

fn head(command: &str, exit: Exit, warnings: Vec<String>) -> Map<String, Value> {
    let mut all = Map::new();
    all.insert("command".into(), command.into());
    let exit = json!({ "code": exit.code(), "meaning": exit.meaning() });
    all.insert("exit".into(), exit);
    all.insert("warnings".into(), warnings.into());
    all
}

/// File and line (from 1) of the first label of an error.
fn place(of: &dyn Diagnostic) -> Option<(String, usize)> {
    let label = of.labels()?.next()?;
    let source = of.source_code()?.read_span(label.inner(), 0, 0).ok()?;
    Some((source.name()?.to_owned(), source.line() + 1))
}

/// Converts data of the program to JSON, which cannot fail for its types.
fn value(of: impl Serialize) -> Value {
    serde_json::to_value(of).unwrap_or(Value::Null)
}

/// Removes the histories from an object and from all objects within it.
fn without_histories(value: &mut Value) {
    match value {
        Value::Object(map) => {
            LONG.iter().for_each(|key| {
                map.remove(*key);
            });
            map.values_mut().for_each(without_histories);
        }
        Value::Array(all) => all.iter_mut().for_each(without_histories),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_reports::record::{ReferenceSeries, Run};
    use gearbench_reports::{ContactSnapshot, Histories, TimeSeries};

    /// The JSON object of a study stays small, however long the histories are.
    #[test]
    fn an_answer_has_no_histories() {
        let mut series = TimeSeries::named(["contact_force_a_b_n"]);
        (0..1000).for_each(|i| series.push(f64::from(i), &[1.0]));
        let results = Results {
            runs: vec![Run {
                steps: 7,
                series: Some(series.clone()),
                histories: Some(Histories {
                    series: Some(series.clone()),
                    ..Histories::default()
                }),
                contacts: Some(ContactSnapshot::default()),
                ..Run::default()
            }],
            references: vec![ReferenceSeries {
                id: "fe".into(),
                further: vec![series.clone()],
                series,
                ..ReferenceSeries::default()
            }],
            ..Results::default()
        };
        let text = CommandResult::of(&results)
            .json("compare", Vec::new())
            .to_string();
        assert!(text.len() < 3000, "{} characters: {text}", text.len());
        assert!(text.contains("\"steps\":7") && text.contains("\"id\":\"fe\""));
        for key in LONG {
            assert!(!text.contains(&format!("\"{key}\"")), "{key}");
        }
    }
}
