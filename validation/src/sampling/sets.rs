//! Sets of scenes and their seeds; why there is no such scene.

use gearbench::scene_file::SceneError;
use gearbench_models::error::BuildError;
use gearbench_models::geometry::GeometryError;
use std::collections::BTreeMap;

/// Sets and their seeds.
const SETS: &str = include_str!("../../sets.toml");
/// Samples of a scene before it is given up.
pub const MOST_SAMPLES: u32 = 200;

/// A set of scenes.
#[derive(Clone, Debug, PartialEq)]
pub struct Set {
    /// Its name in the list.
    pub name: String,
    pub seed: u64,
    /// Number of scenes, counted from 1.
    pub scenes: usize,
    /// So many of its scenes of one impact, the first, are validated against full finite elements.
    pub full_order: usize,
    /// Parameters of the distributions of this set.
    pub own: Own,
}

/// Parameters of the distributions of one set.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct Own {
    /// Every scene whose number is a multiple of this runs under load, no other does; by chance where it is left out.
    pub loaded_every: Option<usize>,
    /// Part of the impacts that are those of a pinion on a rack.
    pub racks: f64,
    /// Mesh cycles of gears that run under load.
    pub cycles: Vec<u32>,
    /// Part of the impacts without damping; of other scenes it is a third where this is left out.
    pub undamped_impacts: Option<f64>,
    /// Flank points may have dashpots; where not, modes carry all damping.
    pub dashpots: bool,
}

impl Default for Own {
    fn default() -> Self {
        Own {
            loaded_every: None,
            racks: 0.15,
            cycles: vec![2, 3],
            undamped_impacts: None,
            dashpots: true,
        }
    }
}

/// Why there is no such scene.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    #[error("there is no set `{name}`; there are {}", known.join(" and "))]
    Set {
        /// The requested name.
        name: String,
        /// Names of the existing sets.
        known: Vec<String>,
    },
    #[error("the set `{set}` has scenes 1 to {last}, not {number}")]
    Number {
        set: String,
        /// Number of the last scene of the set.
        last: usize,
        /// The requested number.
        number: usize,
    },
    /// The list of sets cannot be read.
    #[error("validation/sets.toml: {0}")]
    Sets(String),
    /// Nothing sound was found.
    #[error("scene {number} of `{set}`: none of {MOST_SAMPLES} samples is sound; the last: {last}")]
    Unsound {
        set: String,
        number: usize,
        /// Why the last was not.
        last: String,
    },
    /// A gear of the list cannot be cut.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A sampled scene is no scene file.
    #[error("a sampled scene cannot be read: {0}")]
    Scene(#[from] SceneError),
    /// The gears do not mesh.
    #[error("a sampled scene cannot be built: {0}")]
    Build(#[from] BuildError),
}

#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
struct SetRow {
    seed: u64,
    scenes: usize,
    #[serde(default)]
    full_order: usize,
    #[serde(flatten)]
    own: Own,
}

/// A set by its name.
///
/// # Errors
/// [`SampleError::Set`] names those there are.
pub fn set(name: &str) -> Result<Set, SampleError> {
    let rows: BTreeMap<String, SetRow> =
        toml::from_str(SETS).map_err(|e| SampleError::Sets(e.to_string()))?;
    let row = rows.get(name).ok_or_else(|| SampleError::Set {
        name: name.to_owned(),
        known: rows.keys().cloned().collect(),
    })?;
    Ok(Set {
        name: name.to_owned(),
        seed: row.seed,
        scenes: row.scenes,
        full_order: row.full_order,
        own: row.own.clone(),
    })
}
