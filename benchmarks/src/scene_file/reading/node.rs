//! A TOML value with its place, and errors about it.

use super::super::error::{SceneError, Source};
use super::flaw::Flaw;
use super::keys::Table;
use super::suggest;
use std::ops::Range;
use toml::Spanned;
use toml::de::DeValue;

/// The source and the names that values of the file may refer to.
#[derive(Debug)]
pub(super) struct Context<'d> {
    pub(super) source: &'d Source,
    /// Valid names, by the newtype that reads them.
    pub(super) known: Vec<(&'static str, Vec<String>)>,
}

impl Context<'_> {
    pub(super) fn known(&self, name: &str) -> Option<&[String]> {
        let found = self.known.iter().find(|(n, _)| *n == name)?;
        Some(&found.1)
    }
}

/// A value with its key and its place in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node<'d> {
    pub(super) context: &'d Context<'d>,
    pub(super) key: &'d str,
    pub(super) meaning: &'static str,
    pub(super) value: &'d DeValue<'d>,
    pub(super) at: (usize, usize),
    /// True for a member of a list, which has no key of its own.
    pub(super) member: bool,
    /// Key that was read already: the tag of an enumeration.
    pub(super) tag: Option<&'static str>,
    pub(super) distinct: bool,
}

impl<'d> Node<'d> {
    /// The node of the whole document.
    pub(super) fn root(context: &'d Context<'d>, value: &'d DeValue<'d>) -> Self {
        Node {
            context,
            key: "",
            meaning: "",
            value,
            at: (0, 0),
            member: false,
            tag: None,
            distinct: false,
        }
    }

    pub(super) fn of(self, value: &'d Spanned<DeValue<'d>>) -> Self {
        let Range { start, end } = value.span();
        Node {
            value: value.get_ref(),
            at: (start, end),
            tag: None,
            distinct: false,
            ..self
        }
    }

    pub(super) fn error(
        &self,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        let span = self.at.0..self.at.1;
        self.context.source.error(span, message, label, help)
    }

    pub(super) fn refuse<T>(
        &self,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Result<T, Flaw> {
        Err(Flaw::Placed(self.error(message, label, help)))
    }

    /// The help for a value: the meaning of its key.
    pub(super) fn help(&self) -> String {
        match self.meaning {
            "" => String::new(),
            meaning => format!("`{}`: {meaning}", self.key),
        }
    }

    /// Name of a table in errors: its header, else its key.
    pub(super) fn called(&self) -> String {
        let text = self.context.source.text();
        let header = text.get(self.at.0..self.at.1).unwrap_or_default();
        match header.lines().next() {
            Some(line) if line.starts_with('[') => line.trim_end().to_owned(),
            _ if self.key.is_empty() => self.context.source.name().to_owned(),
            _ => format!("`{}`", self.key),
        }
    }

    /// Adds the place of this value to an error.
    pub(super) fn place(&self, flaw: Flaw) -> SceneError {
        match flaw {
            Flaw::Placed(e) => e,
            Flaw::Missing(key) => self.missing(key, ""),
            Flaw::UnknownKey => self.error("unknown key", "unknown in this table", self.help()),
            Flaw::UnknownWord(word, known) => self.unknown_word(&word, known),
            Flaw::Said(why) => self.error(why, "this", self.help()),
            Flaw::Expected(what) => {
                let is = if self.member { "holds" } else { "is" };
                self.error(
                    format!(
                        "`{}` {is} {}, expected {what}",
                        self.key,
                        type_of_value(self.value)
                    ),
                    format!("expected {what}"),
                    self.help(),
                )
            }
        }
    }

    pub(super) fn placed<T>(&self, result: Result<T, Flaw>) -> Result<T, Flaw> {
        result.map_err(|flaw| Flaw::Placed(self.place(flaw)))
    }

    pub(super) fn expected<T>(&self, what: &str) -> Result<T, Flaw> {
        self.placed(Err(Flaw::Expected(what.to_owned())))
    }

    pub(super) fn missing(&self, key: &str, meaning: &str) -> SceneError {
        self.error(
            format!("`{key}` is missing in {}", self.called()),
            "here",
            format!("add `{key}`: {meaning}"),
        )
    }

    /// The error for an unknown key of this table.
    pub(super) fn unknown_key(
        &self,
        entry: &Node<'_>,
        known: &[&'static str],
        table: Option<&Table>,
    ) -> SceneError {
        let meaning = |key: &str| table.map_or("", |t| t.meaning(key));
        entry.error(
            format!("unknown key `{}` in {}", entry.key, self.called()),
            "unknown in this table",
            suggest::help_for(entry.key, entry.number().ok(), known, &meaning),
        )
    }

    pub(super) fn unknown_word(&self, word: &str, known: &[&str]) -> SceneError {
        self.error(
            format!("`{}` is \"{word}\", which is not known", self.key),
            "not known",
            suggest::there_are(word, known),
        )
    }

    pub(super) fn number(&self) -> Result<f64, Flaw> {
        match (self.value, finite(self.value)) {
            (_, Some(x)) => Ok(x),
            (DeValue::Integer(_) | DeValue::Float(_), None) => self.expected("a finite number"),
            _ => self.expected("a number"),
        }
    }

    pub(super) fn whole(&self) -> Result<u32, Flaw> {
        match self.value {
            DeValue::Integer(i) => u32::from_str_radix(i.as_str(), i.radix()).or_else(|_| {
                let negative = i.as_str().starts_with('-');
                self.expected(match negative {
                    true => "a whole number, zero or more",
                    false => "a whole number up to 4294967295",
                })
            }),
            _ => self.expected("a whole number"),
        }
    }

    pub(super) fn text(&self) -> Result<&'d str, Flaw> {
        match self.value {
            DeValue::String(s) => Ok(s),
            _ => self.expected("a text in quotes"),
        }
    }

    /// Entries of a table in the order of the file, without the tag.
    pub(super) fn entries(&self) -> Result<Vec<Node<'d>>, Flaw> {
        let DeValue::Table(table) = self.value else {
            return self.expected("a table");
        };
        let mut entries: Vec<_> = table
            .iter()
            .filter(|(key, _)| self.tag != Some(key.get_ref()))
            .collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        Ok(entries
            .into_iter()
            .map(|(key, value)| Node {
                key: key.get_ref(),
                meaning: "",
                member: false,
                at: (key.span().start, key.span().end),
                ..self.of(value)
            })
            .collect())
    }

    /// The value of an entry; [`Node::entries`] returns entries with the place of their key.
    pub(super) fn value_of(&self, entry: Node<'d>) -> Node<'d> {
        match self.value {
            DeValue::Table(table) => table.get(entry.key).map_or(entry, |v| entry.of(v)),
            _ => entry,
        }
    }
}

/// Parses a finite number.
pub(super) fn finite(value: &DeValue<'_>) -> Option<f64> {
    let x = match value {
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok()? as f64,
        DeValue::Float(f) => f.as_str().parse::<f64>().ok()?,
        _ => return None,
    };
    x.is_finite().then_some(x)
}

/// Describes a value by its type.
fn type_of_value(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(s) => format!("the text \"{}\"", s.chars().take(40).collect::<String>()),
        DeValue::Integer(i) => format!("the number {i}"),
        DeValue::Float(f) => format!("the number {f}"),
        DeValue::Boolean(b) => b.to_string(),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(_) => "a list".into(),
        DeValue::Table(_) => "a table".into(),
    }
}
