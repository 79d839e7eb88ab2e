//! Refusals of scene files: what is wrong, the place in the file, and a way out.

use miette::{Diagnostic, LabeledSpan, NamedSource};
use std::ops::Range;
use std::sync::Arc;

/// Remarks on a file that a refusal repeats.
const MOST_REMARKS: usize = 3;

/// Why a scene is refused. Rendered by `miette` it shows file, line and help.
#[derive(Clone, Debug, thiserror::Error, Diagnostic)]
#[error("{message}")]
pub struct SceneError {
    message: String,
    #[help]
    help: Option<String>,
    /// The first one is the one whose line stands in the heading.
    #[label(collection)]
    labels: Vec<LabeledSpan>,
    #[source_code]
    source_code: Option<Arc<NamedSource<String>>>,
}

impl SceneError {
    /// An error without a place in a file.
    pub fn plain(message: impl Into<String>, help: impl Into<String>) -> Self {
        SceneError {
            message: message.into(),
            help: Some(help.into()),
            labels: Vec::new(),
            source_code: None,
        }
    }

    /// Several errors as one: the first with its place, the others in its help, a line each.
    pub fn all_of(errors: impl IntoIterator<Item = SceneError>) -> Self {
        let mut errors = errors.into_iter();
        let Some(mut first) = errors.next() else {
            return SceneError::plain("nothing can run", "");
        };
        let others: Vec<String> = errors.map(|e| e.told()).collect();
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

    /// In one line, with its place: file and line, what, and the way out.
    pub fn told(&self) -> String {
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

    /// Line (from 1) of the first label, if the error has a place.
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

/// A file being read: its name and text, and the source of errors about it.
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

    /// An error at a place: what is wrong, what the label says, the way out.
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

/// The span, cut to the text and to its first line: a label over a whole table hides more than it shows.
fn inside(span: Range<usize>, text: &str) -> Range<usize> {
    let start = span.start.min(text.len());
    let end = span.end.clamp(start, text.len());
    let line = text.as_bytes()[start..end].iter().position(|&b| b == b'\n');
    start..line.map_or(end, |n| start + n)
}
