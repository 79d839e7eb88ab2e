//! The record of static stiffness: models and formulas under one load, at positions over one base pitch.
//!
//! Both hubs are fixed; the first gear is turned by its approach until the mesh carries the load. Positions are path
//! coordinates of the reference pair along the line of action, growing in the direction in which contact moves.

use crate::record::Results;
use crate::record::checks::each;
use crate::studies::Part;
use serde::{Deserialize, Serialize};

/// N/(mm um) in \[N/m^2\]: the unit of ISO 6336-1.
pub const PER_MM_UM: f64 = 1e9;

/// The part of a record that is specific to static stiffness.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StiffnessRecord {
    /// Models of the scene, and behind them formulas.
    pub stiffness: Vec<ModelStiffness>,
}

impl Results {
    /// Returns the static stiffness of models; empty in records of other studies.
    pub fn stiffness(&self) -> &[ModelStiffness] {
        match &self.part {
            Part::Stiffness(part) => &part.stiffness,
            _ => &[],
        }
    }
}

/// Static stiffness of a model over a mesh cycle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ModelStiffness {
    /// Label of the model in its scene, or the name of the formula.
    pub label: String,
    /// Reason why the model has no numbers.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub message: String,
    /// Compliances that the stiffness of the model includes, in words.
    pub includes: String,
    /// Formulas of the model beyond their range of validity, which limits the accuracy of its numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<String>,
    /// Force along the line of action \[N\].
    pub force_n: f64,
    /// Common face width \[m\].
    pub face_width_m: f64,
    /// Base pitch \[m\].
    pub base_pitch_m: f64,
    /// Path coordinate of the pitch point \[m\].
    pub pitch_point_m: f64,
    /// Path coordinates of start and end of contact \[m\].
    pub path_m: [f64; 2],
    /// Stiffness of one pair per width \[N/m^2\]: the value of the norm, else the largest secant.
    pub single_stiffness_n_per_m2: f64,
    /// Secant stiffness of the pair at the pitch point per width \[N/m^2\].
    pub at_pitch_point_n_per_m2: f64,
    /// Stiffness of the mesh per width \[N/m^2\]: the value of the norm, else the mean secant.
    pub mesh_stiffness_n_per_m2: f64,
    /// Mean tangent stiffness of the mesh per width \[N/m^2\].
    pub mesh_tangent_n_per_m2: f64,
    /// Mean static transmission error \[m\].
    pub error_mean_m: f64,
    /// Peak to peak of the static transmission error \[m\].
    pub error_peak_to_peak_m: f64,
    /// Coordinates that were solved for.
    pub unknowns: usize,
    /// Number of equilibria that were solved.
    pub equilibria: u64,
    /// Number of iterations of Newton's method.
    pub newton_iterations: u64,
    /// Wall time of the set-up: meshes, factors \[s\].
    pub setup_s: f64,
    /// Wall time of all equilibria \[s\].
    pub solve_s: f64,
    /// Equilibria at equal steps over one base pitch, ascending in the path coordinate.
    pub positions: Vec<StiffnessPosition>,
}

/// An equilibrium at a position of the mesh cycle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct StiffnessPosition {
    /// Path coordinate of the reference pair \[m\].
    pub path_coordinate_m: f64,
    /// Static transmission error \[m\].
    pub error_m: f64,
    /// Force along the line of action \[N\].
    pub force_n: f64,
    /// Derivative of the force by the approach \[N/m\].
    pub tangent_n_per_m: f64,
    /// Loads of the tooth pairs that carry some.
    pub pairs: Vec<PairLoad>,
    /// The highest pressure among its lines of contact, where flanks touch along lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure: Option<LinePressure>,
}

/// The load of a tooth pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct PairLoad {
    /// Number of base pitches by which the pair is ahead of the reference pair.
    pub offset: i64,
    /// Part of the force that the pair carries \[N\].
    pub force_n: f64,
}

/// Pressure of a line of contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct LinePressure {
    /// Half width of the contact \[m\].
    pub half_width_m: f64,
    /// Hertz's pressure in its middle \[Pa\].
    pub peak_pa: f64,
}

impl StiffnessPosition {
    /// Returns the secant stiffness, force over approach \[N/m\].
    pub fn secant(&self) -> f64 {
        self.force_n / self.error_m
    }

    /// Returns the force of the pair `offset` base pitches ahead of the reference pair \[N\].
    pub fn pair(&self, offset: i64) -> f64 {
        let of = self.pairs.iter().find(|p| p.offset == offset);
        of.map_or(0.0, |p| p.force_n)
    }
}

impl ModelStiffness {
    /// Checks the ranges of its numbers.
    pub(crate) fn validate(&self) -> Result<(), String> {
        const MOST: u64 = 1000;
        each("positions", &self.positions, |p| {
            each("pairs", &p.pairs, |pair| match pair.offset.unsigned_abs() {
                0..=MOST => Ok(()),
                _ => Err(format!(
                    "offset is {}, expected {MOST} or less",
                    pair.offset
                )),
            })
        })
    }

    /// Returns a path coordinate relative to the pitch point, over the base pitch.
    pub fn relative(&self, path_coordinate_m: f64) -> f64 {
        (path_coordinate_m - self.pitch_point_m) / self.base_pitch_m
    }

    /// Returns the least and the greatest offset of pairs that carry load.
    pub fn offsets(&self) -> [i64; 2] {
        let pairs = self.positions.iter().flat_map(|p| &p.pairs);
        pairs.fold([0, 0], |[a, b], p| [a.min(p.offset), b.max(p.offset)])
    }

    /// Returns the load over the common face width \[N/m\].
    pub fn line_load(&self) -> f64 {
        self.force_n / self.face_width_m
    }
}
