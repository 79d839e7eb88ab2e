//! Errors in scene files: message, place in the file, and help.

use miette::{Diagnostic, LabeledSpan, NamedSource};
use std::ops::Range;
use std::sync::Arc;

/// Largest number of warnings that an error repeats.
const MOST_REMARKS: usize = 3;

/// Error in a scene file. `miette` renders it with file, line and help.
#[derive(Clone, Debug, thiserror::Error, Diagnostic)]
#[error("{message}")]
pub struct SceneError {
    message: String,
    #[help]
    help: Option<String>,
    /// Labelled places; the line of the first one is part of the heading.
    #[label(collection)]
    labels: Vec<LabeledSpan>,
    #[source_code]
    source_code: Option<Arc<NamedSource<String>>>,
}

impl SceneError {
    /// Creates an error without a place in a file.
    pub fn plain(message: impl Into<String>, help: impl Into<String>) -> Self {
        SceneError {
            message: message.into(),
            help: Some(help.into()),
            labels: Vec::new(),
            source_code: None,
        }
    }

    /// Combines several errors: the first with its place, the others as lines of its help.
    pub fn all_of(errors: impl IntoIterator<Item = SceneError>) -> Self {
        let mut errors = errors.into_iter();
        let Some(mut first) = errors.next() else {
            return SceneError::plain("nothing can run", "");
        };
        let others: Vec<String> = errors.map(|e| e.to_text()).collect();
        if !others.is_empty() {
            let help = first.help.take().unwrap_or_default();
            let others = others.join("\n");
            first.help = Some(format!(
                "{help}\nthe other models cannot run either: {others}"
            ));
        }
        first
    }

    /// The message, without place and help.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The help: how to correct the file.
    pub fn help_text(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Formats the error in one line: file and line, message, help.
    pub fn to_text(&self) -> String {
        let place = match (&self.source_code, self.line()) {
            (Some(source), Some(line)) => format!("{}:{line}: ", source.name()),
            _ => String::new(),
        };
        let help = self
            .help
            .as_deref()
            .map_or(String::new(), |h| format!("; {h}"));
        format!("{place}{}{help}", self.message)
    }

    /// Line of the first label, from 1, if the error has a place.
    pub fn line(&self) -> Option<usize> {
        let text = self.source_code.as_ref()?.inner();
        let start = self.labels.first()?.offset().min(text.len());
        let breaks = text.as_bytes()[..start].iter().filter(|&&b| b == b'\n');
        Some(breaks.count() + 1)
    }

    /// Adds the warnings about the file to the help, as they may be the cause: those about the same line, else the
    /// first ones.
    #[must_use]
    pub(super) fn with_remarks(mut self, odd: &[SceneError]) -> Self {
        let own = self.line();
        let same: Vec<&SceneError> = odd.iter().filter(|o| o.line() == own).collect();
        let remarks: Vec<String> = match same.as_slice() {
            [] => (odd.iter().take(MOST_REMARKS))
                .map(SceneError::in_one_line)
                .collect(),
            same => same.iter().filter_map(|o| o.help.clone()).collect(),
        };
        let help = self.help.take().into_iter();
        let all: Vec<String> = match same.is_empty() {
            true => help.chain(remarks).collect(),
            false => remarks.into_iter().chain(help).collect(),
        };
        self.help = (!all.is_empty()).then(|| all.join("; "));
        self
    }

    fn in_one_line(&self) -> String {
        let line = self
            .line()
            .map_or(String::new(), |line| format!("line {line}: "));
        let help = self.help.as_deref().unwrap_or(&self.message);
        format!("{line}{help}")
    }

    /// Adds a label at a further place of the file.
    pub(super) fn and(mut self, span: Range<usize>, label: impl Into<String>) -> Self {
        if let Some(source) = &self.source_code {
            let span = inside(span, source.inner());
            let label = LabeledSpan::new_with_span(Some(label.into()), span);
            self.labels.push(label);
        }
        self
    }
}

/// A file that is read, as origin of errors: name and text.
#[derive(Clone, Debug)]
pub(super) struct Source {
    named: Arc<NamedSource<String>>,
}

impl Source {
    pub(super) fn new(name: &str, text: &str) -> Self {
        Source {
            named: Arc::new(NamedSource::new(name, text.to_owned())),
        }
    }

    pub(super) fn name(&self) -> &str {
        self.named.name()
    }

    pub(super) fn text(&self) -> &str {
        self.named.inner()
    }

    /// Creates an error at a place, with message, label and help.
    pub(super) fn error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        let help = help.into();
        let span = inside(span, self.text());
        SceneError {
            message: message.into(),
            help: (!help.is_empty()).then_some(help),
            labels: vec![LabeledSpan::new_primary_with_span(Some(label.into()), span)],
            source_code: Some(self.named.clone()),
        }
    }
}

/// Cuts a span to the text and to its first line, as a label over a whole table is hard to read.
fn inside(span: Range<usize>, text: &str) -> Range<usize> {
    let start = span.start.min(text.len());
    let end = span.end.clamp(start, text.len());
    let line = text.as_bytes()[start..end].iter().position(|&b| b == b'\n');
    start..line.map_or(end, |n| start + n)
}
