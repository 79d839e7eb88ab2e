//! Errors as exceptions: the text of the command line with line and help, and the parts as attributes.
//!
//! The classes are those of `gearbench.errors`, which Python code declares.

use gearbench::cli::exit::Exit;
use gearbench::cli::terminal::Refusal;
use gearbench::cli::terminal::refuse_run;
use gearbench::experiment::run::RunError;
use gearbench::scene_file::SceneError;
use miette::Report;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A scene or an argument that is refused, without a place in a file.
pub fn input_error(py: Python<'_>, message: &str, help: &str) -> PyErr {
    scene_error(py, &SceneError::plain(message, help))
}

/// The exception of a scene that is refused.
pub fn scene_error(py: Python<'_>, e: &SceneError) -> PyErr {
    let text = format!("{:?}", Report::new(e.clone()));
    raised(py, "SceneError", &text, |known| {
        known.set_item("message", e.message())?;
        known.set_item("line", e.line())?;
        known.set_item("help", e.help_text())
    })
}

/// The exception of a study that ends without result.
pub fn refusal(py: Python<'_>, refusal: Refusal) -> PyErr {
    let (exit, report) = refusal.into_report();
    let class = match exit {
        Exit::BadInput => "SceneError",
        Exit::Interrupted => "Interrupted",
        _ => "RunFailed",
    };
    // Errors of a scene have labels, and their report shows the line.
    let text = format!("{report:?}");
    let line = place(&report);
    raised(py, class, &text, |known| {
        known.set_item("message", report.to_string())?;
        known.set_item("line", line)?;
        known.set_item("help", report.help().map(|h| h.to_string()))
    })
}

/// The exception of a run that could not begin, or was interrupted.
pub fn run_error(py: Python<'_>, e: RunError) -> PyErr {
    refusal(py, refuse_run(e))
}

/// Line of the first label of an error, from 1.
fn place(report: &Report) -> Option<usize> {
    let label = report.labels()?.next()?;
    let source = report.source_code()?.read_span(label.inner(), 0, 0).ok()?;
    Some(source.line() + 1)
}

fn raised(
    py: Python<'_>,
    class: &str,
    text: &str,
    attributes: impl FnOnce(&Bound<'_, PyDict>) -> PyResult<()>,
) -> PyErr {
    let made = || {
        let known = PyDict::new(py);
        attributes(&known)?;
        let class = py.import("gearbench.errors")?.getattr(class)?;
        class.call((text.trim_end(),), Some(&known))
    };
    made().map_or_else(|e| e, PyErr::from_value)
}
