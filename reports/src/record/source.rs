//! Inputs of a record: scene, calibrations and hashes of files.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Inputs of a record, complete enough to make it again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Source {
    /// Version of gearbench that made the record.
    pub version: String,
    /// The scene as it was named: a shipped one, or a path.
    pub name: String,
    /// Text of the scene file.
    pub scene: String,
    /// Texts of the calibration files that models used, by the scene that their constants were fitted in.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub calibrations: BTreeMap<String, String>,
    /// Hash (FNV-1a, 128 bits) of every file that was read, by path: decks, meshes, stored reductions, tables of references.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, String>,
    /// Hash (FNV-1a, 128 bits) of each stored reference, by its id.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub references: BTreeMap<String, String>,
}
