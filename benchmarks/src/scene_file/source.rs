//! The source of a record: text and inputs of its scene, and a scene that is rerun from a record.
//!
//! In a rerun the record replaces the scene file: text and calibrations are those of the record; relative paths still
//! count from the place of the scene file, and the files there must be unchanged.

use super::calibration::Calibration;
use super::{Origin, SceneFile};
use crate::context::Context;
use crate::experiment::key::{self, Key};
use gearbench_reference::files;
use gearbench_reference::hash::Hash;
use gearbench_reports::record::Source;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

impl Context {
    /// The text of a scene in the record that is rerun.
    pub(super) fn recorded(&self, name: &str) -> Option<&str> {
        let source = self.rerun.iter().find(|source| source.name == name)?;
        Some(source.scene.as_str())
    }

    /// The calibration file of a scene in the record that is rerun.
    pub(super) fn recorded_calibration(&self, scene: &str) -> Option<&str> {
        let mut sources = self.rerun.iter();
        sources.find_map(|source| source.calibrations.get(scene).map(String::as_str))
    }
}

/// Largest size of a file that is hashed [bytes]; decks and tables have the same limit.
const MOST_OF_SOURCE: u64 = 1 << 30;

/// Hash of a file; `None` if it cannot be read.
fn hash_of(path: &str) -> Option<String> {
    // A record may name a pipe or a device, which is read without end.
    if !Path::new(path).is_file() {
        return None;
    }
    let mut hash = Hash::START;
    hash.bytes(&files::read(Path::new(path), MOST_OF_SOURCE).ok()?);
    Some(hash.to_string())
}

/// Hash of a stored reference.
fn hash_of_reference(id: &str) -> Option<String> {
    let found = gearbench_reference::reference(id).ok()?;
    Some(Key::new("reference").and(&found.history).to_string())
}

/// Names of files and references that have changed since the record was written.
pub fn changed(source: &Source) -> Vec<String> {
    let differs = |of: fn(&str) -> Option<String>| {
        move |(name, hash): &(&String, &String)| of(name).as_ref() != Some(*hash)
    };
    let files = source.files.iter().filter(differs(hash_of));
    let references = source.references.iter().filter(differs(hash_of_reference));
    files
        .chain(references)
        .map(|(name, _)| name.clone())
        .collect()
}

impl SceneFile {
    /// Files that the scene names: decks, meshes and reductions of models, reference tables, topographies.
    fn files_read(&self) -> Vec<PathBuf> {
        let of_models = self.models.iter().flat_map(|m| key::files(&m.modelling));
        let tables = self.references.iter().filter_map(|r| r.file());
        of_models
            .chain(tables.map(Path::to_owned))
            .chain(self.data_files.iter().cloned())
            .collect()
    }

    /// Files that a study of the scene reads: the scene, its calibration, and all files that it names.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let own = match &self.origin {
            Origin::Shipped => Vec::new(),
            Origin::File(path) => vec![path.clone(), self.calibration_path()],
        };
        own.into_iter().chain(self.files_read()).collect()
    }

    /// The text, calibrations and hashes of input files for the record of a study.
    pub fn source(&self) -> Source {
        let mut calibrations: BTreeMap<String, Calibration> = BTreeMap::new();
        for used in self.models.iter().filter_map(|m| m.calibration.as_ref()) {
            if let Some(constants) = &used.constants {
                let sets = &mut calibrations.entry(used.scene.clone()).or_default().sets;
                let set = sets.entry(used.name.clone()).or_default();
                set.insert(used.label.clone(), constants.clone());
            }
        }
        Source {
            version: env!("CARGO_PKG_VERSION").into(),
            name: match &self.origin {
                Origin::Shipped => self.name.clone(),
                Origin::File(path) => path.display().to_string(),
            },
            scene: self.text().to_owned(),
            calibrations: (calibrations.into_iter())
                .map(|(scene, c)| (scene, c.to_toml()))
                .collect(),
            files: (self.files_read().into_iter())
                .map(|path| path.display().to_string())
                .filter_map(|path| Some((path.clone(), hash_of(&path)?)))
                .collect(),
            references: (self.references.iter())
                .filter_map(|r| r.stored())
                .filter_map(|id| Some((id.to_owned(), hash_of_reference(id)?)))
                .collect(),
        }
    }
}
