//! Keys of pieces of work: hashes of everything that their results depend on. A finished piece is reused only if its
//! result would be the same.

use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reference::files as bounded;
use gearbench_reference::hash::Hash;
use std::fmt;
use std::path::PathBuf;

/// The key of a piece of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key(Hash);

impl Key {
    /// Starts the key of a kind of work.
    pub fn new(kind: &str) -> Key {
        let mut hash = Hash::START;
        hash.text(kind);
        Key(hash)
    }

    /// Adds something that the piece depends on: its debug text has all digits of all numbers.
    #[must_use]
    pub fn and(mut self, part: &impl fmt::Debug) -> Key {
        self.0.text(&format!("{part:?}"));
        self
    }

    /// Adds a scene, its models, and the contents of the files that these read.
    #[must_use]
    pub fn and_scene(self, scene: &SceneSpec, modelling: &Modelling) -> Key {
        let mut key = self.and(scene).and(modelling);
        for path in files(modelling) {
            // A file that cannot be read is the affair of the model that reads it.
            if let Ok(bytes) = bounded::read(&path, MOST_OF_MODEL) {
                key.0.bytes(&bytes);
            }
        }
        key
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Largest size of a model file that is hashed [bytes]; the reader of reductions has the same limit.
const MOST_OF_MODEL: u64 = gearbench_reference::reduction::store::MAX_FILE_BYTES;

/// Paths of the files that models read.
pub fn files(modelling: &Modelling) -> impl Iterator<Item = PathBuf> {
    (modelling.gears.iter())
        .flat_map(|g| g.values().into_values())
        .filter_map(|value| Some(PathBuf::from(value.as_str()?)))
        .filter(|path| path.is_file())
}
