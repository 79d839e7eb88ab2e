//! The folder of a study: tried before the first run, with the journal of what is finished, and at the end the record.

use super::answer::Answer;
use super::arguments::Output;
use super::exit::Exit;
use super::progress::Display;
use super::terminal::{Refusal, absolute, say, warn};
use crate::experiment::budget::Budget;
use crate::experiment::conditions::Progress;
use crate::experiment::configuration::refused;
use crate::experiment::interruption;
use crate::experiment::journal::{JOURNAL, Journal, JournalError};
use crate::experiment::runner::Runner;
use crate::scene_file::SceneFile;
use gearbench_reports::RECORD;
use gearbench_reports::record::{Results, Run, Source, Status, damping_differs};
use std::io;
use std::path::{Path, PathBuf};

/// The setting that says that a study is not complete.
const INTERRUPTED_STUDY: &str = "interrupted";

/// The setting that says which models cannot run, and why.
const REFUSED_MODEL: &str = "refused";

/// The folder of a study.
pub struct StudyFolder {
    path: PathBuf,
    journal: Option<Journal>,
    /// The outermost folder that was made for it.
    made: Option<PathBuf>,
    /// What the record will be made of.
    source: Option<Source>,
    /// Rows of models that cannot run the scene.
    refused: Vec<Run>,
}

impl From<JournalError> for Refusal {
    fn from(e: JournalError) -> Self {
        Refusal::Files(e.to_string())
    }
}

impl StudyFolder {
    /// Makes sure that the folder can be written to, takes up what an interrupted start has left in it, and catches
    /// signals from here on.
    ///
    /// # Errors
    /// [`Refusal::Files`] when the folder, or the journal in it, cannot be written.
    pub fn open(output: &Output, scene: &str, study: &str) -> Result<Self, Refusal> {
        let path = (output.out.clone()).unwrap_or_else(|| Path::new("out").join(scene).join(study));
        let fail = |e: io::Error| Refusal::Files(format!("{}: {e}", path.display()));
        let made = path.ancestors().take_while(|p| !p.exists()).last();
        let made = made.map(Path::to_owned);
        std::fs::create_dir_all(&path).map_err(fail)?;
        let folder = StudyFolder {
            journal: Some(Journal::open(&path.join(JOURNAL), output.fresh)?),
            path: path.clone(),
            made,
            source: None,
            refused: Vec::new(),
        };
        interruption::catch().map_err(fail)?;
        Ok(folder)
    }

    /// The folder of a study of a scene, which the record will keep.
    ///
    /// # Errors
    /// Those of [`StudyFolder::open`].
    pub fn of(output: &Output, scene: &SceneFile, study: &str) -> Result<Self, Refusal> {
        let mut folder = Self::open(output, &scene.name, study)?;
        folder.source = Some(scene.source());
        let rows = scene
            .refused
            .iter()
            .map(|r| refused(&r.label, &r.model, r.error.told()));
        folder.refused = rows.collect();
        Ok(folder)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Does a study of some known number of runs.
    pub fn run<T>(&mut self, length: usize, study: impl FnOnce(&Runner<'_>) -> T) -> T {
        let display = Display::new(length);
        let progress = |done, total, what: &str| display.tell(done, total, what);
        study(&self.runner(&progress))
    }

    /// Does a study of some known number of runs within a budget.
    pub fn run_within<T>(
        &mut self,
        budget: Budget,
        length: usize,
        study: impl FnOnce(&Runner<'_>) -> T,
    ) -> T {
        let display = Display::new(length);
        let progress = |done, total, what: &str| display.tell(done, total, what);
        study(&self.runner(&progress).within(budget))
    }

    /// What does the pieces of the study, once: it has the journal.
    pub fn runner<'a>(&mut self, progress: Progress<'a>) -> Runner<'a> {
        let Some(journal) = self.journal.take() else {
            return Runner::default();
        };
        if !journal.is_empty() {
            say(&format!(
                "going on after {} finished pieces of an interrupted start (--fresh starts over)",
                journal.len()
            ));
        }
        Runner::new(journal, progress)
    }

    /// Writes the record with its report, prints its summary and where everything lies, and answers with it. Runs that an
    /// interruption kept from being made are left out, and the journal stays for the next start.
    ///
    /// # Errors
    /// [`Refusal::Files`] when a file cannot be written, [`Refusal::Interrupted`] when there is nothing to report.
    pub fn finish(
        &self,
        mut results: Results,
        exit: impl FnOnce(&Results) -> Exit,
        summarise: impl FnOnce(&Results),
    ) -> Result<Answer, Refusal> {
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
        let stopped = interruption::requested();
        if stopped {
            let planned = results.runs.len();
            (results.runs).retain(|r| r.status != Status::Interrupted);
            let (made, maps) = (results.runs.len(), results.maps().len());
            if made + maps == 0 {
                return Err(Refusal::Interrupted);
            }
            let what = if maps == 0 {
                format!("{made} of {planned} runs were made; the same command goes on")
            } else {
                "cells that were not made say so; the same command goes on".into()
            };
            results.settings.push((INTERRUPTED_STUDY.into(), what));
        }
        results.header.source.clone_from(&self.source);
        let page = gearbench_reports::write_results(&self.path, &results)
            .map_err(|e| Refusal::Files(e.to_string()))?;
        // They are in files of their own now, and as values of an answer they would take many times their memory.
        results.runs.iter_mut().for_each(|r| r.histories = None);
        summarise(&results);
        describe_mesh_modes(&results);
        if let Some((_, what)) = results.settings.last().filter(|_| stopped) {
            say(&format!("interrupted: {what}"));
        }
        let [record, page] = [self.path.join(RECORD), page].map(absolute);
        say(&format!("record: {}", record.display()));
        say(&format!("report: {}", page.display()));
        self.close();
        let answer = (Answer::of(&results).with("record", &record)).with("report", &page);
        Ok(answer.ending(match (stopped, self.refused.is_empty()) {
            (true, _) => Exit::Interrupted,
            (false, true) => exit(&results),
            // Other models ran, but not all that were asked for.
            (false, false) => Exit::FailedRun,
        }))
    }

    /// Passes a refusal on; of bad input nothing stays behind.
    pub fn refuse(&self, refusal: Refusal) -> Refusal {
        if let Refusal::Input(_) = refusal {
            self.close();
        }
        refusal
    }

    /// The end of a study: its journal has served, unless it was interrupted.
    pub fn close(&self) {
        if !interruption::requested() {
            // A journal that cannot be removed is taken up by the next start, with the same results.
            let _ = std::fs::remove_file(self.path.join(JOURNAL));
        }
    }
}

/// The refusal of a study none of whose models can run, with their reasons.
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
        help = "take other models (--models), or a way out that the reasons name",
        "none of the models can run: {}",
        reasons.join("; ")
    ))
}

/// The damping of the mesh mode of each model, and a warning where models differ in it.
fn describe_mesh_modes(results: &Results) {
    for mode in &results.mesh_modes {
        say(&format!("mesh mode of {}: {}", mode.label, mode.to_text()));
    }
    if let Some(text) = damping_differs(&results.mesh_modes) {
        warn(&text);
    }
}

impl Drop for StudyFolder {
    /// A study that came to nothing leaves nothing behind.
    fn drop(&mut self) {
        let journal = self.path.join(JOURNAL);
        let empty = |j: &Path| Journal::open(j, false).is_ok_and(|j| j.is_empty());
        if journal.exists() && empty(&journal) {
            let _ = std::fs::remove_file(journal);
        }
        let Some(made) = &self.made else { return };
        for folder in self.path.ancestors() {
            // A folder that is not empty stays.
            if std::fs::remove_dir(folder).is_err() || folder == made {
                break;
            }
        }
    }
}
