//! The record of the frequency response to tooth meshing: forces and transmission errors of meshes and mounts by mesh
//! frequency.

use crate::record::Results;
use crate::record::checks::{each, same_length};
use crate::studies::Part;
use serde::{Deserialize, Serialize};

/// The part of a record that is specific to a frequency response.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ResponseRecord {
    /// Responses, model by model.
    pub responses: Vec<ModelResponse>,
}

impl Results {
    /// Returns the frequency responses; empty in records of other studies.
    pub fn responses(&self) -> &[ModelResponse] {
        match &self.part {
            Part::Response(part) => &part.responses,
            _ => &[],
        }
    }
}

/// The response of a model of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ModelResponse {
    /// Label of the model in its scene.
    pub label: String,
    /// Reason why the model has no response.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub message: String,
    /// Number of coordinates of the scene.
    pub coordinates: usize,
    /// Meshes that share a mesh frequency.
    pub groups: Vec<GroupResponse>,
}

impl ModelResponse {
    /// Checks the lengths of its lists.
    pub(crate) fn validate(&self) -> Result<(), String> {
        each("groups", &self.groups, |g| {
            if g.meshes.is_empty() {
                return Err("meshes is empty, expected one mesh or more".into());
            }
            each("points", &g.points, |p| {
                same_length(
                    "meshes",
                    p.meshes.len(),
                    "meshes of the group",
                    g.meshes.len(),
                )?;
                same_length(
                    "mounts",
                    p.mounts.len(),
                    "mounts of the group",
                    g.mounts.len(),
                )
            })
        })
    }
}

/// The response to meshes that share a mesh frequency.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct GroupResponse {
    /// Mesh frequency at the speeds of the scene [Hz].
    pub own_frequency_hz: f64,
    /// Meshes of the group at low speed.
    pub meshes: Vec<MeshLimit>,
    /// Names of the gears whose mounts are evaluated.
    pub mounts: Vec<String>,
    /// Resonance of these meshes: root mean square over their cycle of the natural frequency that strains them most [Hz].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resonance_hz: Option<f64>,
    /// Least and greatest of these frequencies over the cycle [Hz].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resonance_range_hz: Option<[f64; 2]>,
    /// The response, ascending in mesh frequency.
    pub points: Vec<ResponsePoint>,
}

/// A mesh that runs slowly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MeshLimit {
    /// Names of its gears.
    pub name: String,
    /// Mean contact force, along the normal of the flanks [N].
    pub force_n: f64,
    /// Mean stiffness between the hubs in the transverse plane [N/m]: force there over transmission error.
    pub stiffness_n_per_m: f64,
    /// Least and greatest stiffness over a cycle [N/m].
    pub stiffness_range_n_per_m: [f64; 2],
    /// Transmission error in the transverse plane, about its mean [m]: root mean square.
    pub error_rms_m: f64,
    /// Peak to peak of the transmission error [m].
    pub error_peak_to_peak_m: f64,
    /// Amplitudes of its harmonics [m].
    pub error_harmonics_m: Vec<f64>,
}

/// The response at a mesh frequency.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ResponsePoint {
    /// Mesh frequency [Hz].
    pub mesh_frequency_hz: f64,
    /// The meshes of the group.
    pub meshes: Vec<MeshPoint>,
    /// The mounts of the group.
    pub mounts: Vec<MountPoint>,
}

impl ResponsePoint {
    /// True if no flanks separate, so that the linear response is valid.
    pub fn is_linear(&self) -> bool {
        self.meshes.iter().all(|m| m.force_least_n > 0.0)
    }
}

/// A mesh at a mesh frequency.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MeshPoint {
    /// Transmission error about its mean [m]: root mean square.
    pub error_rms_m: f64,
    /// Peak to peak of the transmission error [m].
    pub error_peak_to_peak_m: f64,
    /// Amplitudes of its harmonics [m].
    pub error_harmonics_m: Vec<f64>,
    /// Root mean square of the force about its mean [N].
    pub force_rms_n: f64,
    /// Least force [N]; below zero flanks separate, and the linear response is not valid.
    pub force_least_n: f64,
    /// Greatest force [N].
    pub force_greatest_n: f64,
}

/// Force of a mount at a mesh frequency.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MountPoint {
    /// Root mean square of the force across the axis about its mean [N].
    pub rms_n: f64,
    /// Amplitudes of its harmonics [N], of both directions together.
    pub harmonics_n: Vec<f64>,
}
