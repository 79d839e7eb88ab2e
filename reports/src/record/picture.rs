//! Records for pictures: outlines and contacts in world coordinates.

use serde::{Deserialize, Serialize};

/// The mesh at one instant, in world coordinates, for the picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ContactSnapshot {
    /// The instant, usually that of the peak force \[s\].
    pub time_s: f64,
    /// Flank outlines of the gears, already turned and placed.
    pub outlines: Vec<Outline>,
    /// Ends of the line of action \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line_of_action: Option<[[f64; 2]; 2]>,
    /// Contacts that carry force.
    pub contacts: Vec<ContactPoint>,
}

/// The closed outline of one gear.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Outline {
    /// Name of the gear.
    pub gear: String,
    /// Corner points; the last joins the first \[m\].
    pub points: Vec<[f64; 2]>,
}

/// One contact of a snapshot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ContactPoint {
    /// Where it is \[m\].
    pub point: [f64; 2],
    /// Force on the second gear \[N\].
    pub force: [f64; 2],
    /// The tooth pair, for example `1-20`.
    pub pair: String,
    /// Hertz's pressure in its middle, of a line between flanks on half-spaces \[Pa\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_pa: Option<f64>,
    /// Half its width \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_width_m: Option<f64>,
}
