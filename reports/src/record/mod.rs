//! The versioned result records: all data of a report that it cannot compute itself.
//!
//! The JSON keys of [`Results`], [`Run`] and [`Metrics`] are a public format (`"schema": 2`). A key may be added
//! (`docs/results.schema.json` lists them all), but never renamed or given another meaning without a new schema number.
//! Quantities are in SI units, and the name of a key ends in its unit. A quantity that was not measured, or is not
//! finite, is absent: see [`finite`].

pub(crate) mod checks;
pub(crate) mod former;
mod mesh_force;
mod mesh_mode;
mod motion;
mod paths;
mod picture;
mod quantised;
mod run;
mod source;

use crate::metrics::Metric;
pub use crate::metrics::Metrics;
use crate::series::TimeSeries;
use crate::studies::choose::Adequacy;
use crate::studies::compare::Yardstick;
pub use crate::studies::sweep::{Bearing, StaticCycle, Steady};
pub use crate::studies::{Part, Study};
pub use mesh_force::MeshForce;
pub(crate) use mesh_mode::damping_to_text;
pub use mesh_mode::{MeshMode, damping_differs};
pub use motion::{
    BodyPath, BodySection, FrameContacts, FramePose, GearMotion, OUTLINE, PlainBody, ShaftSection,
    ShaftShape, ToothDisplacements, ToothedBody,
};
pub use paths::{MemberPath, MeshPath, PlanetShare, ShaftPath, Sharing, TorquePaths};
pub use picture::{
    ContactPoint, ContactSnapshot, DeformedSection, FlankGrid, FlankLoad, FlankPatch, FlankValue,
    Outline,
};
pub use quantised::Quantised;
pub use run::{ConvergedSettings, Run, Status};
use serde::{Deserialize, Serialize};
pub use source::Source;

/// Keys of values that depend on the clock or on the machine: two records of one study may differ in these, at every
/// depth.
pub const OF_THE_CLOCK: [&str; 22] = [
    "wall_s",
    "wall_spread_s",
    "wall_min_s",
    "wall_max_s",
    "repeats",
    "setup_s",
    "solve_s",
    "cost_s",
    "predicted_cost_s",
    "cpu_s",
    "cpu_per_simulated_time",
    "cpu_per_step_s",
    "cpu_per_evaluation_s",
    "estimate_s",
    // Of runs that are cheap for their error.
    "on_front",
    // Sentences and tables on times; others follow from what is compared.
    "finding",
    "summaries",
    "created",
    "machine",
    // The processor of a stored baseline.
    "cpu",
    "command",
    "reason",
];

/// The schema this crate writes, and the newest it reads.
pub const SCHEMA: u32 = 2;

/// Id of a model's own converged solution in [`Metrics::against`].
pub const SELF: &str = "self";

/// Returns `Some(x)` for a finite number, `None` otherwise.
pub fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

pub(crate) fn not_a_number(x: &Option<f64>) -> bool {
    !x.is_some_and(f64::is_finite)
}

fn is_not_finite(x: &f64) -> bool {
    !x.is_finite()
}

fn nan() -> f64 {
    f64::NAN
}

/// The header that all records share: scene, command, machine, version and inputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StudyHeader {
    /// Format version, [`SCHEMA`].
    pub schema: u32,
    /// Name of the scene.
    pub scene: String,
    /// One line that describes the simulation.
    #[serde(default)]
    pub title: String,
    /// Command line that makes the record again.
    pub command: String,
    /// Computer the times were measured on.
    pub machine: Machine,
    /// Commit of gearbench, with a mark when the tree had changes.
    pub commit: String,
    /// Time of the study (RFC 3339), as given by the caller.
    pub created: String,
    /// Inputs of the record; `None` in records of versions that did not keep them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
}

impl StudyHeader {
    /// Returns the title of the scene, or its name where it has none.
    pub fn name(&self) -> &str {
        match self.title.is_empty() {
            true => &self.scene,
            false => &self.title,
        }
    }
}

impl Default for StudyHeader {
    fn default() -> Self {
        Self {
            schema: SCHEMA,
            scene: String::new(),
            title: String::new(),
            command: String::new(),
            machine: Machine::default(),
            commit: String::new(),
            created: String::new(),
            source: None,
        }
    }
}

/// One study of one scene, or of several of which this is the first: the content of `results.json`, without levels between
/// header, part and the rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Results {
    /// Header that all records share.
    #[serde(flatten)]
    pub header: StudyHeader,
    /// Settings of the scene in the order of display: name, and value with unit.
    #[serde(default, with = "ordered_map", skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(test, schemars(with = "std::collections::BTreeMap<String, String>"))]
    pub settings: Vec<(String, String)>,
    /// Tolerance of the scene; absent where it states none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<Tolerance>,
    /// Independent references; charts show the first one as the dark line.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub references: Vec<ReferenceSeries>,
    /// Measured curves that the tables of the study are compared with.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measured: Vec<crate::measured::MeasuredCurve>,
    /// The mesh mode of each model, of studies of models of a scene with loads.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh_modes: Vec<MeshMode>,
    /// Part that is specific to the study, under the study's name.
    #[serde(flatten)]
    pub part: Part,
    /// The runs, failed ones included, in the order to be shown.
    pub runs: Vec<Run>,
    /// Records of the further scenes of a study of several scenes, in the order of its command, each as the study of that
    /// scene alone has it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<Results>,
}

impl Results {
    /// Returns the records of all scenes of the study, in the order of its command; of one scene the record itself.
    pub fn scenes(&self) -> impl Iterator<Item = &Results> {
        std::iter::once(self).chain(&self.further)
    }

    /// Returns the runs of each scene, in the order of [`Results::scenes`].
    pub fn runs_mut(&mut self) -> impl Iterator<Item = &mut Vec<Run>> {
        std::iter::once(&mut self.runs).chain(self.further.iter_mut().map(|r| &mut r.runs))
    }

    /// Joins the records of a study of one or several scenes; `None` without any.
    pub fn joined(records: impl IntoIterator<Item = Results>) -> Option<Results> {
        let mut records = records.into_iter();
        let mut first = records.next()?;
        first.further.extend(records);
        Some(first)
    }

    /// Returns the study that made the record.
    pub fn study(&self) -> Study {
        self.part.study()
    }

    /// Returns the name of the study, which is that of its command.
    pub fn study_name(&self) -> &str {
        match &self.part {
            Part::Tabular(part) => &part.name,
            other => other.study().as_str(),
        }
    }
}

/// The computer a study ran on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Machine {
    /// Processor, as the operating system names it.
    pub cpu: String,
    /// Number of logical processor cores.
    pub cores: usize,
    /// Name of the operating system.
    pub os: String,
    /// Architecture of the processor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arch: Option<String>,
    /// Build profile, such as `release`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// Remark on other influences on the times, for example further load on the machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// The scene's own limit: beyond it a run is `inaccurate`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Tolerance {
    /// Metric that the tolerance limits.
    pub metric: Metric,
    /// Largest adequate magnitude of the metric, in its unit.
    pub limit: f64,
    /// Reference it refers to, an id in [`Metrics::against`].
    pub against: String,
    /// Models by [`Run::model_label`] that the study includes for their error: beyond the limit they are inaccurate as
    /// others are, but this is no failure of the study.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub except: Vec<String>,
}

impl Tolerance {
    /// Compares a run with the tolerance: its value of the metric, and the verdict under the error of the yardstick, if
    /// that is what the tolerance refers to. A run that keeps it by chance ([`Run::agrees_by_chance`]) is not decided.
    /// `None` if the run has no such value.
    pub fn verdict(&self, run: &Run, yardstick: Option<&Yardstick>) -> Option<(f64, Adequacy)> {
        let x = run.against(&self.against)?.get(self.metric)?;
        let exact = Yardstick::default();
        let yardstick = yardstick.filter(|y| y.id == self.against).unwrap_or(&exact);
        let verdict = yardstick.verdict_on(run, (self.metric, x.abs()), self.limit);
        Some((x, verdict))
    }
}

/// Data from elsewhere that runs are compared with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ReferenceSeries {
    /// Id used by [`Metrics::against`], such as `calculix`.
    pub id: String,
    /// Name for legends, such as `CalculiX 2.20, C3D8`.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// Origin of the data: program, deck, file.
    pub source: String,
    /// Remark on the reference that its reader needs to judge it.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
    /// Own error of the reference, as a share of the quantities that runs are compared in [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub own_error: Option<f64>,
    /// Command that regenerates it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// Processor time it cost \[s\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub cpu_s: Option<f64>,
    /// Steps of processing between the reference's file and these data, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub processing: Vec<String>,
    /// Contact force of the reference and the columns at the same times.
    pub series: TimeSeries,
    /// Series of the reference at other times.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<TimeSeries>,
}

impl ReferenceSeries {
    /// Returns all series of the reference, the one with the contact force first.
    pub fn all_series(&self) -> Vec<&TimeSeries> {
        std::iter::once(&self.series).chain(&self.further).collect()
    }
}

/// Returns a text in lower-case letters, digits and single hyphens, for file names.
pub(crate) fn slug(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars().take(60) {
        if c.is_ascii_alphanumeric() {
            out.push(c.to_ascii_lowercase());
        } else if !out.is_empty() && !out.ends_with('-') {
            out.push('-');
        }
    }
    out.trim_end_matches('-').to_owned()
}

/// Returns the key of the last speed of a gear in tables and baselines.
pub fn speed_end(gear: &str) -> String {
    format!("speed_end_{gear}_rad_s")
}

/// Ledger of energy and impulse, with `energy_end = energy_start + external_work - dissipated + jumps + residual`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Ledger {
    /// Total energy at the start \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub energy_start_j: Option<f64>,
    /// Total energy at the end \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub energy_end_j: Option<f64>,
    /// Kinetic energy at the end \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub kinetic_j: Option<f64>,
    /// Strain energy of bodies and tooth springs at the end \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub strain_j: Option<f64>,
    /// Energy stored by the contact laws at the end \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub contact_j: Option<f64>,
    /// Work of loads and drives \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub external_work_j: Option<f64>,
    /// Energy dissipated by damping and friction \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub dissipated_j: Option<f64>,
    /// Energy that switching adds \[J\], such as a tooth pair that comes into contact with its full force.
    #[serde(skip_serializing_if = "not_a_number")]
    pub jumps_j: Option<f64>,
    /// Residual of the energy balance \[J\], the error of the integration.
    #[serde(skip_serializing_if = "not_a_number")]
    pub residual_j: Option<f64>,
    /// The residual over the largest energy in the ledger [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub residual_rel: Option<f64>,
    /// Energy that energy growth is compared with \[J\]: the largest sum of strain energy, contact energy and
    /// vibrational kinetic energy of the gears, plus the energy that passed through contacts.
    #[serde(skip_serializing_if = "not_a_number")]
    pub vibrating_j: Option<f64>,
    /// Impulse of the contact force along the line of action [N s].
    #[serde(skip_serializing_if = "not_a_number")]
    pub impulse_ns: Option<f64>,
    /// Drift of the momentum invariant L1/r_b1 - L2/r_b2 over the impulse [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub invariant_drift_rel: Option<f64>,
}

/// A list of pairs as a JSON object that keeps its order.
pub(crate) mod ordered_map {
    use serde::de::{Deserialize, MapAccess, Visitor};
    use serde::{Deserializer, Serialize, Serializer};
    use std::marker::PhantomData;

    type Pairs<T> = Vec<(String, T)>;

    pub fn serialize<S: Serializer, T: Serialize>(
        pairs: &Pairs<T>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_map(pairs.iter().map(|(k, v)| (k, v)))
    }

    pub fn deserialize<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
        deserializer: D,
    ) -> Result<Pairs<T>, D::Error> {
        struct PairsVisitor<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for PairsVisitor<T> {
            type Value = Pairs<T>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Pairs<T>, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(pairs)
            }
        }
        deserializer.deserialize_map(PairsVisitor(PhantomData))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records of former versions may have columns that are no longer in use.
    #[test]
    fn ledgers_of_older_records_are_read() {
        let text = r#"{"energy_start_j": 2.0, "parametric_work_j": 0.0, "dissipated_j": 0.5}"#;
        let ledger: Ledger = serde_json::from_str(text).unwrap();
        assert_eq!(
            (ledger.energy_start_j, ledger.dissipated_j),
            (Some(2.0), Some(0.5))
        );
    }
}
