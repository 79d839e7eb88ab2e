//! Typed access to a TOML document that knows where everything stands.
//!
//! A [`Section`] is a table whose keys are declared beforehand as [`Key`]s, each with its meaning and
//! unit; opening it refuses unknown keys. An [`Entry`] is one value with its key; it converts to the type
//! that is asked for or says what was expected and what was found.

use super::error::{SceneError, Source};
use super::suggest;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A key of the format: its name and what it means, unit and example included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) meaning: &'static str,
}

/// Declares a key.
pub(super) const fn key(name: &'static str, meaning: &'static str) -> Key {
    Key { name, meaning }
}

/// A table of the document.
#[derive(Clone, Debug)]
pub(super) struct Section<'a> {
    pub(super) source: &'a Source,
    /// How errors call it, such as `[gears.pinion]`.
    pub(super) place: String,
    /// Where it begins.
    pub(super) span: Range<usize>,
    keys: &'static [Key],
    entries: Vec<Entry<'a>>,
}

/// A value with its key.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry<'a> {
    source: &'a Source,
    pub(super) name: &'a str,
    meaning: &'static str,
    key_span: (usize, usize),
    value: &'a Spanned<DeValue<'a>>,
}

/// Entries of a table in the order of the file.
pub(super) fn in_order<'a>(source: &'a Source, table: &'a DeTable<'a>) -> Vec<Entry<'a>> {
    let mut entries: Vec<Entry<'a>> = table
        .iter()
        .map(|(key, value)| Entry {
            source,
            name: key.get_ref(),
            meaning: "",
            key_span: (key.span().start, key.span().end),
            value,
        })
        .collect();
    entries.sort_by_key(|e| e.key_span);
    entries
}

impl<'a> Section<'a> {
    /// Opens a table: refuses unknown keys.
    pub(super) fn open(
        source: &'a Source,
        table: &'a DeTable<'a>,
        span: Range<usize>,
        place: String,
        keys: &'static [Key],
    ) -> Result<Self, SceneError> {
        let mut entries = in_order(source, table);
        for entry in &mut entries {
            match keys.iter().find(|k| k.name == entry.name) {
                Some(k) => entry.meaning = k.meaning,
                None => return Err(unknown_key(entry, &place, keys)),
            }
        }
        Ok(Section {
            source,
            place,
            span,
            keys,
            entries,
        })
    }

    /// A value that may be absent.
    pub(super) fn get(&self, name: &str) -> Option<Entry<'a>> {
        debug_assert!(
            self.keys.iter().any(|k| k.name == name),
            "undeclared key {name}"
        );
        self.entries.iter().find(|e| e.name == name).copied()
    }

    /// A value that must be there.
    pub(super) fn need(&self, name: &str) -> Result<Entry<'a>, SceneError> {
        self.get(name).ok_or_else(|| self.missing(name))
    }

    /// The error of a key that must be there and is not.
    pub(super) fn missing(&self, name: &str) -> SceneError {
        let meaning = self
            .keys
            .iter()
            .find(|k| k.name == name)
            .map_or("", |k| k.meaning);
        self.error(
            format!("`{name}` is missing in {}", self.place),
            "here",
            format!("add `{name}`: {meaning}"),
        )
    }

    /// An error about the table as a whole.
    pub(super) fn error(
        &self,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        self.source.error(self.span.clone(), message, label, help)
    }

    /// A number that must be there.
    pub(super) fn number(&self, name: &str) -> Result<f64, SceneError> {
        self.need(name)?.number()
    }

    /// A number with a default.
    pub(super) fn number_or(&self, name: &str, default: f64) -> Result<f64, SceneError> {
        Ok(self.maybe_number(name)?.unwrap_or(default))
    }

    /// A number that may be absent.
    pub(super) fn maybe_number(&self, name: &str) -> Result<Option<f64>, SceneError> {
        self.get(name).map(|e| e.number()).transpose()
    }

    /// The only entry of a table that takes exactly one of its keys.
    pub(super) fn only(&self) -> Result<Entry<'a>, SceneError> {
        let names: Vec<&str> = self.keys.iter().map(|k| k.name).collect();
        match self.entries.as_slice() {
            [one] => Ok(*one),
            [] => Err(self.error(
                format!("{} is empty", self.place),
                "here",
                format!("give one of {}", suggest::words(&names)),
            )),
            [first, second, ..] => Err(self
                .source
                .error(
                    second.key_range(),
                    format!("{} takes one key only", self.place),
                    "and this",
                    format!(
                        "give one of {}; several loads are several tables of the list",
                        suggest::words(&names)
                    ),
                )
                .and(first.key_range(), "this")),
        }
    }
}

fn unknown_key(entry: &Entry<'_>, place: &str, keys: &'static [Key]) -> SceneError {
    let names: Vec<&str> = keys.iter().map(|k| k.name).collect();
    let meaning = |name: &str| {
        keys.iter()
            .find(|k| k.name == name)
            .map_or("", |k| k.meaning)
    };
    entry.unknown(
        &format!("unknown key `{}` in {place}", entry.name),
        &names,
        &meaning,
    )
}

impl<'a> Entry<'a> {
    pub(super) fn key_range(&self) -> Range<usize> {
        self.key_span.0..self.key_span.1
    }

    pub(super) fn span(&self) -> Range<usize> {
        self.value.span()
    }

    pub(super) fn source(&self) -> &'a Source {
        self.source
    }

    /// An error about an unknown key, with the known one that was probably meant.
    pub(super) fn unknown(
        &self,
        message: &str,
        known: &[&str],
        meaning: &dyn Fn(&str) -> &'static str,
    ) -> SceneError {
        let help = suggest::help_for(self.name, self.number().ok(), known, meaning);
        self.source
            .error(self.key_range(), message, "not known here", help)
    }

    /// An error about the value.
    pub(super) fn error(
        &self,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        self.source.error(self.span(), message, label, help)
    }

    fn expected(&self, what: &str) -> SceneError {
        let help = if self.meaning.is_empty() {
            String::new()
        } else {
            format!("`{}`: {}", self.name, self.meaning)
        };
        self.error(
            format!(
                "`{}` is {}, expected {what}",
                self.name,
                found(self.value.get_ref())
            ),
            format!("expected {what}"),
            help,
        )
    }

    /// A finite number.
    pub(super) fn number(&self) -> Result<f64, SceneError> {
        let x = match self.value.get_ref() {
            DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix())
                .ok()
                .map(|i| i as f64),
            DeValue::Float(f) => f.as_str().parse::<f64>().ok(),
            _ => return Err(self.expected("a number")),
        };
        match x {
            Some(x) if x.is_finite() => Ok(x),
            _ => Err(self.expected("a finite number")),
        }
    }

    /// A whole number from 0 to 4294967295.
    pub(super) fn whole(&self) -> Result<u32, SceneError> {
        match self.value.get_ref() {
            DeValue::Integer(i) => u32::from_str_radix(i.as_str(), i.radix())
                .map_err(|_| self.expected("a whole number, zero or more")),
            _ => Err(self.expected("a whole number")),
        }
    }

    /// True or false, if it is one of them.
    pub(super) fn as_boolean(&self) -> Option<bool> {
        match self.value.get_ref() {
            DeValue::Boolean(b) => Some(*b),
            _ => None,
        }
    }

    /// True or false.
    pub(super) fn boolean(&self) -> Result<bool, SceneError> {
        self.as_boolean()
            .ok_or_else(|| self.expected("true or false"))
    }

    /// The text, if it is one.
    pub(super) fn as_text(&self) -> Option<&'a str> {
        match self.value.get_ref() {
            DeValue::String(s) => Some(s),
            _ => None,
        }
    }

    /// A text.
    pub(super) fn text(&self) -> Result<&'a str, SceneError> {
        self.as_text()
            .ok_or_else(|| self.expected("a text in quotes"))
    }

    /// One of several words.
    pub(super) fn word<T: Clone>(&self, known: &[(&str, T)]) -> Result<T, SceneError> {
        let names: Vec<&str> = known.iter().map(|(k, _)| *k).collect();
        let text = self
            .as_text()
            .ok_or_else(|| self.expected(&format!("one of {}", suggest::words(&names))))?;
        match known.iter().find(|(k, _)| *k == text) {
            Some((_, value)) => Ok(value.clone()),
            None => Err(self.unknown_word(text, &names)),
        }
    }

    /// An error about a word that is not known.
    pub(super) fn unknown_word(&self, text: &str, known: &[&str]) -> SceneError {
        let near = suggest::nearest(text, known)
            .map_or(String::new(), |n| format!("did you mean `{n}`? "));
        self.error(
            format!("`{}` is \"{text}\", which is not known", self.name),
            "not known",
            format!("{near}there are {}", suggest::words(known)),
        )
    }

    /// A list with at least one member; members carry the key of the list.
    pub(super) fn list(&self) -> Result<Vec<Entry<'a>>, SceneError> {
        match self.value.get_ref() {
            DeValue::Array(a) if a.is_empty() => Err(self.error(
                format!("`{}` is empty", self.name),
                "expected at least one",
                format!("`{}`: {}", self.name, self.meaning),
            )),
            DeValue::Array(a) => Ok(a.iter().map(|value| Entry { value, ..*self }).collect()),
            _ => Err(self.expected("a list")),
        }
    }

    pub(super) fn is_list(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::Array(_))
    }

    pub(super) fn is_table(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::Table(_))
    }

    /// A list of finite numbers, at least one.
    pub(super) fn numbers(&self) -> Result<Vec<f64>, SceneError> {
        self.list()?.iter().map(Entry::number).collect()
    }

    /// Exactly `N` finite numbers.
    pub(super) fn fixed<const N: usize>(&self) -> Result<[f64; N], SceneError> {
        let numbers = self.numbers()?;
        let count = numbers.len();
        numbers.try_into().map_err(|_| {
            self.error(
                format!("`{}` has {count} numbers, expected {N}", self.name),
                format!("expected {N} numbers"),
                format!("`{}`: {}", self.name, self.meaning),
            )
        })
    }

    /// A table as it is, for names that a user chooses.
    pub(super) fn raw_table(&self) -> Result<&'a DeTable<'a>, SceneError> {
        match self.value.get_ref() {
            DeValue::Table(t) => Ok(t),
            _ => Err(self.expected("a table")),
        }
    }

    /// A table with declared keys.
    pub(super) fn section(
        &self,
        place: impl Into<String>,
        keys: &'static [Key],
    ) -> Result<Section<'a>, SceneError> {
        Section::open(
            self.source,
            self.raw_table()?,
            self.span(),
            place.into(),
            keys,
        )
    }
}

/// A value in words.
fn found(value: &DeValue<'_>) -> String {
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
