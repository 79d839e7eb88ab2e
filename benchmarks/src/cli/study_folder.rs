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
use gearbench_reports::measured::MeasuredCurve;
use gearbench_reports::record::{
    Part, Results, Run, SCHEMA, Source, Status, StudyHeader, damping_differs,
};
use gearbench_reports::{RECORD, Study};
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
    /// The scenes, calibrations and input files that the record will contain, one a scene.
    sources: Vec<Source>,
    /// Measured curves that the tables are compared with.
    measured: Vec<MeasuredCurve>,
    /// Rows of models that cannot run, of each scene.
    refused: Vec<Vec<Run>>,
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
        Self::begin(context, output, (scene, study), Vec::new(), &[])
    }

    /// Opens the folder of a study of a scene, which becomes part of the record.
    ///
    /// # Errors
    /// As [`StudyFolder::open`], and [`Refusal::Input`] when files that the scene reads are among the results.
    pub fn of(output: &Output, scene: &SceneFile, study: &str) -> Result<Self, Refusal> {
        Self::of_scenes(output, &[scene], study)
    }

    /// Opens the folder of a study of one or several scenes, in the order of the record. Without a name it is called
    /// after all of them.
    ///
    /// # Errors
    /// As [`StudyFolder::of`], and [`Refusal::Input`] when there is no scene, or two have one name, by which tables and
    /// charts could not distinguish them.
    pub fn of_scenes(output: &Output, scenes: &[&SceneFile], study: &str) -> Result<Self, Refusal> {
        let mut names: Vec<&str> = Vec::new();
        for scene in scenes {
            if names.contains(&scene.name.as_str()) {
                return Err(Refusal::Input(miette::miette!(
                    help = "give one of the scene files another `name`",
                    "two scenes of the command have the name `{}`",
                    scene.name
                )));
            }
            names.push(&scene.name);
        }
        let Some(first) = scenes.first() else {
            return Err(Refusal::Input(miette::miette!("the command has no scene")));
        };
        let sources = scenes.iter().map(|scene| scene.source()).collect();
        let inputs: Vec<PathBuf> = scenes.iter().flat_map(|scene| scene.inputs()).collect();
        let name = names.join("+");
        let mut folder = Self::begin(&first.context, output, (&name, study), sources, &inputs)?;
        let rows = |scene: &&SceneFile| {
            let rows = scene.refused.iter();
            rows.map(|r| refused(&r.label, &r.model, r.error.to_text()))
                .collect()
        };
        folder.refused = scenes.iter().map(rows).collect();
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
            header.source.iter().cloned().collect(),
            &[],
        )
    }

    fn begin(
        context: &Context,
        output: &Output,
        (name, study): (&str, &str),
        sources: Vec<Source>,
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
            scene: match sources.as_slice() {
                [] => name.to_owned(),
                all => (all.iter().map(|s| s.name.as_str()))
                    .collect::<Vec<_>>()
                    .join(" "),
            },
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
            sources,
            measured: measured.concat(),
            refused: vec![Vec::new()],
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
            belongs_to(&path, (name, &subject), &folder.sources)?;
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
        self.refused[0].push(row);
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
    /// command. Runs that an interruption prevented are left out, and the journal stays for the next start. The exit code
    /// of several scenes is the worst of theirs, and each scene has its own summary.
    ///
    /// # Errors
    /// [`Refusal::Files`] when a file cannot be written, [`Refusal::Interrupted`] when there is nothing to report.
    pub fn finish(
        &self,
        mut results: Results,
        exit: impl Fn(&Results) -> Exit,
        summarise: impl Fn(&Messages, &Results),
    ) -> Result<CommandResult, Refusal> {
        let stopped = self.context.interruption.is_requested();
        let further = std::mem::take(&mut results.further);
        let mut scenes: Vec<Results> = std::iter::once(results).chain(further).collect();
        let mut finished = 0;
        for (place, scene) in scenes.iter_mut().enumerate() {
            finished += self.complete(scene, place, stopped)?;
        }
        if stopped && finished == 0 {
            return Err(self.interrupted());
        }
        let ending = match (stopped, self.refused.iter().all(Vec::is_empty)) {
            (true, _) => Exit::Interrupted,
            (false, true) => Exit::worst(scenes.iter().map(exit)),
            // Some of the requested models could not run.
            (false, false) => Exit::FailedRun,
        };
        let first = scenes.remove(0);
        let mut results = Results {
            further: scenes,
            ..first
        };
        results.measured.clone_from(&self.measured);
        if self.temporary.is_some() {
            for text in results
                .scenes()
                .filter_map(|r| damping_differs(&r.mesh_modes))
            {
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
        let further = results.further.iter_mut().flat_map(|r| &mut r.runs);
        (results.runs.iter_mut().chain(further)).for_each(|r| r.histories = None);
        for scene in results.scenes() {
            if !results.further.is_empty() {
                self.context
                    .messages
                    .print_line(&format!("scene {}:", scene.header.scene));
            }
            summarise(&self.context.messages, scene);
            self.describe_mesh_modes(scene);
        }
        for line in gearbench_reports::measured_lines(&results).unwrap_or_default() {
            self.context.messages.print_line(&line);
        }
        for (_, what) in results
            .scenes()
            .filter_map(|r| r.settings.last())
            .filter(|_| stopped)
        {
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

    /// Completes the record of a scene: adds models that were refused and the source, removes runs that an interruption
    /// prevented. Returns the number of its results.
    fn complete(
        &self,
        results: &mut Results,
        place: usize,
        stopped: bool,
    ) -> Result<usize, Refusal> {
        let runs = &mut results.runs;
        let nothing_ran = !runs.is_empty() && runs.iter().all(|r| r.status == Status::Refused);
        let refused = self.refused.get(place).map_or(&[][..], Vec::as_slice);
        runs.extend(refused.iter().cloned());
        if nothing_ran {
            return Err(self.refuse(none_can_run(runs)));
        }
        for row in refused {
            let why = row.message.as_deref().unwrap_or_default();
            let what = format!("{}: {why}", row.model_label());
            results.settings.push((REFUSED_MODEL.into(), what));
        }
        let parts = parts(&results.part);
        if stopped {
            let planned = results.runs.len();
            (results.runs).retain(|r| r.status != Status::Interrupted);
            let made = results.runs.len();
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
        results.header.source = self.sources.get(place).cloned();
        Ok(results.runs.len() + parts)
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
    /// Name of a study whose results are one table.
    #[serde(default)]
    name: Option<String>,
    scene: String,
    command: String,
    #[serde(default)]
    source: Option<RecordedSource>,
    #[serde(default)]
    further: Vec<RecordedHeader>,
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
    sources: &[Source],
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
    let same = |kept: &RecordedSource, now: &Source| {
        kept.name == now.name
            || kept.scene == now.scene
            || is_same(Path::new(&kept.name), Path::new(&now.name))
    };
    let headers = || std::iter::once(&kept).chain(&kept.further);
    let recorded: Option<Vec<&RecordedSource>> = headers().map(|h| h.source.as_ref()).collect();
    let same_scene = match (recorded, sources) {
        (Some(kept), now @ [_, ..]) => {
            kept.len() == now.len() && kept.iter().zip(now).all(|(kept, now)| same(kept, now))
        }
        // A check has no scene of its own, and records of older versions do not have it.
        _ => kept.scene == name,
    };
    let models = super::models_of(&kept.command).map(|m| m.as_deref().map(in_order));
    let study = match kept.study == Study::Tabular.as_str() {
        true => kept.name.as_deref().unwrap_or_default(),
        false => &kept.study,
    };
    let other = match (study == subject.study, same_scene) {
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
