//! The command `gearbench rerun RECORD`: repeats a study from its record and compares both records.
//!
//! The command of the record runs with the scene and the calibrations of the record. All that does not depend on the
//! clock or the machine has to come out the same, to the last bit, under the same version of gearbench.

use super::report::check_record;
use crate::cli::command_line::split;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::terminal::{Refusal, absolute};
use crate::context::Context;
use crate::experiment::machine;
use crate::scene_file::source::changed;
use clap::Args;
use gearbench_reports::record::{OF_THE_CLOCK, Results, Source};
use gearbench_reports::{ReportError, load_results};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const EXAMPLES: &str = "\
Examples:
  gearbench rerun out/spur_impact/compare                  writes out/spur_impact/compare/rerun
  gearbench rerun results.json --out again

The command repeats the study of the record, with the scene and the calibrations that the record contains, and
compares the new record with it: all values except times have to be equal, else the exit code is 1. It writes to the
output folder only: options of the study that write a baseline, a calibration or a scene are ignored.";

/// Fields of a record that identify the program that wrote it, apart from those that depend on the clock.
const OF_THE_PROGRAM: [&str; 2] = ["commit", "source"];

/// Arguments of `rerun`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Rerun {
    /// A results.json, or the folder of a study
    #[arg(value_name = "RECORD")]
    pub record: PathBuf,
    /// Folder to write to [default: `rerun` in the folder of the record]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// The study of a record as a command line that repeats it.
pub struct RecordedCommand {
    /// Words of the command line, without the program.
    pub words: Vec<String>,
    /// Folder of the new record.
    pub out: PathBuf,
    /// Scenes and calibrations of the record.
    pub sources: Arc<[Source]>,
    before: Results,
}

fn refuse(e: &ReportError) -> Refusal {
    Refusal::Input(miette::miette!(
        help = "name a results.json, or the folder of a study that has one",
        "{e}"
    ))
}

/// Reads the record and compares the files that its scene names.
///
/// # Errors [`Refusal`] for a record that cannot be made again: of a version that did not keep its scene, or with files
/// that have changed.
pub fn prepare(context: &Context, args: &Rerun) -> Result<RecordedCommand, Refusal> {
    check_record(&args.record)?;
    let before = load_results(&args.record).map_err(|e| refuse(&e))?;
    let shown = args.record.display();
    let (command, commit) = (&before.header.command, &before.header.commit);
    let sources = before.scenes().map(|r| r.header.source.clone());
    let Some(sources) = sources.collect::<Option<Vec<Source>>>() else {
        return Err(Refusal::Input(miette::miette!(
            help = format!("its command was `{command}`"),
            "{shown}: the record does not contain its scene; a version of gearbench without this feature wrote it (commit {commit})"
        )));
    };
    let changed: Vec<String> = sources.iter().flat_map(changed).collect();
    if !changed.is_empty() {
        return Err(Refusal::Input(miette::miette!(
            help = format!("restore these files, or run the command again: `{command}`"),
            "{shown}: these files have changed since the record was written, or are missing: {}",
            changed.join(", ")
        )));
    }
    if before.header.commit != machine::commit() {
        context.messages.warn(&format!(
            "the record was written at commit {}, this program was built at {}: results may differ",
            before.header.commit,
            machine::commit()
        ));
    }
    let folder = match args.record.extension() {
        Some(_) => args.record.parent().unwrap_or(Path::new("")),
        None => &args.record,
    };
    let out = args.out.clone().unwrap_or_else(|| folder.join("rerun"));
    let mut words = split(&before.header.command);
    if words.is_empty() {
        // `gearbench` alone is the default comparison.
        words.push(gearbench_reports::Study::Compare.as_str().into());
    }
    Ok(RecordedCommand {
        words,
        out,
        sources: sources.into(),
        before,
    })
}

impl RecordedCommand {
    /// The command line of the record.
    pub fn command(&self) -> &str {
        &self.before.header.command
    }

    /// Id of the study of the record.
    pub fn study(&self) -> &str {
        self.before.study_name()
    }

    /// True if the command line runs the study of the record: options that all commands have take no values, and the
    /// first other word is the command.
    pub fn names_its_study(&self) -> bool {
        let command = self.words.iter().find(|word| !word.starts_with('-'));
        command.is_some_and(|word| word == self.study())
    }

    /// Compares the new record with the old one.
    ///
    /// # Errors
    /// [`Refusal`] when the new record cannot be read.
    pub fn compare(
        &self,
        context: &Context,
        answer: CommandResult,
    ) -> Result<CommandResult, Refusal> {
        let after = load_results(&self.out).map_err(|e| refuse(&e))?;
        let (mut total, mut differences) = (0, Vec::new());
        let [old, new] =
            [&self.before, &after].map(|r| serde_json::to_value(r).unwrap_or_default());
        differ("", &old, &new, &mut total, &mut differences);
        let record = absolute(self.out.join(gearbench_reports::RECORD));
        let answer = (answer.with("compared", total)).with("differences", &differences);
        if differences.is_empty() {
            context.messages.print_line(&format!(
                "the same: all {total} values of the record except times ({})",
                record.display()
            ));
            return Ok(answer);
        }
        context
            .messages
            .print_line(&format!("{} of {total} values differ:", differences.len()));
        differences
            .iter()
            .take(10)
            .for_each(|d| context.messages.print_line(&format!("  {d}")));
        Ok(answer.ending(Exit::FellShort))
    }
}

/// Counts the values of two trees and lists the differences, except in values that depend on the clock.
fn differ(at: &str, a: &Value, b: &Value, total: &mut usize, found: &mut Vec<String>) {
    match (a, b) {
        (Value::Object(x), Value::Object(y)) => {
            let new = y.keys().filter(|k| !x.contains_key(*k));
            for key in x.keys().chain(new) {
                if (OF_THE_CLOCK.iter().chain(&OF_THE_PROGRAM)).any(|k| k == key) {
                    continue;
                }
                let [x, y] = [x, y].map(|m| m.get(key).unwrap_or(&Value::Null));
                differ(&format!("{at}/{key}"), x, y, total, found);
            }
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            for (i, (x, y)) in x.iter().zip(y).enumerate() {
                differ(&format!("{at}/{i}"), x, y, total, found);
            }
        }
        (a, b) => {
            *total += 1;
            if a != b {
                let short = |v: &Value| v.to_string().chars().take(60).collect::<String>();
                found.push(format!(
                    "{at}: {} in the record, {} now",
                    short(a),
                    short(b)
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn all_but_the_clock_is_compared() {
        let a = json!({ "runs": [{ "wall_s": 1.0, "steps": 3, "x": [1.0, 2.0] }], "commit": "a" });
        let b = json!({ "runs": [{ "wall_s": 2.0, "steps": 4, "x": [1.0, 2.0] }], "commit": "b" });
        let (mut total, mut found) = (0, Vec::new());
        differ("", &a, &b, &mut total, &mut found);
        assert_eq!(
            (total, found),
            (3, vec!["/runs/0/steps: 3 in the record, 4 now".to_owned()])
        );
    }
}
