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
use crate::experiment::reference_series::recorded;
use crate::experiment::run::Job;
use crate::experiment::runner::Runner;
use crate::experiment::settings::settings;
use crate::messages::Messages;
use crate::scene_file::{self, ModelChoice, RefusedModel, SceneFile, Selection};
use gearbench_integrators::Scheme;
use gearbench_reports::Format;
use gearbench_reports::columns::Columns;
use gearbench_reports::record::{Part, ReferenceSeries, Results, Run, Status};
use gearbench_reports::tabular::{MESSAGE, MODEL, STATUS, TableChart, TableRow, TabularRecord};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::VecDeque;
use std::fmt::Debug;

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
    /// Cells that were measured before.
    pub rows: &'a [Measured<S>],
    /// References of the scene, if the study compares with them ([`TabularStudy::compared`]).
    pub references: &'a [ReferenceSeries],
}

/// A study whose results are one table.
pub trait TabularStudy: Sized + 'static {
    /// Name of the command, of the folder and of the CSV file.
    const NAME: &'static str;
    /// Sentence on the rows of the table.
    const ROWS: &'static str;
    /// Remark below the table.
    const REMARK: &'static str = "";
    /// The exit code of a record.
    const EXIT: fn(&Results) -> Exit = Exit::of_every_run;
    /// Values that the study varies.
    type At: Clone + Debug;
    /// Quantities of a cell that are not quantities of its run.
    type Row: Default + Serialize + DeserializeOwned;

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

    /// Returns a further cell that the results so far ask for, as a search does.
    fn next(&self, _rows: &[Measured<Self>]) -> Option<Cell<Self::At>> {
        None
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

fn study<S: TabularStudy>(
    args: &S,
    conditions: &Conditions,
    (scene, references): (&SceneFile, Vec<ReferenceSeries>),
    cells: Vec<Cell<S::At>>,
    runner: &Runner<'_>,
) -> Result<Results, StudyError> {
    let grid = conditions.grid();
    let mut rows: Vec<Measured<S>> = Vec::with_capacity(cells.len());
    let mut open = VecDeque::from(cells);
    loop {
        // Results that an interruption prevented ask for nothing.
        let further = || {
            let stopped = (rows.last()).is_some_and(|r| r.run.status == Status::Interrupted);
            (!stopped).then(|| args.next(&rows)).flatten()
        };
        let Some(cell) = open.pop_front().or_else(further) else {
            break;
        };
        let what = format!("{}, {}", cell.configuration.label, cell.name);
        runner.report_progress(rows.len(), rows.len() + open.len() + 1, &what);
        let of = (&cell.configuration.scene, &cell.configuration.modelling);
        let job = Job {
            histories: true,
            ..conditions.job(of, &cell.method, &grid)
        };
        let mut key = job.key().and(&(S::NAME, &cell.at));
        if !references.is_empty() {
            key = key.and(&references);
        }
        let others = Others {
            rows: &rows,
            references: &references,
        };
        let make = || args.measure(&cell, &job, &others);
        let (mut run, row) = runner.row_with(key, &cell.method, make)?;
        run.end_s = Some(job.t_end);
        cell.configuration.sign(&mut run);
        run.variant = cell.variant.clone().or(run.variant);
        runner.reserve_memory(&run);
        rows.push(Measured { cell, run, row });
    }
    let mut compared = args.compare(&mut rows);
    compared.extend(references);
    for row in &mut rows {
        decimate_run(&mut row.run, &[]);
    }
    runner.report_progress(rows.len(), rows.len(), "report");
    let table = table(args, scene, &rows);
    let is_run = |m: &&ModelChoice| rows.iter().any(|r| r.cell.configuration.label == m.label);
    let chosen: Vec<&ModelChoice> = scene.models.iter().filter(is_run).collect();
    let mut settings = settings(scene, &chosen, false);
    settings.extend(args.settings(scene));
    Ok(Results {
        references: compared,
        settings,
        runs: rows.into_iter().map(|row| row.run).collect(),
        ..conditions.record(Part::Tabular(table))
    })
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
