//! Deserialisation of TOML by serde, with errors that name line, cause and help.
//!
//! | module | owns |
//! |---|---|
//! | `deserializer` | what serde asks a value for, and the enumerations of the format |
//! | `node` | a value with its place, refusals of what is found there |
//! | [`flaw`] | what serde finds wrong, before it has a place |
//! | [`keys`] | tables of the format as structs, whose comments are the meanings that refusals show; renamed keys |
//! | [`values`] | numbers with limits, words that a scene chooses itself |
//! | `place` | where everything stands, for what is wrong with several values together |
//! | `suggest` | "did you mean", units |
//!
//! A table of the format is a struct in `keys!`; its doc comments are the meanings of the keys. What one value says
//! wrong is refused while it is read, by the types of `values`; what several say wrong together by
//! [`Place::refuse`] after that.

mod deserializer;
mod flaw;
pub(crate) mod keys;
mod node;
mod place;
pub(super) mod suggest;
pub(crate) mod values;

pub(crate) use place::{Document, Place};
