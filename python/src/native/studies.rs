//! Studies by name with the arguments of the command line, in a thread of their own.
//!
//! The thread of Python waits without the interpreter lock and looks for signals: Ctrl-C requests the interruption of the
//! study, which ends with the pieces that are finished. A study that does not end within [`PATIENCE`], since it builds a
//! model, is left to end by itself, without effect.

use super::errors::{input_error, refusal};
use super::laws::{Failures, GivenLaw, with_laws};
use super::records::Classes;
use super::scenes::context;
use gearbench::cli::command_result::CommandResult;
use gearbench::cli::terminal::Refusal;
use gearbench::cli::{ArgumentKind, studies, study};
use gearbench::context::{ProgressObserver, RecordUse};
use gearbench::experiment::parallel::lock;
use gearbench_reports::record::Results;
use gearbench_reports::scan::ScanIdentity;
use gearbench_reports::series::{Column, TimeSeries};
use gearbench_reports::write_results;
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Time between two looks for signals.
const EVERY: Duration = Duration::from_millis(20);
/// Time in which an interrupted study ends in general.
const PATIENCE: Duration = Duration::from_secs(2);
/// Stack of the thread of a study [bytes], that of the main thread of a command.
const STACK: usize = 8 << 20;
/// Shortest time between two reports of progress.
const REPORTED_EVERY: Duration = Duration::from_millis(50);

/// Time axis and columns of a series that Python gives back for a report.
type ReturnedSeries<'py> = (PyReadonlyArray1<'py, f64>, Bound<'py, PyDict>);

/// A record that a study has returned, for its report. Histories at full resolution are arrays of Python.
#[pyclass(module = "gearbench._native", frozen)]
struct Record {
    results: Mutex<Results>,
}

#[pymethods]
impl Record {
    /// Writes the folder of the study: report, record, tables and histories. `series` has time and columns of each run of
    /// each scene, or None.
    fn report(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        series: Vec<Vec<Option<ReturnedSeries<'_>>>>,
    ) -> PyResult<String> {
        let mut results = lock(&self.results).clone();
        let runs = (results.runs_mut().zip(series)).flat_map(|(runs, of)| runs.iter_mut().zip(of));
        for (run, series) in runs {
            let (Some(histories), Some((time, columns))) = (&mut run.histories, series) else {
                continue;
            };
            let mut all = Vec::with_capacity(columns.len());
            for (name, values) in columns {
                let values: PyReadonlyArray1<'_, f64> = values.extract()?;
                all.push(Column::new(
                    name.extract::<String>()?,
                    values.as_array().to_vec(),
                ));
            }
            let whole = TimeSeries::new(time.as_array().to_vec(), all)
                .map_err(|e| input_error(py, &e, "hand the histories of the run over unchanged"))?;
            histories.series = Some(whole);
        }
        let written = py.detach(|| {
            std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
            write_results(&folder, &results).map_err(|e| e.to_string())
        });
        let page = written.map_err(PyOSError::new_err)?;
        Ok(page.display().to_string())
    }
}

/// Passes progress on to a function of Python; an exception there ends the study.
struct Observer {
    callback: Py<PyAny>,
    failure: Arc<Mutex<Option<PyErr>>>,
    last: Mutex<Option<Instant>>,
    interruption: gearbench::experiment::interruption::Interruption,
}

impl Observer {
    fn report(&self, done: usize, total: usize, what: &str) {
        {
            let mut last = lock(&self.last);
            let early = last.is_some_and(|t| t.elapsed() < REPORTED_EVERY);
            if early && (total == 0 || done < total) {
                return;
            }
            *last = Some(Instant::now());
        }
        // Without an interpreter there is nobody to report to.
        Python::try_attach(|py| {
            if let Err(e) = self.callback.call1(py, (done, total, what)) {
                let mut failure = lock(&self.failure);
                failure.get_or_insert(e);
                self.interruption.request();
            }
        });
    }
}

/// The result that the thread of a study sends.
type Ended = Result<CommandResult, Refusal>;

/// Runs a study by the words of its command line, in scenes of names and texts. Returns a dictionary: fields of the record,
/// the record for its report, exit code and meaning, warnings, other results of the command, and the exception
/// that ended it early.
#[pyfunction]
#[pyo3(signature = (words, scenes, progress=None, laws=vec![]))]
fn run_study<'py>(
    py: Python<'py>,
    words: Vec<String>,
    scenes: Vec<(String, String)>,
    progress: Option<Py<PyAny>>,
    laws: Vec<GivenLaw>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut context = context();
    let has_laws = !laws.is_empty();
    let failures = Arc::new(Failures::of_study(context.interruption.clone()));
    context = with_laws(context, laws, &failures);
    for (name, text) in &scenes {
        context = context.with_scene(name, text);
    }
    context.record = RecordUse::Returned;
    let failure: Arc<Mutex<Option<PyErr>>> = Arc::default();
    if let Some(callback) = progress {
        let observer = Observer {
            callback,
            failure: failure.clone(),
            last: Mutex::new(None),
            interruption: context.interruption.clone(),
        };
        context.progress = Some(ProgressObserver(Arc::new(move |done, total, what| {
            observer.report(done, total, what);
        })));
    }
    let (send, ended) = channel::<Ended>();
    let ended = Mutex::new(ended);
    let own = context.clone();
    std::thread::Builder::new()
        .name("gearbench study".into())
        .stack_size(STACK)
        .spawn(move || {
            // The receiver is gone where the study was left alone.
            let _ = send.send(if has_laws {
                // The thread stays known to the interpreter between two calls of a law.
                Python::attach(|py| py.detach(|| study(own, &words)))
            } else {
                study(own, &words)
            });
        })
        .map_err(|e| PyRuntimeError::new_err(format!("no thread could be started: {e}")))?;
    let mut stopped: Option<(PyErr, Instant)> = None;
    let ended = loop {
        match py.detach(|| lock(&ended).recv_timeout(EVERY)) {
            Ok(ended) => break ended,
            Err(RecvTimeoutError::Disconnected) => {
                let why =
                    "the program itself failed in this study; please report it with the scene";
                return Err(refusal(py, Refusal::Failed(why.into())));
            }
            Err(RecvTimeoutError::Timeout) => match &stopped {
                None => {
                    if let Err(e) = py.check_signals() {
                        context.interruption.request();
                        stopped = Some((e, Instant::now()));
                    }
                }
                Some((_, since)) if since.elapsed() > PATIENCE => break Err(Refusal::Interrupted),
                Some(_) => {}
            },
        }
    };
    let mut failure = lock(&failure);
    let stopped = (failures.take_first())
        .or_else(|| failure.take())
        .or(stopped.map(|(e, _)| e));
    match (ended, stopped) {
        (Ok(result), stopped) => returned(py, result, context.messages.warnings(), stopped),
        (Err(_), Some(e)) => Err(e),
        (Err(e), None) => Err(refusal(py, e)),
    }
}

fn returned(
    py: Python<'_>,
    mut result: CommandResult,
    warnings: Vec<String>,
    stopped: Option<PyErr>,
) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("exit_code", result.exit.code())?;
    all.set_item("exit_meaning", result.exit.meaning())?;
    all.set_item("warnings", warnings)?;
    all.set_item("stopped", stopped)?;
    for key in ["scene", "written", "report", "record"] {
        if let Some(value) = result.get(key).and_then(serde_json::Value::as_str) {
            all.set_item(key, value)?;
        }
    }
    let classes = Classes::of(py)?;
    all.set_item("answer", classes.convert(result.keys())?)?;
    if let Some(mut record) = result.record.take() {
        all.set_item("fields", fields(py, &classes, &mut record)?)?;
        let results = Mutex::new(*record);
        all.set_item("native", Record { results }.into_pyobject(py)?)?;
    }
    Ok(all)
}

/// Returns the fields of a record, those of its further scenes in the list of their key; histories are handed over.
fn fields<'py>(
    py: Python<'py>,
    classes: &Classes<'py>,
    record: &mut Results,
) -> PyResult<Bound<'py, PyAny>> {
    let runs = record.runs.iter_mut().map(|run| classes.run(run));
    let runs = PyList::new(py, runs.collect::<PyResult<Vec<_>>>()?)?;
    let further = (record.further.iter_mut()).map(|scene| fields(py, classes, scene));
    let further = PyList::new(py, further.collect::<PyResult<Vec<_>>>()?)?;
    let own = (
        std::mem::take(&mut record.runs),
        std::mem::take(&mut record.further),
    );
    let made = classes.convert(&*record)?;
    (record.runs, record.further) = own;
    made.set_item("runs", runs)?;
    made.set_item("further", further)?;
    Ok(made)
}

/// Returns program, hash of the scene and options that the cells of a scan are computed from, by the words of its command
/// line.
#[pyfunction]
fn scan_identity(
    py: Python<'_>,
    words: Vec<String>,
    name: &str,
    text: &str,
) -> PyResult<(String, String, String)> {
    let context = context().with_scene(name, text);
    let found = py.detach(|| gearbench::cli::scan_identity(&context, &words));
    let ScanIdentity {
        program,
        scene,
        arguments,
    } = found.map_err(|e| refusal(py, e))?;
    Ok((program, scene, arguments))
}

/// Describes all studies: name, purpose, and name, meaning, default, kind, position and repetition of each argument.
#[pyfunction]
fn study_arguments(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let all = studies().into_iter().map(|study| {
        let arguments: Vec<_> = (study.arguments.into_iter())
            .map(|a| {
                let kind = match a.kind {
                    ArgumentKind::Flag => "flag",
                    ArgumentKind::Whole => "int",
                    ArgumentKind::Number => "float",
                    ArgumentKind::Text => "str",
                };
                (
                    a.name,
                    a.help,
                    a.default,
                    kind,
                    a.is_positional,
                    a.is_repeated,
                )
            })
            .collect();
        (study.name, study.about, arguments).into_pyobject(py)
    });
    PyList::new(py, all.collect::<PyResult<Vec<_>>>()?)
}

/// Adds the functions and classes to the module.
///
/// # Errors
/// Errors of Python.
pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Record>()?;
    module.add_function(wrap_pyfunction!(run_study, module)?)?;
    module.add_function(wrap_pyfunction!(scan_identity, module)?)?;
    module.add_function(wrap_pyfunction!(study_arguments, module)?)
}
