//! The record of natural frequencies: the state of linearisation, frequencies, shapes and energies of the modes.

use crate::record::checks::{each, same_length};
use crate::record::{GearMotion, Results};
use crate::studies::Part;
use crate::words::words;
use serde::{Deserialize, Serialize};

/// The part of a record that is specific to natural frequencies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ModesRecord {
    /// Natural frequencies, model by model.
    pub vibrations: Vec<ModelModes>,
}

impl Results {
    /// Returns the natural frequencies of models; empty in records of other studies.
    pub fn vibrations(&self) -> &[ModelModes] {
        match &self.part {
            Part::Modes(part) => &part.vibrations,
            _ => &[],
        }
    }
}

words! {
    /// The state that frequencies are about.
    pub enum LinearisedState {
        /// The equilibrium under the loads.
        #[default]
        Loaded = "loaded",
        /// The start, pressed together, without loads.
        Preloaded = "preloaded",
        /// The state has no flanks in contact: the start, or the end of the motion under the loads.
        Apart = "apart",
        /// The state does not exist, or was not found.
        NotFound = "not found",
    }
}

/// Natural frequencies of a model of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ModelModes {
    /// Label of the model in its scene.
    pub label: String,
    /// State in which the model is linearised.
    pub about: LinearisedState,
    /// Reason why there are no frequencies, or a remark on them.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub message: String,
    /// Number of coordinates of the scene.
    pub coordinates: usize,
    /// Number of constraints on the coordinates: rigid shafts, and fixed members of planetary sets.
    pub constraints: usize,
    /// Newton steps to the state.
    pub steps: u32,
    /// Largest residual of a mode over the size of the stiffness [-].
    pub residual_rel: f64,
    /// Frequencies in all, with those that are not listed.
    pub frequencies: usize,
    /// The highest of all [Hz].
    pub highest_hz: f64,
    /// Meshes with their forces in the state.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<MeshState>,
    /// Gears, and behind them bodies on shafts.
    pub members: Vec<MemberPlace>,
    /// Names of the springs that store strain energy, in the order of the shares of modes.
    pub springs: Vec<String>,
    /// Modes by frequency, rigid motions first.
    pub modes: Vec<ModeRecord>,
    /// The first modes as a motion: frame 0 is the state of linearisation, frame k the amplitude of mode k.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<GearMotion>,
}

impl ModelModes {
    /// Checks the lengths of its lists.
    pub(crate) fn validate(&self) -> Result<(), String> {
        if let Some(motion) = &self.motion {
            motion.validate().map_err(|e| format!("motion.{e}"))?;
            if !motion.is_of_modes() || motion.frames() > self.modes.len() + 1 {
                return Err(format!(
                    "motion has {} times and {} frames, expected no times, and at most one frame for each of {} modes and one at rest",
                    motion.time_s.len(),
                    motion.frames(),
                    self.modes.len()
                ));
            }
        }
        each("modes", &self.modes, |m| {
            let (members, springs) = (self.members.len(), self.springs.len());
            same_length("kinetic", m.kinetic.len(), "members", members)?;
            same_length("shape", m.shape.len(), "members", members)?;
            // A rigid motion strains nothing.
            if m.strain.is_empty() {
                return Ok(());
            }
            same_length("strain", m.strain.len(), "springs", springs)
        })
    }
}

/// A mesh in the state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MeshState {
    /// Names of its gears.
    pub name: String,
    /// Sum of its normal forces [N]; 0 if its flanks are separated.
    pub force_n: f64,
}

/// A member of the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MemberPlace {
    /// Name of the gear or body.
    pub name: String,
    /// First coordinate of its hub in the plane normal to the axis of the first gear [m].
    pub x_m: f64,
    /// Second coordinate of its hub in that plane [m]; see `x_m`.
    pub y_m: f64,
    /// Radius by which its turn displaces flanks [m]; 1 for a sliding member.
    pub radius_m: f64,
    /// True if the member slides instead of turning: its turn is then a displacement in [m].
    pub slides: bool,
    /// True if the member is a gear.
    pub toothed: bool,
    /// True if its axis is parallel to that of the first gear.
    pub in_plane: bool,
}

/// A mode, or several of one frequency.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ModeRecord {
    /// Natural frequency without damping [Hz].
    pub frequency_hz: f64,
    /// Number of modes with this frequency; if several, shares are those of all together.
    pub multiplicity: usize,
    /// Damping ratio [-]; absent of rigid motions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_ratio: Option<f64>,
    /// Frequency with damping and gyroscopic terms [Hz], where these couple modes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damped_frequency_hz: Option<f64>,
    /// Name of the mode, by where its energy lies.
    pub name: String,
    /// Shares of members in the kinetic energy [-].
    pub kinetic: Vec<f64>,
    /// Shares of springs in the strain energy [-]; none of rigid motions.
    pub strain: Vec<f64>,
    /// Motions of members, of several modes the first, scaled to a largest displacement at a flank of 1 um.
    pub shape: Vec<MemberShape>,
}

/// Motion of a member in a mode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MemberShape {
    /// Turn of the hub [rad]; displacement of a sliding member [m].
    pub turn_rad: f64,
    /// Displacement of the hub along its first axis [m].
    pub x_m: f64,
    /// Displacement of the hub along its second axis [m].
    pub y_m: f64,
    /// Displacement of the hub along the axis of the gear [m].
    pub z_m: f64,
    /// Tilt about its first axis [rad].
    pub tilt_x_rad: f64,
    /// Tilt about its second axis [rad].
    pub tilt_y_rad: f64,
    /// Share of the member's own coordinates (teeth, modes) in the total kinetic energy [-].
    pub own: f64,
}
