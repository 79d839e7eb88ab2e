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
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::decimation::decimate_run;
use crate::experiment::error::StudyError;
use crate::experiment::parallel::{in_parallel, lock};
use crate::experiment::reference_series::recorded;
use crate::experiment::run::Job;
use crate::experiment::runner::Runner;
use crate::experiment::settings::{settings, simulated_time};
use crate::messages::Messages;
use crate::scene_file::{self, ModelChoice, RefusedModel, SceneFile, Selection};
use gearbench_integrators::Scheme;
use gearbench_reports::Format;
use gearbench_reports::columns::Columns;
use gearbench_reports::record::{Part, ReferenceSeries, Results, Run, Status};
use gearbench_reports::tabular::{
    MESSAGE, MODEL, STATUS, SummaryTable, TableChart, TableRow, TabularRecord,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, VecDeque};
use std::fmt::Debug;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

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

/// Earlier cells and references of the scene, with which a cell is compared when it is measured.
pub struct Others<'a, S: TabularStudy> {
    /// Cells outside of all lines, for a cell of a line.
    pub common: &'a [Measured<S>],
    /// Cells that were measured before, of its line for a cell of a line.
    pub rows: &'a [Measured<S>],
    /// References of the scene, if the study compares with them ([`TabularStudy::compared`]).
    pub references: &'a [ReferenceSeries],
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
    fn columns<'a>(columns: Columns<'a, &'a Measured<Self>>) -> Columns<'a, &'a Measured<Self>>;

    /// The charts over columns.
    fn charts(&self) -> Vec<TableChart>;

    /// The finding in plain words.
    fn finding(&self, rows: &[&Measured<Self>]) -> Vec<String>;
}

/// Returns all columns of a study.
pub fn columns<'a, S: TabularStudy>() -> Columns<'a, &'a Measured<S>> {
    let file = format!("{}.csv", S::NAME);
    let rows = format!("`{}`: {}.", S::NAME, S::ROWS);
    let begin = Columns::<&Measured<S>>::of(&file, &rows)
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
    let cells = args.cells(&scene)?;
    let conditions = Conditions {
        command: command.to_string(),
        repeats: args.repeats(),
        timeout: options.timeout(),
        duration: args.duration(&scene),
        events: scene.study.events || args.compared().is_some(),
        ..Conditions::of(&scene).compared_with(&scene.spec, &references)
    };
    let references = references.iter().map(|r| recorded(r, &scene.spec));
    let references: Vec<ReferenceSeries> = references.collect();
    let mut folder = StudyFolder::of(&options.output, &scene, S::NAME)?;
    let made = folder.run(cells.len(), |runner| {
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
    let driver = Driver {
        args,
        conditions,
        grid: conditions.grid(),
        references: &references,
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
    let time = simulated_time(conditions.duration);
    (settings.iter_mut().filter(|(what, _)| *what == time.0))
        .for_each(|row| row.1.clone_from(&time.1));
    settings.extend(args.settings(scene));
    Ok(Results {
        references: compared,
        settings,
        runs: rows.into_iter().map(|row| row.run).collect(),
        ..conditions.record(Part::Tabular(table))
    })
}

/// What the cells of a study share while they run.
struct Driver<'a, S> {
    args: &'a S,
    conditions: &'a Conditions,
    grid: Vec<f64>,
    references: &'a [ReferenceSeries],
    runner: &'a Runner<'a>,
    /// Number of cells that have begun.
    begun: AtomicUsize,
    /// Number of cells that are known so far.
    count: AtomicUsize,
}

impl<S: TabularStudy> Driver<'_, S> {
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
            let others = Others {
                common,
                rows: &rows,
                references: self.references,
            };
            let row = self.cell(cell, &others)?;
            rows.push(row);
        }
    }

    fn cell(&self, cell: Cell<S::At>, others: &Others<'_, S>) -> Result<Measured<S>, StudyError> {
        let what = format!("{}, {}", cell.configuration.label, cell.name);
        let begun = self.begun.fetch_add(1, Ordering::Relaxed);
        (self.runner).report_progress(begun, self.count.load(Ordering::Relaxed), &what);
        let of = (&cell.configuration.scene, &cell.configuration.modelling);
        let job = Job {
            histories: true,
            ..self.conditions.job(of, &cell.method, &self.grid)
        };
        let mut key = job.key().and(&(S::NAME, &cell.at));
        if !self.references.is_empty() {
            key = key.and(&self.references);
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
        columns: columns.recorded(),
        rows: (finished.iter().map(|f| columns.recorded_row(f)))
            .chain(scene.refused.iter().map(of_refused))
            .collect(),
        summaries: args.summaries(&finished),
        remark: S::REMARK.into(),
        charts: args.charts(),
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
}
