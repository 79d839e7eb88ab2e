//! The record of pictures: outlines, contacts and flank loads in world coordinates.

use super::checks::{each, same_length};
use serde::{Deserialize, Serialize};

/// The mesh at one instant, in world coordinates, for the picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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
    /// Loads on the flanks of each mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub flanks: Vec<FlankLoad>,
    /// Sections of deformed flanks of elastic gears.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub deformed: Vec<DeformedSection>,
}

impl ContactSnapshot {
    /// Checks the lengths of its lists.
    pub(super) fn validate(&self) -> Result<(), String> {
        each("deformed", &self.deformed, |d| {
            let points = d.points.len();
            same_length("displacements", d.displacements.len(), "points", points)
        })?;
        each("flanks", &self.flanks, |f| {
            let Some(grid) = &f.over_run else {
                return Ok(());
            };
            if grid.rows == 0 || grid.columns == 0 {
                return Err("over_run has `rows` or `columns` of 0, expected 1 or more".into());
            }
            let cells = grid.rows.saturating_mul(grid.columns);
            same_length(
                "over_run.values",
                grid.values.len(),
                "rows times columns",
                cells,
            )
        })
    }
}

/// The closed outline of one gear.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Outline {
    /// Name of the gear.
    pub gear: String,
    /// Corner points; the last joins the first \[m\].
    pub points: Vec<[f64; 2]>,
}

/// One contact of a snapshot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ContactPoint {
    /// Position of the contact \[m\].
    pub point: [f64; 2],
    /// Force on the second gear \[N\].
    pub force: [f64; 2],
    /// The tooth pair, for example `1-20`.
    pub pair: String,
    /// Hertz's pressure in its middle, of a line between flanks on half-spaces \[Pa\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_pa: Option<f64>,
    /// Half width of the contact \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_width_m: Option<f64>,
}

/// A section of a flank of an elastic gear, from the root to the tip.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct DeformedSection {
    /// Name of the gear.
    pub gear: String,
    /// The tooth, counted from 1.
    pub tooth: i64,
    /// Side of the tooth, `left` or `right`.
    pub side: String,
    /// Positions of the nodes under the rigid motion alone \[m\].
    pub points: Vec<[f64; 2]>,
    /// Elastic displacements of the nodes from these positions \[m\].
    pub displacements: Vec<[f64; 2]>,
}

/// Load on the flanks of the first gear of a mesh: contacts at the instant of the picture, and maxima over the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FlankLoad {
    /// The mesh, counted from 1.
    pub mesh: usize,
    /// Name of the gear.
    pub gear: String,
    /// Side of its teeth, `left` or `right`.
    pub side: String,
    /// Quantity of the values of patches and grid.
    pub value: FlankValue,
    /// Lengths of roll at the form circle and at the tip \[m\].
    pub roll_m: [f64; 2],
    /// Lower and upper end of the face from its middle \[m\].
    pub width_m: [f64; 2],
    /// Contacts at the instant of the snapshot.
    pub patches: Vec<FlankPatch>,
    /// The greatest of several instants of the run, teeth laid on each other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_run: Option<FlankGrid>,
}

/// Quantity that a flank is coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum FlankValue {
    /// Contact pressure \[Pa\].
    #[default]
    Pressure,
    /// Force per width \[N/m\].
    LineLoad,
}

/// A contact on a flank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FlankPatch {
    /// The tooth, counted from 1.
    pub tooth: i64,
    /// Length of roll \[m\].
    pub roll_m: f64,
    /// Height of its middle along the axis, from the middle of the face \[m\].
    pub height_m: f64,
    /// Extent along the length of roll, 0 of a line, and over the width \[m\].
    pub size_m: [f64; 2],
    /// Normal force \[N\].
    pub force_n: f64,
    /// Pressure or force per width \[Pa, N/m\].
    pub value: f64,
}

/// Values over a flank: rows from the form circle to the tip at equal steps of the length of roll, columns from the
/// lower to the upper end of the face; 0 without contact.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FlankGrid {
    /// Number of instants of the run that were evaluated.
    pub instants: usize,
    /// Rows over the profile.
    pub rows: usize,
    /// Columns over the width.
    pub columns: usize,
    /// Row by row \[Pa, N/m\].
    pub values: Vec<f64>,
}

impl FlankLoad {
    /// True if all numbers are finite and the ranges of roll and width are ascending.
    pub(super) fn is_sound(&self) -> bool {
        let patch = |p: &FlankPatch| {
            let numbers = [
                p.roll_m,
                p.height_m,
                p.size_m[0],
                p.size_m[1],
                p.force_n,
                p.value,
            ];
            numbers.iter().all(|x| x.is_finite())
        };
        let grid = |g: &FlankGrid| g.values.iter().all(|x| x.is_finite());
        let ends = self.roll_m.iter().chain(&self.width_m);
        self.patches.iter().all(patch)
            && self.over_run.as_ref().is_none_or(grid)
            && ends.clone().all(|x| x.is_finite())
            && self.roll_m[0] < self.roll_m[1]
            && self.width_m[0] < self.width_m[1]
    }
}
