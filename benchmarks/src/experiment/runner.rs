//! Execution of a study piece by piece: finished pieces are stored on disk, and none begins after an interruption.
//!
//! A study is written as if it computed everything. Finished pieces of an earlier start are taken from the journal. An
//! interrupted study reaches its end with rows without results, which the record then leaves out.

use super::budget::Budget;
use super::conditions::{Progress, silent};
use super::error::ModelRefusal;
use super::journal::{Journal, JournalError};
use super::key::Key;
use super::parallel::lock;
use crate::context::Context;
use gearbench_integrators::Scheme;
use gearbench_reports::force::ForceHistory;
use gearbench_reports::record::{Run, Status};
use gearbench_reports::series::TimeSeries;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Callback that receives the number of finished pieces that an interrupted start left in the journal.
pub type ResumeCallback<'a> = &'a (dyn Fn(&Context, usize) + Sync);

/// Number of pieces that were taken from the journal.
#[derive(Debug, Default)]
struct ResumedPieces {
    pieces: usize,
    announced: bool,
}

/// Runs the pieces of a study.
pub struct Runner<'a> {
    context: Context,
    journal: Option<Mutex<Journal>>,
    progress: Progress<'a>,
    /// Memory of the rows that the study keeps to its end [bytes].
    kept: AtomicU64,
    /// Budget of processor time of all pieces together.
    budget: Budget,
    resumed: Mutex<ResumedPieces>,
    announce: ResumeCallback<'a>,
}

impl Drop for Runner<'_> {
    fn drop(&mut self) {
        self.announce();
        let kept = *self.kept.get_mut();
        self.context.resources.memory.release(kept);
    }
}

impl fmt::Debug for Runner<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("Runner");
        debug
            .field("journal", &self.journal)
            .finish_non_exhaustive()
    }
}

impl Default for Runner<'_> {
    /// A runner in a context of its own.
    fn default() -> Self {
        Self::of(Context::default())
    }
}

impl<'a> Runner<'a> {
    /// A runner that stores finished pieces in a journal.
    pub fn new(context: Context, journal: Journal, progress: Progress<'a>) -> Self {
        let mut runner = Self::of(context);
        (runner.journal, runner.progress) = (Some(Mutex::new(journal)), progress);
        runner
    }

    /// A runner without journal, progress output and time budget.
    pub fn of(context: Context) -> Self {
        Runner {
            context,
            journal: None,
            progress: &silent,
            kept: AtomicU64::new(0),
            budget: Budget::unlimited(),
            resumed: Mutex::default(),
            announce: &|_, _| {},
        }
    }

    /// Sets the callback for progress.
    #[must_use]
    pub fn reporting(mut self, progress: Progress<'a>) -> Self {
        self.progress = progress;
        self
    }

    /// Sets the callback for the number of pieces that are taken from an interrupted start. It is called once, before
    /// the first piece is computed or at the end.
    #[must_use]
    pub fn announcing(mut self, announce: ResumeCallback<'a>) -> Self {
        self.announce = announce;
        self
    }

    fn announce(&self) {
        let pieces = {
            let mut resumed = lock(&self.resumed);
            let first = !std::mem::replace(&mut resumed.announced, true);
            if first { resumed.pieces } else { 0 }
        };
        if pieces > 0 {
            (self.announce)(&self.context, pieces);
        }
    }

    /// Sets the budget of processor time, which counts from its creation.
    #[must_use]
    pub fn within(mut self, budget: Budget) -> Self {
        self.budget = budget;
        self
    }

    /// True if no further piece is to begin.
    pub fn is_interrupted(&self) -> bool {
        self.context.interruption.is_requested()
    }

    /// The budget of processor time of the study.
    pub fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Reports progress: number of runs done, their total number so far, and the name of the next.
    pub fn report_progress(&self, done: usize, total: usize, what: &str) {
        (self.progress)(done, total, what);
    }

    /// Subtracts the memory of a row that the study keeps from the memory for further runs.
    pub fn reserve_memory(&self, row: &Run) {
        let bytes = 8 * numbers_of(row) as u64;
        self.context.resources.memory.reserve(bytes);
        self.kept.fetch_add(bytes, Ordering::Relaxed);
    }

    /// Returns the result of a piece of work from the journal, if it is finished.
    ///
    /// # Errors
    /// [`JournalError`] when the journal holds something else.
    pub fn finished<T: DeserializeOwned>(&self, key: Key) -> Result<Option<T>, JournalError> {
        let Some(journal) = &self.journal else {
            return Ok(None);
        };
        let found = lock(journal).get(&key.to_string())?;
        match found {
            Some(_) => lock(&self.resumed).pieces += 1,
            None => self.announce(),
        }
        Ok(found)
    }

    /// Returns the result of a piece of work from the journal, or computes and stores it.
    ///
    /// # Errors
    /// Errors of the work, and [`JournalError`].
    pub fn piece<T, E>(&self, key: Key, make: impl FnOnce() -> Result<T, E>) -> Result<T, E>
    where
        T: Serialize + DeserializeOwned,
        E: From<JournalError>,
    {
        match self.finished(key)? {
            Some(found) => Ok(found),
            None => Ok(self.store(key, make()?)?),
        }
    }

    /// Stores the result of a piece of work in the journal and returns it.
    ///
    /// # Errors
    /// [`JournalError`] when the journal cannot be written.
    pub fn store<T: Serialize>(&self, key: Key, made: T) -> Result<T, JournalError> {
        if let Some(journal) = &self.journal {
            lock(journal).store(&key.to_string(), &made)?;
        }
        Ok(made)
    }

    /// Returns the row of a run under a method from the journal, or computes it. An interruption, a model that cannot
    /// run and a panic give a row without result, so that other runs continue.
    ///
    /// # Errors
    /// Errors of the work, and [`JournalError`].
    pub fn row<E: From<JournalError> + ModelRefusal>(
        &self,
        key: Key,
        method: &Scheme,
        make: impl FnOnce() -> Result<Run, E>,
    ) -> Result<Run, E> {
        let made = self.row_with(key, method, || make().map(|row| (row, ())));
        made.map(|(row, ())| row)
    }

    /// [`Runner::row`] with data that the next row needs; the default of the type where a row has no result.
    ///
    /// # Errors
    /// Errors of the work, and [`JournalError`].
    pub fn row_with<X, E>(
        &self,
        key: Key,
        method: &Scheme,
        make: impl FnOnce() -> Result<(Run, X), E>,
    ) -> Result<(Run, X), E>
    where
        X: Default + Serialize + DeserializeOwned,
        E: From<JournalError> + ModelRefusal,
    {
        let not_made = |status, message: String| Run {
            status,
            message: Some(message),
            ..unfinished(method)
        };
        self.guarded(key, make, |status, message| {
            (not_made(status, message), X::default())
        })
    }

    /// Returns the result of a run from the journal, or computes it. After an interruption, a model that cannot run or
    /// a panic it returns the result of `not_made`, which the journal does not store.
    ///
    /// # Errors
    /// Errors of the work, and [`JournalError`].
    pub fn guarded<T, E>(
        &self,
        key: Key,
        make: impl FnOnce() -> Result<T, E>,
        not_made: impl FnOnce(Status, String) -> T,
    ) -> Result<T, E>
    where
        T: Serialize + DeserializeOwned,
        E: From<JournalError> + ModelRefusal,
    {
        if let Some(found) = self.finished(key)? {
            return Ok(found);
        }
        match self.attempt(make) {
            Ok(row) => Ok(self.store(key, row)?),
            Err(e) => {
                let (status, why) = e.row()?;
                Ok(not_made(status, why))
            }
        }
    }

    /// Runs the work on one model, isolated so that its errors and panics do not end other work.
    ///
    /// # Errors
    /// [`WorkError`].
    pub fn attempt<T, E>(&self, make: impl FnOnce() -> Result<T, E>) -> Result<T, WorkError<E>> {
        if self.is_interrupted() {
            return Err(WorkError::Interrupted);
        }
        match catch_unwind(AssertUnwindSafe(make)) {
            Ok(Err(_)) if self.is_interrupted() => Err(WorkError::Interrupted),
            Ok(made) => made.map_err(WorkError::Error),
            Err(panic) => Err(WorkError::Panic(failure(&*panic))),
        }
    }
}

/// Reason why the work on one model has no result.
#[derive(Debug)]
pub enum WorkError<E> {
    /// The study was interrupted.
    Interrupted,
    /// The work ended with an error of the model or of the study.
    Error(E),
    /// The program panicked during the work.
    Panic(String),
}

impl<E: ModelRefusal> WorkError<E> {
    /// Status and message of the row for work without result.
    ///
    /// # Errors
    /// An error that is not of the model ends the study.
    pub fn row(self) -> Result<(Status, String), E> {
        match self {
            WorkError::Interrupted => Ok((
                Status::Interrupted,
                "not run: the study was interrupted".into(),
            )),
            WorkError::Error(e) => match e.refusal() {
                Some(why) => Ok((Status::Refused, why)),
                None => Err(e),
            },
            WorkError::Panic(why) => Ok((Status::Aborted, why)),
        }
    }
}

/// A run under a method without any results.
pub fn unfinished(method: &Scheme) -> Run {
    Run {
        integrator: method.method.to_string(),
        implicit: method.method.info().implicit,
        step: method.resolution.step(),
        rtol: method.resolution.tolerance(),
        wall_s: f64::NAN,
        setup_s: f64::NAN,
        simulated_s: f64::NAN,
        ..Run::default()
    }
}

/// Size of the histories of a row, in numbers.
fn numbers_of(row: &Run) -> usize {
    let of_series = |s: &TimeSeries| {
        let force: usize = s.forces.iter().map(ForceHistory::len).sum();
        s.len() * (1 + s.columns.len()) + 2 * force
    };
    let own = row.series.as_ref().map_or(0, of_series);
    let whole = row.histories.as_ref().map_or(0, |h| {
        let further: usize = h.further.iter().map(|c| c.values.len()).sum();
        let series = h.series.as_ref().map_or(0, of_series);
        series + further + h.on_grid.len() + 5 * h.pairs.len() + 8 * h.events.len()
    });
    own + whole
}

/// The note on a panic, for the row of the run.
fn failure(panic: &(dyn Any + Send)) -> String {
    let text = (panic.downcast_ref::<&str>().map(|s| (*s).to_owned()))
        .or_else(|| panic.downcast_ref::<String>().cloned());
    format!(
        "the program itself failed in this run ({}); please report it with the scene",
        text.as_deref().unwrap_or("no reason given")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::journal::{JOURNAL, Subject};
    use crate::experiment::run::RunError;
    use gearbench_integrators::table::RK4;

    #[test]
    fn a_finished_piece_is_made_once_and_a_panic_is_a_row() {
        let folder = tempfile::tempdir().unwrap();
        let open =
            || Journal::open(&folder.path().join(JOURNAL), &Subject::default(), false).unwrap();
        let method = RK4.at_step(1e-6);
        let [good, bad] = [Key::new("good"), Key::new("bad")];
        for start in 0..2 {
            let runner = Runner::new(Context::default(), open(), &silent);
            let row = runner.row(good, &method, || {
                assert_eq!(start, 0, "made again");
                Ok::<_, RunError>(Run {
                    steps: 7,
                    ..Run::default()
                })
            });
            assert_eq!(row.unwrap().steps, 7);
            let row = runner.row(bad, &method, || -> Result<Run, RunError> {
                panic!("no way")
            });
            let row = row.unwrap();
            assert_eq!((row.status, row.step), (Status::Aborted, Some(1e-6)));
            assert!(row.message.unwrap().contains("no way"));
        }
        assert_eq!(open().len(), 1);
    }

    /// If a study needs two of three pieces in the journal, it announces two.
    #[test]
    fn only_pieces_that_are_used_are_announced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(JOURNAL);
        let open = || Journal::open(&path, &Subject::default(), false).unwrap();
        let make = |runner: &Runner<'_>, pieces: &[&str]| {
            for piece in pieces {
                let made: Result<usize, JournalError> = runner.piece(Key::new(piece), || Ok(1));
                made.unwrap();
            }
        };
        make(
            &Runner::new(Context::default(), open(), &silent),
            &["a", "b", "of another scene"],
        );
        for pieces in [&["a", "b", "c", "d"] as &[&str], &["b", "a"]] {
            let announced = Mutex::new(Vec::new());
            let announce = |_: &Context, n| lock(&announced).push(n);
            make(
                &Runner::new(Context::default(), open(), &silent).announcing(&announce),
                pieces,
            );
            assert_eq!(*lock(&announced), [2]);
        }
        let none = |_: &Context, _| panic!("nothing was taken up");
        make(
            &Runner::new(Context::default(), open(), &silent).announcing(&none),
            &["e"],
        );
    }
}
