//! The record of loaded running: steady states over whole mesh cycles, and the quasi-static limit.
//!
//! The transmission error is the displacement of the first gear ahead of rigid, unmodified flanks in contact, along the
//! line of action \[m\], positive under load. Positions in a cycle are path coordinates of the reference pair from the
//! pitch point over the base pitch, computed from the rotation of the second gear. Harmonics are amplitudes (half of
//! peak to peak) at one, two, ... times the mesh frequency.

use crate::record::checks::same_length;
use crate::record::{Results, Run};
use crate::studies::Part;
use crate::words::words;
use serde::{Deserialize, Serialize};

/// The part of a record that is specific to loaded running.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SweepRecord {
    /// Quasi-static mesh cycles, one per model: the limit of low speed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub statics: Vec<StaticCycle>,
}

impl Results {
    /// Returns the quasi-static mesh cycles; empty in records of other studies.
    pub fn statics(&self) -> &[StaticCycle] {
        match &self.part {
            Part::Sweep(part) => &part.statics,
            _ => &[],
        }
    }
}

words! {
    /// Initial state of a run at its speed. A mesh with backlash may have several steady states at one speed, and stays
    /// on the branch that it comes from.
    pub enum Branch {
        /// Start from unloaded contact, under a rising load.
        #[default]
        Fresh = "fresh",
        /// Start from the steady state of the next lower speed.
        Up = "up",
        /// Start from the steady state of the next higher speed.
        Down = "down",
    }
}

/// Ranges of mesh frequency in which a model has different steady states on the way up and on the way down.
#[derive(Clone, Debug, PartialEq)]
pub struct Bistable {
    /// The model, as its runs call it.
    pub label: String,
    /// Lowest and highest mesh frequency of each range \[Hz\].
    pub ranges: Vec<[f64; 2]>,
}

/// Relative difference of the transmission errors (root mean square) up and down from which on they are two steady
/// states.
const APART: f64 = 0.1;

/// Returns the models of a record with two steady states at one speed, and the ranges of mesh frequency.
pub fn bistable(results: &Results) -> Vec<Bistable> {
    let steady = |branch: Branch, label: &str| -> Vec<&Steady> {
        let mut found: Vec<&Steady> = (results.runs.iter())
            .filter(|r| !r.status.is_failure() && r.model_label() == label)
            .filter_map(|r| r.steady.as_ref())
            .filter(|s| s.branch == branch)
            .collect();
        found.sort_by(|a, b| a.mesh_frequency_hz.total_cmp(&b.mesh_frequency_hz));
        found
    };
    let mut labels: Vec<String> = results.runs.iter().map(Run::model_label).collect();
    labels.dedup();
    let mut all = Vec::new();
    for label in labels {
        let (up, down) = (steady(Branch::Up, &label), steady(Branch::Down, &label));
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        let mut goes_on = false;
        for u in up {
            let f = u.mesh_frequency_hz;
            let off = |s: &&&Steady| (s.mesh_frequency_hz - f).abs();
            let Some(d) = down.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else {
                break;
            };
            let (a, b) = (u.error_rms_m, d.error_rms_m);
            let two = off(&d) < 1e-3 * f && (a - b).abs() > APART * a.max(b);
            match ranges.last_mut().filter(|_| goes_on && two) {
                Some(range) => range[1] = f,
                None if two => ranges.push([f, f]),
                None => {}
            }
            goes_on = two;
        }
        if !ranges.is_empty() {
            all.push(Bistable { label, ranges });
        }
    }
    all
}

/// Steady running at one speed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Steady {
    /// Initial state of the run at its speed.
    pub branch: Branch,
    /// Mesh frequency \[Hz\], of the mean speed in the window.
    pub mesh_frequency_hz: f64,
    /// Mean speed of the first gear [rad/s].
    pub speed_rad_s: f64,
    /// Whole mesh cycles that were measured.
    pub cycles: usize,
    /// Mean transmission error \[m\].
    pub error_mean_m: f64,
    /// Root mean square about the mean \[m\].
    pub error_rms_m: f64,
    /// Peak to peak of the transmission error \[m\].
    pub error_peak_to_peak_m: f64,
    /// Amplitudes of the transmission error at one, two, ... times the mesh frequency \[m\].
    pub error_harmonics_m: Vec<f64>,
    /// Peak to peak of the transmission error averaged over a moving mesh cycle \[m\]: the part by deviations from
    /// tooth to tooth.
    pub error_long_peak_to_peak_m: f64,
    /// Amplitudes at the orders of the shafts; empty unless whole turns were measured.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shaft_orders: Vec<ShaftOrders>,
    /// Mean contact force \[N\].
    pub force_mean_n: f64,
    /// Greatest contact force \[N\].
    pub force_peak_n: f64,
    /// Part of the time without any contact force [-].
    pub separated: f64,
    /// Root mean square of the part that does not repeat from cycle to cycle, over that of the part that does [-].
    pub irregular: f64,
    /// Bearing forces by gear.
    pub bearings: Vec<Bearing>,
    /// Positions in one cycle, -0.5 to 0.5.
    pub position: Vec<f64>,
    /// Transmission error there, mean of the cycles \[m\].
    pub error_cycle_m: Vec<f64>,
    /// Contact force there, mean of the cycles \[N\].
    pub force_cycle_n: Vec<f64>,
}

/// Transmission error at multiples of the speed of a shaft.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ShaftOrders {
    /// Name of the gear.
    pub gear: String,
    /// Number of teeth, the order of the mesh frequency.
    pub teeth: usize,
    /// Amplitudes at one, two, ... times its turns per second \[m\].
    pub error_m: Vec<f64>,
}

/// Force of a gear on its bearing over whole mesh cycles.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Bearing {
    /// Name of the gear.
    pub gear: String,
    /// The force contains the inertia of the gear's own vibration; otherwise it is the contact force handed on.
    pub own_inertia: bool,
    /// Magnitude of the mean force \[N\].
    pub mean_n: f64,
    /// Root mean square of the force about its mean \[N\].
    pub rms_n: f64,
    /// Harmonics, of both directions together \[N\].
    pub harmonics_n: Vec<f64>,
}

/// A model at rest under the same load, over one mesh cycle: the limit of slow running.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct StaticCycle {
    /// The model, as its runs call it.
    pub label: String,
    /// Force along the line of action \[N\].
    pub force_n: f64,
    /// Positions in the cycle.
    pub position: Vec<f64>,
    /// Static transmission error there \[m\].
    pub error_m: Vec<f64>,
    /// Mean transmission error \[m\].
    pub error_mean_m: f64,
    /// Peak to peak of the transmission error \[m\].
    pub error_peak_to_peak_m: f64,
    /// Mean tangent stiffness along the line of action \[N/m\].
    pub tangent_n_per_m: f64,
    /// Resonance of the mesh: root mean square over its cycle of the natural frequency that strains it most \[Hz\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resonance_hz: Option<f64>,
    /// Least and greatest of these frequencies over the cycle \[Hz\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resonance_range_hz: Option<[f64; 2]>,
}

impl Steady {
    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        let single = [
            self.mesh_frequency_hz,
            self.speed_rad_s,
            self.error_mean_m,
            self.error_rms_m,
            self.error_peak_to_peak_m,
            self.error_long_peak_to_peak_m,
            self.force_mean_n,
            self.force_peak_n,
            self.separated,
            self.irregular,
        ];
        let lists = [
            &self.error_harmonics_m,
            &self.position,
            &self.error_cycle_m,
            &self.force_cycle_n,
        ];
        let bearings = self.bearings.iter().flat_map(|b| {
            let of = [b.mean_n, b.rms_n];
            of.into_iter().chain(b.harmonics_n.iter().copied())
        });
        let orders = self
            .shaft_orders
            .iter()
            .flat_map(|o| o.error_m.iter().copied());
        (single.into_iter())
            .chain(lists.into_iter().flatten().copied())
            .chain(bearings)
            .chain(orders)
            .all(f64::is_finite)
    }
}

impl Steady {
    /// Checks the lengths of its lists.
    pub(crate) fn validate(&self) -> Result<(), String> {
        let n = self.position.len();
        same_length("error_cycle_m", self.error_cycle_m.len(), "position", n)?;
        same_length("force_cycle_n", self.force_cycle_n.len(), "position", n)
    }
}

impl StaticCycle {
    /// Checks the lengths of its lists.
    pub(crate) fn validate(&self) -> Result<(), String> {
        same_length(
            "error_m",
            self.error_m.len(),
            "position",
            self.position.len(),
        )
    }

    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        let single = [
            self.force_n,
            self.error_mean_m,
            self.error_peak_to_peak_m,
            self.tangent_n_per_m,
        ];
        let lists = self.position.iter().chain(&self.error_m);
        lists.chain(&single).all(|x| x.is_finite())
    }

    /// Computes the root mean square of the transmission error about its mean \[m\].
    pub fn rms(&self) -> f64 {
        let n = self.error_m.len().max(1) as f64;
        let of = |e: &f64| (e - self.error_mean_m).powi(2);
        (self.error_m.iter().map(of).sum::<f64>() / n).sqrt()
    }
}
