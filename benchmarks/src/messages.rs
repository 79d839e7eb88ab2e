//! The only writer to standard output and standard error.
//!
//! Standard output contains the result: lines of text, or one JSON object (`--json`), or nothing (`--quiet`). Standard
//! error contains refusals, warnings and progress. A closed pipe (`gearbench list | head -1`) ends the output but not
//! the command, whose files and exit code stay the same. A full disk behind standard output is an error, and so is a
//! JSON object that cannot be written.

use gearbench_reports::escape;
use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Form of the output: text, nothing, or JSON.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutputForm {
    /// Lines of text for a human reader.
    #[default]
    Lines,
    /// No output: files, warnings and the exit code only.
    Quiet,
    /// One JSON object for a program.
    Json,
}

/// Output and warnings of a command or a study; a clone writes to the same place.
#[derive(Clone, Debug, Default)]
pub struct Messages {
    /// Form of the output.
    pub form: OutputForm,
    /// The first write error; nothing is written after it.
    failed: Arc<Mutex<Option<io::Error>>>,
    /// Warnings so far, each text once.
    warnings: Arc<Mutex<Vec<String>>>,
}

impl Messages {
    /// Prints a line of text to standard output, escaped by [`escape::terminal`]; without effect for JSON and quiet
    /// output.
    pub fn print_line(&self, text: &str) {
        if self.form == OutputForm::Lines {
            self.print_text(&escape::terminal(text));
        }
    }

    /// Prints text to standard output in every form of output.
    pub fn print_text(&self, text: &str) {
        let mut failed = lock(&self.failed);
        if failed.is_none() {
            let mut out = io::stdout().lock();
            *failed = writeln!(out, "{text}").and_then(|()| out.flush()).err();
        }
    }

    /// Prints a warning to standard error, or keeps it for the JSON object; each text once.
    pub fn warn(&self, text: &str) {
        let mut warnings = lock(&self.warnings);
        if warnings.iter().any(|w| w == text) {
            return;
        }
        warnings.push(text.to_owned());
        if self.form != OutputForm::Json {
            print_error(&format!("warning: {text}"));
        }
    }

    /// The warnings so far.
    pub fn warnings(&self) -> Vec<String> {
        lock(&self.warnings).clone()
    }

    /// Stores the first write error.
    pub(crate) fn fail(&self, e: io::Error) {
        lock(&self.failed).get_or_insert(e);
    }

    /// Returns the first write error.
    pub(crate) fn take_failure(&self) -> Option<io::Error> {
        lock(&self.failed).take()
    }
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Prints a line of text to standard error, escaped by [`escape::terminal`].
pub(crate) fn print_error(text: &str) {
    put_error(&escape::terminal(text));
}

/// Writes text to standard error; write errors are ignored.
pub(crate) fn put_error(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}
