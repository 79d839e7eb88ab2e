//! The output folder of a study: locked and tested before the first run, with a journal of finished pieces, and finally
//! with the record.
//!
//! A program that has the record [returned](RecordUse::Returned) and names no folder gives the study one of its own,
//! without journal and record, which ends with the study.
//!
//! A folder belongs to one study of one scene with one choice of models. The same command works there again and again,
//! also after the scene was edited. Another one is refused before it computes anything, unless it comes with `--force`.

use super::arguments::Output;
use super::command_result::CommandResult;
use super::exit::Exit;
use super::files::{folder_of, is_same};
use super::folder_lock::FolderLock;
use super::measured;
use super::progress::Display;
use super::terminal::{Refusal, absolute};
use crate::context::{Context, RecordUse};
use crate::experiment::budget::Budget;
use crate::experiment::conditions::Progress;
use crate::experiment::configuration::refused;
use crate::experiment::journal::{JOURNAL, Journal, JournalError, Subject};
use crate::experiment::runner::Runner;
use crate::messages::Messages;
use crate::scene_file::SceneFile;
use gearbench_reports::RECORD;
use gearbench_reports::measured::MeasuredCurve;
use gearbench_reports::record::{
    Part, Results, Run, SCHEMA, Source, Status, StudyHeader, damping_differs,
};
use serde::Deserialize;
use std::io;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Name of the setting that marks an incomplete study.
const INTERRUPTED_STUDY: &str = "interrupted";
/// Files that identify the folder of a study.
const OWN: [&str; 2] = [RECORD, JOURNAL];
/// Extensions of files that a study writes.
const ENDINGS: [&str; 3] = ["csv", "svg", "html"];

/// Name of the setting that lists models that cannot run, with reasons.
const REFUSED_MODEL: &str = "refused";

/// The output folder of a study while the study runs.
pub struct StudyFolder {
    context: Context,
    path: PathBuf,
    journal: Option<Journal>,
    /// The outermost folder that was created for this study.
    made: Option<PathBuf>,
    /// The scene, calibrations and input files that the record will contain.
    source: Option<Source>,
    /// Measured curves that the tables are compared with.
    measured: Vec<MeasuredCurve>,
    /// Rows of models that cannot run the scene.
    refused: Vec<Run>,
    /// True if the journal in the folder belongs to this study.
    has_journal: bool,
    /// The lock of the folder, held until the study ends.
    lock: Option<FolderLock>,
    /// The folder itself, if it ends with the study; the lock ends before.
    temporary: Option<TempDir>,
}

impl From<JournalError> for Refusal {
    fn from(e: JournalError) -> Self {
        Refusal::Files(e.to_string())
    }
}

impl StudyFolder {
    /// Opens the folder of a study: checks that it is writable and belongs to this study, loads the journal of an
    /// interrupted start, and defers signals from here on.
    ///
    /// # Errors
    /// [`Refusal::Files`] when the folder, or the journal in it, cannot be written; [`Refusal::Input`] when another process
    /// works there, or when it holds the results of another study.
    pub fn open(
        context: &Context,
        output: &Output,
        scene: &str,
        study: &str,
    ) -> Result<Self, Refusal> {
        Self::begin(context, output, (scene, study), None, &[])
    }

    /// Opens the folder of a study of a scene, which becomes part of the record.
    ///
    /// # Errors
    /// As [`StudyFolder::open`], and [`Refusal::Input`] when files that the scene reads are among the results.
    pub fn of(output: &Output, scene: &SceneFile, study: &str) -> Result<Self, Refusal> {
        let (source, inputs) = (Some(scene.source()), scene.inputs());
        let mut folder = Self::begin(
            &scene.context,
            output,
            (&scene.name, study),
            source,
            &inputs,
        )?;
        let rows = scene.refused.iter();
        folder.refused = rows
            .map(|r| refused(&r.label, &r.model, r.error.to_text()))
            .collect();
        Ok(folder)
    }

    /// Opens the folder of a study that is put together from records with this header.
    ///
    /// # Errors
    /// As [`StudyFolder::open`].
    pub fn joining(
        context: &Context,
        output: &Output,
        header: &StudyHeader,
        study: &str,
    ) -> Result<Self, Refusal> {
        Self::begin(
            context,
            output,
            (&header.scene, study),
            header.source.clone(),
            &[],
        )
    }

    fn begin(
        context: &Context,
        output: &Output,
        (name, study): (&str, &str),
        source: Option<Source>,
        inputs: &[PathBuf],
    ) -> Result<Self, Refusal> {
        let measured = output.measured.iter().map(|p| measured::read(p));
        let measured: Vec<Vec<MeasuredCurve>> = measured.collect::<Result<_, _>>()?;
        let is_temporary = output.out.is_none() && context.record == RecordUse::Returned;
        let temporary = is_temporary
            .then(|| tempfile::Builder::new().prefix("gearbench-").tempdir())
            .transpose()
            .map_err(|e| Refusal::Files(format!("no folder for temporary files: {e}")))?;
        let path = match (&output.out, &temporary) {
            (Some(path), _) => path.clone(),
            (None, Some(folder)) => folder.path().to_owned(),
            (None, None) => Path::new("out").join(name).join(study),
        };
        let fail = |e: io::Error| Refusal::Files(format!("{}: {e}", path.display()));
        let subject = Subject {
            study: study.to_owned(),
            scene: source.as_ref().map_or(name, |s| &s.name).to_owned(),
            models: output.models.as_deref().map(in_order),
        };
        let made = path.ancestors().take_while(|p| !p.exists()).last();
        let made = made.map(Path::to_owned);
        std::fs::create_dir_all(&path).map_err(fail)?;
        let mut folder = StudyFolder {
            context: context.clone(),
            journal: None,
            has_journal: false,
            lock: Some(FolderLock::take(&context.messages, &path)?),
            path: path.clone(),
            made,
            source,
            measured: measured.concat(),
            refused: Vec::new(),
            temporary,
        };
        if is_temporary {
            context.interruption.defer();
            return Ok(folder);
        }
        remove_staging(&path);
        for input in inputs.iter().chain(&output.measured) {
            refuse_input(&path, input)?;
        }
        if !output.force {
            belongs_to(&path, (name, &subject), folder.source.as_ref())?;
        }
        let journal = path.join(JOURNAL);
        folder.journal = Some(match Journal::open(&journal, &subject, output.fresh) {
            Err(JournalError::Other { .. }) if output.force => {
                Journal::open(&journal, &subject, true)?
            }
            opened => opened?,
        });
        folder.has_journal = true;
        context.interruption.defer();
        Ok(folder)
    }

    /// Adds a row for a model that failed to assemble during the study and has no row among the results.
    pub fn add_refused(&mut self, row: Run) {
        self.refused.push(row);
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Runs a study of `length` runs with a display of its progress; 0 if the number is unknown.
    pub fn run<T>(&mut self, length: usize, study: impl FnOnce(&Runner<'_>) -> T) -> T {
        let display = Display::of(&self.context, length);
        let progress = |done, total, what: &str| display.report_progress(done, total, what);
        study(&self.runner(&progress))
    }

    /// Runs a study of `length` runs within a budget of processor time.
    pub fn run_within<T>(
        &mut self,
        budget: Budget,
        length: usize,
        study: impl FnOnce(&Runner<'_>) -> T,
    ) -> T {
        let display = Display::of(&self.context, length);
        let progress = |done, total, what: &str| display.report_progress(done, total, what);
        study(&self.runner(&progress).within(budget))
    }

    /// Creates the runner of the pieces of the study. The first call hands the journal over to it.
    pub fn runner<'a>(&mut self, progress: Progress<'a>) -> Runner<'a> {
        match self.journal.take() {
            None if self.temporary.is_some() => {
                Runner::of(self.context.clone()).reporting(progress)
            }
            Some(journal) => {
                let runner = Runner::new(self.context.clone(), journal, progress);
                runner.announcing(&|context, pieces| {
                    context.messages.print_line(&format!(
                        "continuing after {pieces} finished pieces of an interrupted study (--fresh repeats all)"
                    ));
                })
            }
            None => Runner::of(self.context.clone()),
        }
    }

    /// The refusal for a study that was interrupted before there was a result; finished pieces are kept for the next
    /// start.
    pub fn interrupted(&self) -> Refusal {
        let pieces = pieces(&self.path.join(JOURNAL));
        if pieces > 0 {
            self.context.messages.print_line(&format!(
                "interrupted: {pieces} finished pieces are stored; the same command continues the study"
            ));
        }
        Refusal::Interrupted
    }

    /// Writes the record with its report, prints its summary and the paths of the files, and returns the result of the
    /// command. Runs that an interruption prevented are left out, and the journal stays for the next start.
    ///
    /// # Errors
    /// [`Refusal::Files`] when a file cannot be written, [`Refusal::Interrupted`] when there is nothing to report.
    pub fn finish(
        &self,
        mut results: Results,
        exit: impl FnOnce(&Results) -> Exit,
        summarise: impl FnOnce(&Messages, &Results),
    ) -> Result<CommandResult, Refusal> {
        let runs = &mut results.runs;
        let nothing_ran = !runs.is_empty() && runs.iter().all(|r| r.status == Status::Refused);
        runs.extend(self.refused.iter().cloned());
        if nothing_ran {
            return Err(self.refuse(none_can_run(runs)));
        }
        for row in &self.refused {
            let why = row.message.as_deref().unwrap_or_default();
            let what = format!("{}: {why}", row.model_label());
            results.settings.push((REFUSED_MODEL.into(), what));
        }
        let stopped = self.context.interruption.is_requested();
        if stopped {
            let planned = results.runs.len();
            (results.runs).retain(|r| r.status != Status::Interrupted);
            let (made, parts) = (results.runs.len(), parts(&results.part));
            if made + parts == 0 {
                return Err(self.interrupted());
            }
            let what = match (&results.part, planned) {
                (Part::Stability(_), _) => {
                    "cells that were not computed are marked; the same command continues the study"
                        .into()
                }
                (_, 0) => {
                    format!("{parts} parts were finished; the same command continues the study")
                }
                _ => format!(
                    "{made} of {planned} runs were finished; the same command continues the study"
                ),
            };
            results.settings.push((INTERRUPTED_STUDY.into(), what));
        }
        results.header.source.clone_from(&self.source);
        results.measured.clone_from(&self.measured);
        let ending = match (stopped, self.refused.is_empty()) {
            (true, _) => Exit::Interrupted,
            (false, true) => exit(&results),
            // Some of the requested models could not run.
            (false, false) => Exit::FailedRun,
        };
        if self.temporary.is_some() {
            if let Some(text) = damping_differs(&results.mesh_modes) {
                self.context.messages.warn(&text);
            }
            return Ok(CommandResult::returning(results).ending(ending));
        }
        let page = gearbench_reports::write_results(&self.path, &results)
            .map_err(|e| Refusal::Files(e.to_string()))?;
        let histories: Vec<_> = match self.context.record {
            RecordUse::Returned => results
                .runs
                .iter_mut()
                .map(|r| r.histories.take())
                .collect(),
            RecordUse::Written => Vec::new(),
        };
        // They are in files of their own now, and as values of an answer they would take many times their memory.
        results.runs.iter_mut().for_each(|r| r.histories = None);
        summarise(&self.context.messages, &results);
        self.describe_mesh_modes(&results);
        for line in gearbench_reports::measured_lines(&results).unwrap_or_default() {
            self.context.messages.print_line(&line);
        }
        if let Some((_, what)) = results.settings.last().filter(|_| stopped) {
            self.context
                .messages
                .print_line(&format!("interrupted: {what}"));
        }
        let [record, page] = [self.path.join(RECORD), page].map(absolute);
        self.context
            .messages
            .print_line(&format!("record: {}", record.display()));
        self.context
            .messages
            .print_line(&format!("report: {}", page.display()));
        self.close();
        let answer = match self.context.record {
            RecordUse::Written => CommandResult::of(&results),
            RecordUse::Returned => {
                for (run, own) in results.runs.iter_mut().zip(histories) {
                    run.histories = own;
                }
                CommandResult::returning(results)
            }
        };
        Ok((answer.with("record", &record).with("report", &page)).ending(ending))
    }

    /// Prints the damping of the mesh mode of each model, and a warning if models differ in it.
    fn describe_mesh_modes(&self, results: &Results) {
        for mode in &results.mesh_modes {
            self.context.messages.print_line(&format!(
                "mesh mode of {}: {}",
                mode.label,
                mode.to_text()
            ));
        }
        if let Some(text) = damping_differs(&results.mesh_modes) {
            self.context.messages.warn(&text);
        }
    }

    /// Returns a refusal; after bad input it removes the journal, as nothing is worth continuing.
    pub fn refuse(&self, refusal: Refusal) -> Refusal {
        if let Refusal::Input(_) = refusal {
            self.close();
        }
        refusal
    }

    /// Ends the study: removes the journal, unless the study was interrupted.
    pub fn close(&self) {
        if !self.context.interruption.is_requested() {
            // A journal that cannot be removed is taken up by the next start, with the same results.
            let _ = std::fs::remove_file(self.path.join(JOURNAL));
        }
    }
}

/// The refusal of a study in which no model can run, with the reasons.
fn none_can_run(rows: &[Run]) -> Refusal {
    let mut reasons: Vec<String> = Vec::new();
    for row in rows {
        let reason = row.message.as_deref().unwrap_or("no reason given");
        let line = format!("{}: {reason}", row.model_label());
        if !reasons.contains(&line) {
            reasons.push(line);
        }
    }
    Refusal::Input(miette::miette!(
        help = "choose other models (--models), or follow the advice in the reasons",
        "none of the models can run: {}",
        reasons.join("; ")
    ))
}

impl Drop for StudyFolder {
    /// Removes a journal without finished pieces, and the folders that were created for the study if they are empty.
    fn drop(&mut self) {
        if self.temporary.is_some() {
            return;
        }
        let journal = self.path.join(JOURNAL);
        // The journal of another process does not belong to this study.
        if self.has_journal && pieces(&journal) == 0 {
            let _ = std::fs::remove_file(journal);
        }
        self.lock = None;
        let Some(made) = &self.made else { return };
        for folder in self.path.ancestors() {
            // A folder that is not empty stays.
            if std::fs::remove_dir(folder).is_err() || folder == made {
                break;
            }
        }
    }
}

/// Number of finished pieces in a journal: its lines without the first.
fn pieces(journal: &Path) -> usize {
    use std::io::{BufRead, BufReader};
    let file = std::fs::File::open(journal).ok().map(BufReader::new);
    let lines = file.map_or(0, |f| f.split(b'\n').map_while(Result::ok).count());
    lines.saturating_sub(1)
}

/// Number of results of a record apart from runs; an interrupted study reports them too.
fn parts(part: &Part) -> usize {
    match part {
        Part::Stability(part) => part.maps.len(),
        Part::Modes(part) => part.vibrations.len(),
        Part::Response(part) => part.responses.len(),
        Part::Identify(part) => part.fits.len(),
        Part::Check(part) => part.entries.len(),
        _ => 0,
    }
}

/// Sorts labels, separated by commas, alphabetically.
fn in_order(labels: &str) -> String {
    let mut all: Vec<&str> = labels.split(',').map(str::trim).collect();
    all.sort_unstable();
    all.join(",")
}

/// Removes staging folders of processes that were killed while they wrote the record; the lock of this process excludes
/// other writers.
pub(crate) fn remove_staging(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let pid = name
            .strip_prefix(".staging-")
            .and_then(|p| p.parse::<u32>().ok());
        // A symbolic link is removed itself, not its target.
        let _ = match entry.file_type() {
            _ if pid.is_none() => continue,
            Ok(kind) if kind.is_dir() => std::fs::remove_dir_all(entry.path()),
            _ => std::fs::remove_file(entry.path()),
        };
    }
}

/// Refuses an output folder that contains an input that could be mistaken for a result.
fn refuse_input(folder: &Path, input: &Path) -> Result<(), Refusal> {
    let ending = input
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    let like_a_result =
        ENDINGS.contains(&ending) || input.file_name().is_some_and(|n| n == "chosen.toml");
    if !like_a_result || !is_same(folder_of(input), folder) {
        return Ok(());
    }
    Err(Refusal::Input(miette::miette!(
        help = "name another folder with --out",
        "{}: `{}`, an input of the study, is in the output folder",
        folder.display(),
        input.display()
    )))
}

/// Header of an existing record: study, scene and command.
#[derive(Deserialize)]
struct RecordedHeader {
    schema: u32,
    study: String,
    scene: String,
    command: String,
    #[serde(default)]
    source: Option<RecordedSource>,
}

#[derive(Deserialize)]
struct RecordedSource {
    name: String,
    scene: String,
}

/// Refuses a folder that contains the results of another study or files of another program.
fn belongs_to(
    folder: &Path,
    (name, subject): (&str, &Subject),
    source: Option<&Source>,
) -> Result<(), Refusal> {
    let refuse = |what: &str| {
        Err(Refusal::Input(miette::miette!(
            help = "name another folder with --out, or replace its contents with --force",
            "{}: {what}",
            folder.display()
        )))
    };
    let record = folder.join(RECORD);
    if !OWN.iter().any(|name| folder.join(name).exists()) {
        return match first_result(folder) {
            None => Ok(()),
            Some(name) => refuse(&format!(
                "the folder contains files that no study has written (`{name}`)"
            )),
        };
    }
    if !record.exists() {
        return Ok(());
    }
    let text = match record.is_file() {
        true => std::fs::read_to_string(&record).unwrap_or_default(),
        false => String::new(),
    };
    let Ok(kept) = serde_json::from_str::<RecordedHeader>(&text) else {
        return refuse(&format!("its {RECORD} is not a record of gearbench"));
    };
    if kept.schema != SCHEMA {
        return refuse(&format!(
            "its {RECORD} is a record of another version of gearbench"
        ));
    }
    let same_scene = match (&kept.source, source) {
        (Some(a), Some(b)) => {
            a.name == b.name
                || a.scene == b.scene
                || is_same(Path::new(&a.name), Path::new(&b.name))
        }
        // A check has no scene of its own, and records of older versions do not have it.
        _ => kept.scene == name,
    };
    let models = super::models_of(&kept.command).map(|m| m.as_deref().map(in_order));
    let other = match (kept.study == subject.study, same_scene) {
        (false, _) => "another study",
        (_, false) => "another scene of the same name",
        // The command line of another version may be unreadable; it is then ignored.
        _ if models.is_some_and(|m| m != subject.models) => "another choice of models",
        _ => return Ok(()),
    };
    refuse(&format!(
        "the folder holds the results of {other} (`{}`)",
        kept.command
    ))
}

/// Returns a file whose extension is one that a study writes.
fn first_result(folder: &Path) -> Option<String> {
    let names = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = (names.filter(|e| e.file_type().is_ok_and(|t| !t.is_dir())))
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| {
            let ending = Path::new(name).extension().and_then(|e| e.to_str());
            ending.is_some_and(|e| ENDINGS.contains(&e))
        })
        .collect();
    names.sort_unstable();
    names.into_iter().next()
}
