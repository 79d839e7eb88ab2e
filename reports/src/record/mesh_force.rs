//! The record of the contact force of each mesh, for scenes with several meshes.

use serde::{Deserialize, Serialize};

/// Numbers of the contact force of a mesh over a run that reached its end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MeshForce {
    /// Names of its gears.
    pub gears: [String; 2],
    /// Greatest force \[N\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_force_n: Option<f64>,
    /// Root mean square of the force over the run \[N\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_force_n: Option<f64>,
    /// Duration of the first contact \[s\]; absent where the teeth never touch, or never part again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_contact_s: Option<f64>,
    /// Root mean square over the run of the part of the force above [`MeshForce::ripple_above_hz`] \[N\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ripple_rms_n: Option<f64>,
    /// The frequency `ripple_above_hz` of the scene's study \[Hz\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ripple_above_hz: Option<f64>,
}
