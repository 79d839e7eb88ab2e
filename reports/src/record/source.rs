//! What a record was made of.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a record was made of, so that it can be made again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Source {
    /// Version of gearbench.
    pub version: String,
    /// The scene as it was named: a shipped one, or a path.
    pub name: String,
    /// Text of the scene file.
    pub scene: String,
    /// Constants that models took from calibrations: text of a calibration file by the scene that they were fitted in.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub calibrations: BTreeMap<String, String>,
    /// Hash (FNV-1a, 128 bits) of every file that was read, by path: decks, meshes, stored reductions, tables of references.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, String>,
    /// The same of the stored reference, by id.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub references: BTreeMap<String, String>,
}
