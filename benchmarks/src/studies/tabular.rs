//! Studies whose results are one table: a cell is a run, a row has its quantities.
//!
//! A study of this kind is one file: its arguments, its cells, what a cell measures, its columns, its charts and its
//! finding ([`TabularStudy`]), with an entry in the list of studies (`cli::study_command`). Everything else is common:
//! [`run`] reads the scene, runs the cells with their journal, and writes the record, from which page, charts, CSV file,
//! dictionary and the lines on the terminal follow (`gearbench_reports::tabular`).

use crate::cli::arguments::{AnyReference, BoundedOutput};
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, references_of, refuse_study};
use crate::context::Context;
use crate::experiment::budget::{Budget, NOT_TRIED};
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::decimation::decimate_run;
use crate::experiment::error::StudyError;
use crate::experiment::key::Key;
use crate::experiment::parallel::{in_parallel, lock};
use crate::experiment::reference_series::recorded;
use crate::experiment::run::{Job, LEFT_OUT, RunError};
use crate::experiment::runner::Runner;
use crate::experiment::settings::{settings, simulated_time};
use crate::messages::Messages;
use crate::scene_file::{self, ModelChoice, RefusedModel, SceneFile, Selection};
use gearbench_integrators::{MethodSpec, Scheme};
use gearbench_reports::Format;
use gearbench_reports::columns::Columns;
use gearbench_reports::record::{Metrics, Part, ReferenceSeries, Results, Run, Status};
use gearbench_reports::tabular::{
    MESSAGE, MODEL, STATUS, SummaryTable, TableChart, TableRow, TabularRecord,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::fmt::Debug;
use std::ops::Deref;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// A cell of a study: a configuration under an integrator, at the values that the study varies.
#[derive(Clone, Debug)]
pub struct Cell<P> {
    /// Scene and model.
    pub configuration: Configuration,
    /// Integrator.
    pub method: Scheme,
    /// Name of the cell among the cells of its model in the table; `None` where the model has one name.
    pub variant: Option<String>,
    /// Values that the study varies, with everything else that the result depends on.
    pub at: P,
    /// Name of the cell among those of its model, for the display of the progress.
    pub name: String,
}

/// A cell with its results: a row of the table.
pub struct Measured<S: TabularStudy> {
    /// The cell.
    pub cell: Cell<S::At>,
    /// Its run, also a failed one.
    pub run: Run,
    /// Quantities that the study adds to those of the run; the default of a run without result.
    pub row: S::Row,
}

/// A row of the table: a cell with its results and, where it has a row for each of its references, the errors against one.
pub struct TableLine<'a, S: TabularStudy> {
    of: &'a Measured<S>,
    /// Errors against the reference of the row.
    pub metrics: Option<&'a Metrics>,
}

impl<'a, S: TabularStudy> TableLine<'a, S> {
    /// The only row of a cell.
    pub fn of(of: &'a Measured<S>) -> Self {
        TableLine { of, metrics: None }
    }

    /// The run of the cell.
    pub fn run(&self) -> &'a Run {
        &self.of.run
    }

    /// A row for each reference that the run of a cell is compared with; one row if there is none.
    pub fn of_references(of: &'a Measured<S>) -> Vec<Self> {
        match of.run.metrics.as_slice() {
            [] => vec![TableLine::of(of)],
            all => (all.iter().map(Some))
                .map(|metrics| TableLine { of, metrics })
                .collect(),
        }
    }
}

impl<S: TabularStudy> Deref for TableLine<'_, S> {
    type Target = Measured<S>;

    fn deref(&self) -> &Measured<S> {
        self.of
    }
}

/// Work that several cells of a study need: each piece is done once, and the journal stores it.
pub struct SharedWork<'a> {
    /// Conditions of all runs.
    pub conditions: &'a Conditions,
    /// Sampling times of the histories [s].
    pub grid: &'a [f64],
    runner: &'a Runner<'a>,
    known: Mutex<HashMap<Key, Arc<dyn Any + Send + Sync>>>,
}

impl SharedWork<'_> {
    /// Returns a piece of work, which is computed if neither memory nor journal has it.
    ///
    /// # Errors
    /// Errors of the work, and of the journal.
    pub fn piece<T>(
        &self,
        key: Key,
        make: impl FnOnce() -> Result<T, StudyError>,
    ) -> Result<Arc<T>, StudyError>
    where
        T: Serialize + DeserializeOwned + Send + Sync + 'static,
    {
        let known = lock(&self.known).get(&key).cloned();
        if let Some(Ok(found)) = known.map(Arc::downcast::<T>) {
            return Ok(found);
        }
        let made = Arc::new(self.runner.piece(key, make)?);
        lock(&self.known).insert(key, made.clone());
        Ok(made)
    }

    /// Begins a piece before the cells: reports it, and refuses it if the budget is spent.
    ///
    /// # Errors
    /// [`RunError::Reference`].
    pub fn begin(&self, what: &str) -> Result<(), RunError> {
        self.runner.report_progress(0, 0, what);
        match self.runner.budget().is_spent() {
            false => Ok(()),
            true => Err(RunError::Reference(format!(
                "the budget of {} was used up before the {what}; increase it (--budget)",
                self.runner.budget().described()
            ))),
        }
    }
}

/// Earlier cells and references of the scene, with which a cell is compared when it is measured.
pub struct Others<'a, S: TabularStudy> {
    /// Cells outside of all lines, for a cell of a line.
    pub common: &'a [Measured<S>],
    /// Cells that were measured before, of its line for a cell of a line.
    pub rows: &'a [Measured<S>],
    /// References of the scene, if the study compares with them ([`TabularStudy::compared`]).
    pub references: &'a [ReferenceSeries],
    /// Work that cells share.
    pub shared: &'a SharedWork<'a>,
}

/// A study whose results are one table.
///
/// Cells of a line run one after another, lines side by side ([`TabularStudy::line`]).
pub trait TabularStudy: Sized + Sync + 'static {
    /// Name of the command, of the folder and of the CSV file.
    const NAME: &'static str;
    /// Sentence on the rows of the table.
    const ROWS: &'static str;
    /// Remark below the table.
    const REMARK: &'static str = "";
    /// The exit code of a record.
    const EXIT: fn(&Results) -> Exit = Exit::of_every_run;
    /// Values that the study varies.
    type At: Clone + Debug + Send + Sync;
    /// Quantities of a cell that are not quantities of its run.
    type Row: Default + Serialize + DeserializeOwned + Send + Sync;

    /// The scene, by name or path.
    fn scene(&self) -> &str;
    /// The models of the scene that are built, as the study may run them.
    fn selection(&self) -> Selection<'_>;
    /// Where results go, and how long a run may take.
    fn options(&mut self) -> &mut BoundedOutput;
    /// Number of timed repeats of each run.
    fn repeats(&self) -> u32 {
        1
    }

    /// The line of a cell. Lines run in threads of their own, after the cells of no line.
    fn line(_at: &Self::At) -> Option<usize> {
        None
    }

    /// Number of lines that run at the same time.
    fn threads(&self) -> usize {
        1
    }

    /// Simulated time of the runs [s].
    fn duration(&self, scene: &SceneFile) -> f64 {
        scene.duration
    }

    /// How the references of the scene are taken, for a study that compares with them; contact events are located then.
    fn compared(&self) -> Option<&AnyReference> {
        None
    }

    /// Budget of processor time of the whole study; cells that do not begin within it are listed.
    fn budget(&self) -> Budget {
        Budget::unlimited()
    }

    /// Completes arguments by the defaults of the scene, and the scene by what they ask for, before cells are made.
    ///
    /// # Errors
    /// A refusal of arguments that do not fit the scene.
    fn prepare(
        &mut self,
        _scene: &mut SceneFile,
        _references: &[ReferenceSeries],
    ) -> Result<(), Refusal> {
        Ok(())
    }

    /// Returns the references that cells are compared with: those of the scene, and those that the study computes before
    /// its cells.
    ///
    /// # Errors
    /// [`StudyError`] where a reference does not reach its end.
    fn references(
        &self,
        of_scene: Vec<ReferenceSeries>,
        _shared: &SharedWork<'_>,
    ) -> Result<Vec<ReferenceSeries>, StudyError> {
        Ok(of_scene)
    }

    /// Returns the setting that lists a cell which is left out in view of the rows so far, and its text there.
    fn leaves_out(
        &self,
        _cell: &Cell<Self::At>,
        _rows: &[Measured<Self>],
    ) -> Option<(&'static str, String)> {
        None
    }

    /// Returns the rows of the table that a cell has.
    fn table_lines(cell: &Measured<Self>) -> Vec<TableLine<'_, Self>> {
        vec![TableLine::of(cell)]
    }

    /// Returns the columns that pages show because the arguments ask for them: key, heading and format.
    fn shown(&self) -> Vec<(&'static str, String, Format)> {
        Vec::new()
    }

    /// Returns name and value of the settings of the study, which the report lists with those of the scene.
    fn settings(&self, _scene: &SceneFile) -> Vec<(String, String)> {
        Vec::new()
    }

    /// Returns the cells in the order of the table.
    ///
    /// # Errors
    /// A refusal of arguments that do not fit the scene.
    fn cells(&self, scene: &SceneFile) -> Result<Vec<Cell<Self::At>>, Refusal>;

    /// Runs a cell and measures its quantities.
    ///
    /// # Errors
    /// [`StudyError`] where the model cannot run; a run that fails is a result.
    fn measure(
        &self,
        cell: &Cell<Self::At>,
        job: &Job<'_>,
        others: &Others<'_, Self>,
    ) -> Result<(Run, Self::Row), StudyError>;

    /// Returns a further cell that the results of a line, or of the cells of no line, ask for, as a search does.
    fn next(&self, _rows: &[Measured<Self>]) -> Option<Cell<Self::At>> {
        None
    }

    /// Returns tables that sum the rows up.
    fn summaries(&self, _rows: &[&Measured<Self>]) -> Vec<SummaryTable> {
        Vec::new()
    }

    /// Compares the cells with each other, and returns the histories that charts show as their references.
    fn compare(&self, _rows: &mut [Measured<Self>]) -> Vec<ReferenceSeries> {
        Vec::new()
    }

    /// The columns of the study; those of model, integrator, status and message are added.
    fn columns<'a>(columns: Columns<'a, TableLine<'a, Self>>) -> Columns<'a, TableLine<'a, Self>>;

    /// The charts over columns, of some rows.
    fn charts(&self, rows: &[&Measured<Self>]) -> Vec<TableChart>;

    /// The finding in plain words.
    fn finding(&self, rows: &[&Measured<Self>]) -> Vec<String>;
}

/// Returns all columns of a study.
pub fn columns<'a, S: TabularStudy>() -> Columns<'a, TableLine<'a, S>> {
    let file = format!("{}.csv", S::NAME);
    let rows = format!("`{}`: {}.", S::NAME, S::ROWS);
    let begin = Columns::<TableLine<'_, S>>::of(&file, &rows)
        .model(|f| f.run.model_label())
        .integrator(|f| f.run.integrator.clone())
        .shown("Integrator", Format::Text)
        .result();
    S::columns(begin)
        .status(|f| f.run.status)
        .shown("Status", Format::Text)
        .result()
        .step(|f| f.run.step)
        .shown("Step", Format::Numbers(3))
        .rtol(|f| f.run.rtol)
        .shown("Tolerance", Format::Powers)
        .message(|f| f.run.message.clone())
}

/// Runs a study and writes its folder.
///
/// # Errors
/// [`Refusal`] of the scene, the arguments or the folder.
pub fn run<S: TabularStudy + Clone>(
    context: &Context,
    args: &S,
    command: &str,
) -> Result<CommandResult, Refusal> {
    let mut args = args.clone();
    let options = args.options().clone();
    let mut scene = scene_file::load_for(context, args.scene(), args.selection())?;
    let references = match args.compared() {
        Some(insist) => references_of(&mut scene, insist)?,
        None => Vec::new(),
    };
    let further = Conditions::of(&scene).compared_with(&scene.spec, &references);
    let references = references.iter().map(|r| recorded(r, &scene.spec));
    let references: Vec<ReferenceSeries> = references.collect();
    args.prepare(&mut scene, &references)?;
    let cells = args.cells(&scene)?;
    let conditions = Conditions {
        command: command.to_string(),
        repeats: args.repeats(),
        timeout: options.timeout(),
        duration: args.duration(&scene),
        events: scene.study.events || args.compared().is_some(),
        ..further
    };
    let mut folder = StudyFolder::of(&options.output, &scene, S::NAME)?;
    let made = folder.run_within(args.budget(), cells.len(), |runner| {
        study(&args, &conditions, (&scene, references), cells, runner)
    });
    folder.finish(
        made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?,
        S::EXIT,
        summarise,
    )
}

/// Runs the cells of a study, and returns its record.
///
/// # Errors
/// [`StudyError`]; runs that fail are rows.
pub(crate) fn study<S: TabularStudy>(
    args: &S,
    conditions: &Conditions,
    (scene, references): (&SceneFile, Vec<ReferenceSeries>),
    cells: Vec<Cell<S::At>>,
    runner: &Runner<'_>,
) -> Result<Results, StudyError> {
    let grid = conditions.grid();
    let shared = SharedWork {
        conditions,
        grid: &grid,
        runner,
        known: Mutex::default(),
    };
    let references = args.references(references, &shared)?;
    let driver = Driver {
        args,
        shared: &shared,
        references: &references,
        of_references: Key::new("references").and(&references),
        left_out: Mutex::default(),
        runner,
        begun: AtomicUsize::new(0),
        count: AtomicUsize::new(cells.len()),
    };
    let (of_lines, common): (Vec<_>, Vec<_>) =
        (cells.into_iter()).partition(|cell| S::line(&cell.at).is_some());
    let mut lines: BTreeMap<Option<usize>, Vec<Cell<S::At>>> = BTreeMap::new();
    for cell in of_lines {
        lines.entry(S::line(&cell.at)).or_default().push(cell);
    }
    let lines: Vec<Vec<Cell<S::At>>> = lines.into_values().collect();
    let mut rows = driver.sequence(common, &[])?;
    let of_line: Vec<Mutex<Vec<Measured<S>>>> = lines.iter().map(|_| Mutex::default()).collect();
    let places: Vec<usize> = (0..lines.len()).collect();
    in_parallel(args.threads(), &places, |&i| {
        *lock(&of_line[i]) = driver.sequence(lines[i].clone(), &rows)?;
        Ok::<_, StudyError>(())
    })?;
    for made in of_line {
        rows.append(&mut lock(&made));
    }
    let (left_out, refusal) = lock(&driver.left_out).take();
    if let (true, Some(e)) = (rows.is_empty(), refusal) {
        return Err(e.into());
    }
    let mut compared = args.compare(&mut rows);
    compared.extend_from_slice(&references);
    for row in &mut rows {
        decimate_run(&mut row.run, &[]);
    }
    runner.report_progress(rows.len(), rows.len(), "report");
    let table = table(args, scene, &rows);
    let is_run = |m: &&ModelChoice| rows.iter().any(|r| r.cell.configuration.label == m.label);
    let chosen: Vec<&ModelChoice> = scene.models.iter().filter(is_run).collect();
    let mut settings = settings(scene, &chosen, false);
    let own = std::iter::once(simulated_time(conditions.duration)).chain(args.settings(scene));
    for (what, text) in own {
        match settings.iter_mut().find(|(w, _)| *w == what) {
            Some(row) => row.1 = text,
            None => settings.push((what, text)),
        }
    }
    settings.extend(
        left_out
            .into_iter()
            .map(|(what, text)| match what.as_str() {
                NOT_TRIED => (what, format!("{}: {text}", runner.budget().described())),
                _ => (what, text),
            }),
    );
    Ok(Results {
        references: compared,
        settings,
        runs: rows.into_iter().map(|row| row.run).collect(),
        ..conditions.record(Part::Tabular(table))
    })
}

/// The state that the cells of a study share while they run.
struct Driver<'a, S> {
    args: &'a S,
    shared: &'a SharedWork<'a>,
    references: &'a [ReferenceSeries],
    /// Key of the references, on which cells depend.
    of_references: Key,
    left_out: Mutex<LeftOut>,
    runner: &'a Runner<'a>,
    /// Number of cells that have begun.
    begun: AtomicUsize,
    /// Number of cells that are known so far.
    count: AtomicUsize,
}

/// Cells that were left out.
#[derive(Default)]
struct LeftOut {
    /// Settings that list them.
    settings: Vec<(String, String)>,
    /// Label of the model and method that do not fit together.
    pairs: Vec<(String, MethodSpec)>,
    /// The first refusal of a method by a model.
    refusal: Option<RunError>,
}

impl LeftOut {
    /// Adds a text to a setting, once.
    fn add(&mut self, what: &str, text: String) {
        match self.settings.iter_mut().find(|(w, _)| w == what) {
            Some((_, all)) if all.contains(&text) => {}
            Some((_, all)) => {
                all.push_str("; ");
                all.push_str(&text);
            }
            None => self.settings.push((what.to_owned(), text)),
        }
    }

    fn take(&mut self) -> (Vec<(String, String)>, Option<RunError>) {
        (std::mem::take(&mut self.settings), self.refusal.take())
    }
}

impl<S: TabularStudy> Driver<'_, S> {
    /// True if a cell is left out, which a setting of the record then lists.
    fn leaves_out(&self, cell: &Cell<S::At>, rows: &[Measured<S>]) -> bool {
        let mut left_out = lock(&self.left_out);
        let is_of = |(label, method): &(String, MethodSpec)| {
            *label == cell.configuration.label && *method == cell.method.method
        };
        if left_out.pairs.iter().any(is_of) {
            return true;
        }
        let budget = self.runner.budget();
        let found = match budget.is_spent() {
            true => Some((
                NOT_TRIED,
                format!("{}, {}", cell.configuration.label, cell.name),
            )),
            false => self.args.leaves_out(cell, rows),
        };
        let is_left_out = found.is_some();
        if let Some((what, text)) = found {
            left_out.add(what, text);
        }
        is_left_out
    }

    /// Runs cells one after another, and those that their results ask for.
    fn sequence(
        &self,
        cells: Vec<Cell<S::At>>,
        common: &[Measured<S>],
    ) -> Result<Vec<Measured<S>>, StudyError> {
        let mut rows: Vec<Measured<S>> = Vec::with_capacity(cells.len());
        let mut open = VecDeque::from(cells);
        loop {
            // Results that an interruption prevented ask for nothing.
            let further = || {
                let stopped = (rows.last()).is_some_and(|r| r.run.status == Status::Interrupted);
                let found = (!stopped).then(|| self.args.next(&rows)).flatten();
                found.inspect(|_| {
                    self.count.fetch_add(1, Ordering::Relaxed);
                })
            };
            let Some(cell) = open.pop_front().or_else(further) else {
                return Ok(rows);
            };
            if self.leaves_out(&cell, &rows) {
                self.count.fetch_sub(1, Ordering::Relaxed);
                continue;
            }
            let others = Others {
                common,
                rows: &rows,
                references: self.references,
                shared: self.shared,
            };
            let pair = (cell.configuration.label.clone(), cell.method.method);
            match self.cell(cell, &others) {
                // Not every method is for every model; the record says which pairs it has not.
                Err(StudyError::Run(e)) if e.leaves_out() => {
                    let mut left_out = lock(&self.left_out);
                    left_out.add(LEFT_OUT, format!("{} under {}: {e}", pair.0, pair.1));
                    left_out.pairs.push(pair);
                    left_out.refusal.get_or_insert(e);
                }
                row => rows.push(row?),
            }
        }
    }

    fn cell(&self, cell: Cell<S::At>, others: &Others<'_, S>) -> Result<Measured<S>, StudyError> {
        let what = format!("{}, {}", cell.configuration.label, cell.name);
        let begun = self.begun.fetch_add(1, Ordering::Relaxed);
        (self.runner).report_progress(begun, self.count.load(Ordering::Relaxed), &what);
        let of = (&cell.configuration.scene, &cell.configuration.modelling);
        let job = Job {
            histories: true,
            ..(self.shared.conditions).job(of, &cell.method, self.shared.grid)
        };
        let mut key = job.key().and(&(S::NAME, &cell.at));
        if !self.references.is_empty() {
            key = key.and(&self.of_references);
        }
        let make = || self.args.measure(&cell, &job, others);
        let (mut run, row) = self.runner.row_with(key, &cell.method, make)?;
        run.end_s = Some(job.t_end);
        cell.configuration.sign(&mut run);
        run.variant = cell.variant.clone().or(run.variant);
        self.runner.reserve_memory(&run);
        Ok(Measured { cell, run, row })
    }
}

/// Returns the table of the cells, with finding and charts.
fn table<S: TabularStudy>(args: &S, scene: &SceneFile, rows: &[Measured<S>]) -> TabularRecord {
    // Cells that an interruption prevented are no rows.
    let finished: Vec<&Measured<S>> = (rows.iter())
        .filter(|row| row.run.status != Status::Interrupted)
        .collect();
    let columns = columns::<S>();
    let mut recorded = columns.recorded();
    for (key, heading, format) in args.shown() {
        if let Some(column) = recorded.iter_mut().find(|c| c.key == key) {
            column.show(heading, format);
        }
    }
    let of_refused = |r: &RefusedModel| {
        TableRow::of([
            (MODEL.into(), r.label.as_str().into()),
            (STATUS.into(), Status::Refused.into()),
            (MESSAGE.into(), r.error.to_text().into()),
        ])
    };
    TabularRecord {
        name: S::NAME.into(),
        rows_are: S::ROWS.into(),
        finding: args.finding(&finished),
        columns: recorded,
        rows: (finished.iter().flat_map(|f| S::table_lines(f)))
            .map(|line| columns.recorded_row(&line))
            .chain(scene.refused.iter().map(of_refused))
            .collect(),
        summaries: args.summaries(&finished),
        remark: S::REMARK.into(),
        charts: args.charts(&finished),
        ..TabularRecord::default()
    }
}

/// Prints the finding and the table.
fn summarise(messages: &Messages, results: &Results) {
    let Part::Tabular(table) = &results.part else {
        return;
    };
    for line in table.lines().iter().chain(&table.finding) {
        messages.print_line(line);
    }
    let told = |what: &str| [LEFT_OUT, NOT_TRIED].contains(&what);
    for (what, which) in results.settings.iter().filter(|(what, _)| told(what)) {
        messages.print_line(&format!("{what}: {which}"));
    }
}
