//! Sets of random scenes with their seeds.

use gearbench::scene_file::SceneError;
use gearbench_models::error::BuildError;
use gearbench_models::geometry::GeometryError;
use std::collections::BTreeMap;

/// Contents of the file of all sets.
const SETS: &str = include_str!("../../sets.toml");
/// Number of samples after which a scene is given up.
pub const MOST_SAMPLES: u32 = 200;

/// A set of random scenes.
#[derive(Clone, Debug, PartialEq)]
pub struct Set {
    /// Name of the set in the file.
    pub name: String,
    pub seed: u64,
    /// Number of scenes of the set.
    pub scenes: usize,
    /// Number of scenes with one impact, the first ones, that are also validated against full finite elements.
    pub full_order: usize,
    /// Parameters of the distributions of this set.
    pub own: SetDistributions,
}

/// Parameters of the distributions of one set.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct SetDistributions {
    /// Scenes whose number is a multiple of this run under load, and no others; `None` for a random choice.
    pub loaded_every: Option<usize>,
    /// Share of the impacts of a pinion on a rack.
    pub racks: f64,
    /// Possible numbers of mesh cycles of gears under load.
    pub cycles: Vec<u32>,
    /// Share of impacts without damping; `None` for the share of all other scenes.
    pub undamped_impacts: Option<f64>,
    /// True if flank points may have dashpots; otherwise modes have all damping.
    pub dashpots: bool,
}

impl Default for SetDistributions {
    fn default() -> Self {
        SetDistributions {
            loaded_every: None,
            racks: 0.15,
            cycles: vec![2, 3],
            undamped_impacts: None,
            dashpots: true,
        }
    }
}

/// Reason why a scene does not exist.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    #[error("there is no set `{name}`; there are {}", known.join(" and "))]
    Set {
        /// Name of the requested set.
        name: String,
        /// Names of the existing sets.
        known: Vec<String>,
    },
    #[error("the set `{set}` has scenes 1 to {last}, not {number}")]
    Number {
        set: String,
        /// Number of the last scene of the set.
        last: usize,
        /// Number of the requested scene.
        number: usize,
    },
    /// The list of sets cannot be read.
    #[error("validation/sets.toml: {0}")]
    Sets(String),
    #[error(transparent)]
    Write(#[from] gearbench::scene_file::format::WriteError),
    /// No valid sample was found.
    #[error("scene {number} of `{set}`: none of {MOST_SAMPLES} samples is sound; the last: {last}")]
    Unsound {
        set: String,
        number: usize,
        /// Reason for the last rejection.
        last: String,
    },
    /// A gear of the list is geometrically impossible.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The text of a sampled scene cannot be read.
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
    own: SetDistributions,
}

/// Returns the set with a name.
///
/// # Errors
/// [`SampleError::Set`] with the names of the existing sets.
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
