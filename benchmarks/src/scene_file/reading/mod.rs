//! Deserialisation of TOML by serde, with errors that name line, cause and help.
//!
//! | module | owns |
//! |---|---|
//! | `deserializer` | serde access to values, and the enumerations of the format |
//! | [`serializer`] | the inverse: tables as TOML |
//! | `node` | a value with its place, and errors about it |
//! | [`flaw`] | errors of serde before they have a place |
//! | [`keys`] | tables of the format as structs, whose comments are the meanings of keys in errors |
//! | [`values`] | numbers with limits, names that a scene defines |
//! | `place` | places of all values, for errors that concern several values |
//! | `suggest` | suggestions for unknown keys and other units |
//!
//! A table of the format is a struct in `keys!`; its doc comments are the meanings of the keys. Errors of a single
//! value are found while it is read, by the types of `values`; contradictions between values are refused later, by
//! [`Place::refuse`].

mod deserializer;
mod flaw;
pub(crate) mod keys;
mod node;
mod place;
pub(crate) mod serializer;
pub(super) mod suggest;
pub(crate) mod values;

pub(crate) use place::{Document, Place};
