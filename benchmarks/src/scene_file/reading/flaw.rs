//! Errors of deserialisation, with and without a place in the file.

use super::super::error::SceneError;
use serde::de;
use std::fmt::{self, Display};

/// An error in a value of the file.
#[derive(Debug)]
pub enum Flaw {
    /// An error that has its place already.
    Placed(SceneError),
    /// A key that the table does not know.
    UnknownKey,
    /// A required key that is missing.
    Missing(&'static str),
    /// A word that is not among the valid ones.
    UnknownWord(String, &'static [&'static str]),
    /// A value of another type or range than expected.
    Expected(String),
    /// A message in a full sentence.
    Said(String),
}

impl Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Flaw::Placed(e) => e.fmt(f),
            Flaw::UnknownKey => f.write_str("unknown key"),
            Flaw::Missing(key) => write!(f, "`{key}` is missing"),
            Flaw::UnknownWord(word, _) => write!(f, "\"{word}\" is not known"),
            Flaw::Expected(what) => write!(f, "expected {what}"),
            Flaw::Said(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for Flaw {}

impl de::Error for Flaw {
    fn custom<T: Display>(why: T) -> Self {
        Flaw::Said(why.to_string())
    }

    fn invalid_type(_: de::Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        Flaw::Expected(expected.to_string())
    }

    fn invalid_value(_: de::Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        Flaw::Expected(expected.to_string())
    }

    fn unknown_variant(word: &str, known: &'static [&'static str]) -> Self {
        Flaw::UnknownWord(word.to_owned(), known)
    }

    fn unknown_field(_: &str, _: &'static [&'static str]) -> Self {
        Flaw::UnknownKey
    }

    fn missing_field(key: &'static str) -> Self {
        Flaw::Missing(key)
    }
}
