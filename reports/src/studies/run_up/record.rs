//! The record of a run-up: amplitudes over the speed of a reference gear, by frequency and by order.
//!
//! Amplitudes are half of peak to peak; the amplitude of a bearing force is the root of the sum of squares of those of
//! its two radial components. Orders count per turn of the reference gear.

use crate::record::Results;
use crate::record::checks::{each, same_length};
use crate::studies::Part;
use serde::{Deserialize, Serialize};

/// The part of a record that is specific to a run-up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RunUpRecord {
    /// Run-ups, model by model.
    pub run_ups: Vec<ModelRunUp>,
}

impl Results {
    /// Returns the run-ups of models; empty in records of other studies.
    pub fn run_ups(&self) -> &[ModelRunUp] {
        match &self.part {
            Part::RunUp(part) => &part.run_ups,
            _ => &[],
        }
    }
}

/// The run-up of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ModelRunUp {
    /// Label of the model in its scene.
    pub label: String,
    /// Reason why the model has no run-up.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub message: String,
    /// Name of the reference gear, in whose turns orders are counted.
    pub gear: String,
    /// Time from which on the run is evaluated [s].
    pub onset_s: f64,
    /// Number of turns of the reference gear from `onset_s` on.
    pub turns: f64,
    /// Lowest speed of the reference gear, mean of a window [rad/s].
    pub lowest_rad_s: f64,
    /// Highest speed of the reference gear, mean of a window [rad/s].
    pub highest_rad_s: f64,
    /// Orders whose amplitudes were computed over the speed.
    pub orders: Vec<TrackedOrder>,
    /// Windows of equal time; their lines are frequencies [Hz].
    pub by_time: RunUpMap,
    /// Windows of equal turns; their lines are orders.
    pub by_turns: RunUpMap,
    /// Natural frequencies of the scene under its loads, within the range of the spectra.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub natural: Vec<NaturalFrequency>,
    /// Transmission errors, mesh forces, bearing forces.
    pub channels: Vec<RunUpChannel>,
}

/// An order that was followed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TrackedOrder {
    /// Name of the frequency that the order is a multiple of.
    pub name: String,
    /// Cycles per turn of the reference gear.
    pub order: f64,
    /// True for an order of teeth in mesh, false for one of a shaft.
    pub of_mesh: bool,
}

/// Windows of a map, and its lines.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct RunUpMap {
    /// Length of a window: [s] or turns. Lines closer than twice its inverse are not resolved.
    pub span: f64,
    /// Time in the middle of each window [s].
    pub time_s: Vec<f64>,
    /// Mean speed of the reference gear in each [rad/s].
    pub speed_rad_s: Vec<f64>,
    /// Frequencies [Hz] or orders.
    pub lines: Vec<f64>,
}

/// A natural frequency of the scene under its loads.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct NaturalFrequency {
    /// Natural frequency without damping [Hz].
    pub frequency_hz: f64,
    /// Name of the spring that stores most of its strain energy.
    pub name: String,
}

/// A quantity over the run-up, in its SI unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct RunUpChannel {
    /// Name of its column in files.
    pub column: String,
    /// Name of the quantity in words.
    pub name: String,
    /// Unit of its amplitudes.
    pub unit: String,
    /// Amplitudes of the orders that were followed, each over the windows of turns.
    pub orders: Vec<Vec<f64>>,
    /// Amplitudes by window of time and frequency; of planets that are alike the first has them for all.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub spectra: Vec<Vec<f64>>,
    /// Amplitudes by window of turns and order; of planets that are alike the first has them for all.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub order_spectra: Vec<Vec<f64>>,
}

/// Largest amplitude of a quantity along an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak<'a> {
    /// Quantity whose amplitude peaks.
    pub channel: &'a RunUpChannel,
    /// Order along which it peaks.
    pub order: &'a TrackedOrder,
    /// Largest amplitude along the order, in the unit of the quantity.
    pub amplitude: f64,
    /// The speed there [rad/s].
    pub speed_rad_s: f64,
    /// True if it is at an end of the run-up, so that the order may grow further beyond.
    pub at_the_end: bool,
}

impl Peak<'_> {
    /// Returns the frequency of the order at the peak [Hz].
    pub fn frequency_hz(&self) -> f64 {
        self.order.order * self.speed_rad_s / std::f64::consts::TAU
    }
}

impl ModelRunUp {
    /// Returns the peak of an order of a quantity.
    pub fn peak<'a>(&'a self, channel: &'a RunUpChannel, order: usize) -> Option<Peak<'a>> {
        let amplitudes = channel.orders.get(order)?;
        let at = (0..amplitudes.len()).max_by(|a, b| amplitudes[*a].total_cmp(&amplitudes[*b]))?;
        Some(Peak {
            channel,
            order: self.orders.get(order)?,
            amplitude: amplitudes[at],
            speed_rad_s: *self.by_turns.speed_rad_s.get(at)?,
            at_the_end: at == 0 || at + 1 == amplitudes.len(),
        })
    }

    /// Checks what the types do not enforce.
    ///
    /// # Errors
    /// A sentence that names the lists whose lengths differ.
    pub fn validate(&self) -> Result<(), String> {
        for (key, map) in [("by_time", &self.by_time), ("by_turns", &self.by_turns)] {
            let (speeds, windows) = (map.speed_rad_s.len(), map.time_s.len());
            same_length(&format!("{key}.speed_rad_s"), speeds, "time_s", windows)?;
        }
        let fits = |key: &str, rows: &[Vec<f64>], map: &RunUpMap| {
            if rows.is_empty() {
                return Ok(());
            }
            same_length(key, rows.len(), "time_s", map.time_s.len())?;
            each(key, rows, |r| {
                same_length("length", r.len(), "lines", map.lines.len())
            })
        };
        each("channels", &self.channels, |c| {
            same_length(
                "orders",
                c.orders.len(),
                "orders of the run-up",
                self.orders.len(),
            )?;
            let windows = self.by_turns.time_s.len();
            each("orders", &c.orders, |o| {
                same_length("length", o.len(), "by_turns.time_s", windows)
            })?;
            fits("spectra", &c.spectra, &self.by_time)?;
            fits("order_spectra", &c.order_spectra, &self.by_turns)
        })
    }
}

/// Returns, for each quantity, the peaks of its `each` strongest orders, the largest first.
pub fn strongest(run: &ModelRunUp, each: usize) -> Vec<Peak<'_>> {
    let mut all = Vec::new();
    for channel in &run.channels {
        let mut peaks: Vec<Peak<'_>> = (0..run.orders.len())
            .filter_map(|k| run.peak(channel, k))
            .collect();
        peaks.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        all.extend(peaks.into_iter().take(each));
    }
    all
}
