//! Places of values in a file, for errors that concern several values.

use super::super::error::{SceneError, Source};
use super::keys::Table;
use super::node::{Context, Node, finite};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A parsed file: text, places of all values by path, such as `meshes[0].start.gap_m`, and all numbers.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    source: Source,
    spans: BTreeMap<String, Range<usize>>,
    numbers: BTreeMap<String, f64>,
}

/// A table or a list of a [`Document`].
#[derive(Clone, Debug)]
pub(crate) struct Place<'d> {
    document: &'d Document,
    path: String,
}

impl Document {
    /// Parses a text into a type. `known` contains the names that the text itself defines, by the newtype that reads
    /// them.
    ///
    /// # Errors
    /// [`SceneError`] with line and help.
    pub(crate) fn read<T: for<'d> Deserialize<'d>>(
        name: &str,
        text: &str,
        known: impl FnOnce(&DeTable<'_>) -> Vec<(&'static str, Vec<String>)>,
    ) -> Result<(Self, T), SceneError> {
        let source = Source::new(name, text);
        let table = DeTable::parse(text).map_err(|e| syntax(&source, &e))?;
        let table = table.into_inner();
        let known = known(&table);
        let mut spans = BTreeMap::from([(String::new(), 0..0)]);
        let mut numbers = BTreeMap::new();
        let root = DeValue::Table(table);
        index(&root, "", &mut spans, &mut numbers);
        let context = Context {
            source: &source,
            known,
        };
        let node = Node::root(&context, &root);
        let read = T::deserialize(node).map_err(|flaw| node.place(flaw))?;
        let document = Document {
            source,
            spans,
            numbers,
        };
        Ok((document, read))
    }

    /// Returns the number at a path.
    pub(in super::super) fn number(&self, path: &str) -> Option<f64> {
        self.numbers.get(path).copied()
    }

    /// Iterates over all numbers with their paths.
    pub(in super::super) fn numbers(&self) -> impl Iterator<Item = (&str, f64)> {
        self.numbers.iter().map(|(path, x)| (path.as_str(), *x))
    }

    pub(in super::super) fn text(&self) -> &str {
        self.source.text()
    }

    /// Returns the place of a path.
    pub(crate) fn at(&self, path: impl Into<String>) -> Place<'_> {
        Place {
            document: self,
            path: path.into(),
        }
    }
}

/// Converts an error of the TOML syntax.
fn syntax(source: &Source, e: &toml::de::Error) -> SceneError {
    let message = e.message().trim().replace('\n', "; ");
    let help = "write `key = value` in a line, `[name]` at the start of a table, text in quotes, and each name once \
                (https://toml.io)";
    let span = e.span().unwrap_or(0..0);
    source.error(span, format!("not TOML: {message}"), "here", help)
}

/// Indexes the entries of tables and the members of lists.
fn index(
    value: &DeValue<'_>,
    path: &str,
    spans: &mut BTreeMap<String, Range<usize>>,
    numbers: &mut BTreeMap<String, f64>,
) {
    if let Some(x) = finite(value) {
        numbers.insert(path.to_owned(), x);
    }
    let mut enter = |path: String, start: usize, value: &Spanned<DeValue<'_>>| {
        index(value.get_ref(), &path, spans, numbers);
        spans.insert(path, start..value.span().end);
    };
    match value {
        DeValue::Table(table) => {
            for (key, value) in table {
                let dot = if path.is_empty() { "" } else { "." };
                // A table with a header has the position of the header.
                let start = match value.get_ref() {
                    DeValue::Table(_) => key.span().start.min(value.span().start),
                    _ => key.span().start,
                };
                enter(format!("{path}{dot}{}", key.get_ref()), start, value);
            }
        }
        DeValue::Array(members) => {
            for (i, member) in members.iter().enumerate() {
                enter(format!("{path}[{i}]"), member.span().start, member);
            }
        }
        _ => {}
    }
}

impl<'d> Place<'d> {
    /// The place of the whole document.
    pub(crate) fn root(&self) -> Place<'d> {
        self.document.at("")
    }

    /// The place of a path of the document, relative to its root.
    pub(crate) fn at(&self, path: &str) -> Place<'d> {
        self.document.at(path)
    }

    /// The place of a key of this table.
    pub(crate) fn key(&self, key: &str) -> Place<'d> {
        let dot = if self.path.is_empty() { "" } else { "." };
        self.document.at(format!("{}{dot}{key}", self.path))
    }

    /// The place of a member of this list.
    pub(crate) fn member(&self, index: usize) -> Place<'d> {
        self.document.at(format!("{}[{index}]", self.path))
    }

    /// Name of the file.
    pub(crate) fn file(&self) -> &'d str {
        self.document.source.name()
    }

    /// Formats the place as a table header, such as `[gears.pinion]`.
    pub(crate) fn header(&self) -> String {
        format!("[{}]", self.path)
    }

    /// True if the file contains this place.
    pub(crate) fn exists(&self) -> bool {
        self.document.spans.contains_key(&self.path)
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.key(key).exists()
    }

    /// Returns the place of the first of several keys that is in the file, else the table itself.
    pub(crate) fn first(&self, keys: &[&str]) -> Place<'d> {
        let mut keys = keys.iter().map(|k| self.key(k));
        keys.find(Place::exists).unwrap_or_else(|| self.clone())
    }

    fn span(&self) -> Range<usize> {
        self.document
            .spans
            .get(&self.path)
            .cloned()
            .unwrap_or_default()
    }

    /// Creates an error at this place, with message, label and help.
    pub(crate) fn error(
        &self,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        let source = &self.document.source;
        source.error(self.span(), message, label, help)
    }

    /// Returns [`Place::error`] as a result.
    pub(crate) fn refuse<T>(
        &self,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Result<T, SceneError> {
        Err(self.error(message, label, help))
    }

    /// The error for a required key that is missing.
    pub(crate) fn missing(&self, key: &str, table: &Table) -> SceneError {
        let meaning = table.meaning(key);
        let message = format!("`{key}` is missing in {}", self.header());
        self.error(message, "here", format!("add `{key}`: {meaning}"))
    }

    /// Creates an error about two places that contradict each other.
    pub(crate) fn against(
        &self,
        (other, other_label): (&Place<'_>, &str),
        message: impl Into<String>,
        label: &str,
        help: impl Into<String>,
    ) -> SceneError {
        self.error(message, label, help)
            .and(other.span(), other_label)
    }
}
