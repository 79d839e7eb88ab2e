//! The versioned result records: everything a report needs and nothing it could compute itself.
//!
//! The JSON keys of [`Results`], [`Run`] and [`Metrics`] are a public format (`"schema": 1`): a key
//! may be added, never renamed or given another meaning without a new schema number. Quantities are
//! in SI units, the unit stands at the end of the name. A quantity that was not measured, or is not
//! finite, is absent: use [`finite`].

mod checks;
mod picture;

use crate::metrics::{Finished, Metric, Unfinished};
use crate::series::TimeSeries;
pub use crate::studies::sweep::{Bearing, StaticCycle, Steady};
pub use crate::studies::{Part, Study};
pub use picture::{ContactPoint, ContactSnapshot, Outline};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The schema this crate writes, and the newest it reads.
pub const SCHEMA: u32 = 1;

/// `Some(x)` for a finite number, `None` otherwise.
pub fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn not_a_number(x: &Option<f64>) -> bool {
    !x.is_some_and(f64::is_finite)
}

fn is_not_finite(x: &f64) -> bool {
    !x.is_finite()
}

fn nan() -> f64 {
    f64::NAN
}

/// What every record says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyHeader {
    /// Format version, [`SCHEMA`].
    pub schema: u32,
    /// Name of the scene.
    pub scene: String,
    /// One line that tells a reader what is simulated.
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
        }
    }
}

/// One study of one scene: the content of `results.json`, without levels between header, part and the rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// What every record says of itself.
    #[serde(flatten)]
    pub header: StudyHeader,
    /// Settings of the scene in the order to be shown: what, value with unit.
    #[serde(default, with = "ordered_map", skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<(String, String)>,
    /// What the scene calls accurate enough.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<Tolerance>,
    /// Independent references; the first is the one the charts show as the dark line.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub references: Vec<ReferenceSeries>,
    /// What the study alone has, under its name.
    #[serde(flatten)]
    pub part: Part,
    /// The runs, failed ones included, in the order to be shown.
    pub runs: Vec<Run>,
}

impl Results {
    /// The study that made the record.
    pub fn study(&self) -> Study {
        self.part.study()
    }
}

/// The computer a study ran on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Machine {
    /// Processor, as the operating system names it.
    pub cpu: String,
    /// Logical cores.
    pub cores: usize,
    /// Operating system.
    pub os: String,
    /// Processor architecture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arch: Option<String>,
    /// Build profile, such as `release`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// Whatever else bears on the times, for example that other work ran beside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// The scene's own limit: beyond it a run is `inaccurate`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// The metric it limits.
    pub metric: Metric,
    /// Greatest magnitude that is accurate enough, in the metric's unit.
    pub limit: f64,
    /// Reference it refers to, an id in [`Metrics::against`].
    pub against: String,
}

/// Data from elsewhere that runs are compared with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReferenceSeries {
    /// Id used by [`Metrics::against`], such as `calculix`.
    pub id: String,
    /// Name for legends, such as `CalculiX 2.20, C3D8`.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// Where the data come from: program, deck, file.
    pub source: String,
    /// What a reader has to know to judge it.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
    /// Command that regenerates it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// Processor time it cost \[s\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub cpu_s: Option<f64>,
    /// The data.
    pub series: TimeSeries,
}

/// How a run ended. All but [`Status::Converged`] are drawn as what they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Status {
    /// Reached the end within the scene's tolerance.
    #[default]
    #[serde(rename = "converged")]
    Converged,
    /// Reached the end beyond the scene's tolerance.
    #[serde(rename = "inaccurate")]
    Inaccurate,
    /// The energy ledger gained what nothing put in.
    #[serde(rename = "energy growth")]
    EnergyGrowth,
    /// Contact opened and closed without end.
    #[serde(rename = "chatter")]
    Chatter,
    /// Newton's method did not converge.
    #[serde(rename = "newton failure")]
    NewtonFailure,
    /// Step control went below the smallest step.
    #[serde(rename = "step underflow")]
    StepUnderflow,
    /// A state was not finite, or out of all bounds.
    #[serde(rename = "blow-up")]
    BlowUp,
    /// A tooth passed through another unseen.
    #[serde(rename = "tunnelling")]
    Tunnelling,
    /// A contact pulled.
    #[serde(rename = "adhesive force")]
    AdhesiveForce,
    /// The run was stopped for taking too long.
    #[serde(rename = "timeout")]
    Timeout,
}

impl Status {
    /// Every status.
    pub const ALL: [Self; 10] = [
        Self::Converged,
        Self::Inaccurate,
        Self::EnergyGrowth,
        Self::Chatter,
        Self::NewtonFailure,
        Self::StepUnderflow,
        Self::BlowUp,
        Self::Tunnelling,
        Self::AdhesiveForce,
        Self::Timeout,
    ];

    /// The words of the format and of the report.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Inaccurate => "inaccurate",
            Self::EnergyGrowth => "energy growth",
            Self::Chatter => "chatter",
            Self::NewtonFailure => "newton failure",
            Self::StepUnderflow => "step underflow",
            Self::BlowUp => "blow-up",
            Self::Tunnelling => "tunnelling",
            Self::AdhesiveForce => "adhesive force",
            Self::Timeout => "timeout",
        }
    }

    /// Whether the run's numbers must not be used: everything but converged and inaccurate.
    pub fn is_failure(self) -> bool {
        !matches!(self, Self::Converged | Self::Inaccurate)
    }
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

/// One model under one integrator.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Model id: `rigid`, `movable-teeth`, `elastic`, `fe`.
    pub model: String,
    /// What sets this model apart from others of its id, such as `k = 3.6e10 N/m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// Integrator id.
    pub integrator: String,
    /// Whether the integrator is implicit.
    #[serde(default)]
    pub implicit: bool,
    /// Whether the integrator solves the linear part of the model exactly.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub exact_linear: bool,
    /// Fixed step \[s\].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub step: Option<f64>,
    /// Relative tolerance of an adaptive method [-].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub rtol: Option<f64>,
    /// How it ended.
    pub status: Status,
    /// Why it did not converge: when, and how much; or what to know of a run that did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Wall time, the median of the repeats \[s\].
    #[serde(default = "nan", skip_serializing_if = "is_not_finite")]
    pub wall_s: f64,
    /// Shortest and longest wall time of the repeats \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_spread_s: Option<[f64; 2]>,
    /// Number of timed repeats without observers; 0 when the observed run itself was timed.
    #[serde(default)]
    pub repeats: u32,
    /// Fixed cost before the first step: mesh, modes, factorisation \[s\].
    #[serde(default = "nan", skip_serializing_if = "is_not_finite")]
    pub setup_s: f64,
    /// Simulated time reached \[s\].
    #[serde(default = "nan", skip_serializing_if = "is_not_finite")]
    pub simulated_s: f64,
    /// Time that it was to reach \[s\]; known while a study runs, a record has the metrics.
    #[serde(skip)]
    pub end_s: Option<f64>,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of the force.
    pub force_evaluations: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Matrix factorisations.
    pub factorisations: u64,
    /// Located events.
    #[serde(default)]
    pub events: u64,
    /// Degrees of freedom.
    pub dofs: usize,
    /// Calibration of the stiffness, such as `impact`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<String>,
    /// Id of the reference to whose history its constants were fitted, where that is one of this record: its error
    /// there is the rest of a fit, not a prediction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fitted_to: Option<String>,
    /// Parameters by gear (`contact A - B` for a mesh) and key, in SI units: numbers as numbers.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, BTreeMap<String, serde_json::Value>>,
    /// Dynamic modes of the gear that has most of them (elastic model).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<usize>,
    /// Whether the cut modes are kept as residual compliance (elastic model).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual: Option<bool>,
    /// How its modes were chosen, `flank-compliance` or `frequency` (elastic model).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choose: Option<String>,
    /// Highest frequency among its modes \[Hz\] (elastic model).
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub highest_hz: Option<f64>,
    /// Penalty of its contact \[Pa/m\] (study of penalties).
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub penalty_pa_per_m: Option<f64>,
    /// Its contact is hard, without a penalty (study of penalties).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hard: Option<bool>,
    /// Mean static transmission error over one base pitch under the load of the study \[m\].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub static_error_m: Option<f64>,
    /// What it settles to (loaded running).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steady: Option<Steady>,
    /// Time that others publish for such a model \[s\]; see [`crate::studies::compare::CompareRecord`].
    #[serde(default, skip_serializing_if = "not_a_number")]
    pub published_s: Option<f64>,
    /// What charts call this run where it stands out among others of its variant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mark: Option<String>,
    /// One entry per reference the run is compared with.
    pub metrics: Vec<Metrics>,
    /// Energy and impulse ledger.
    #[serde(default)]
    pub ledger: Ledger,
    /// Recorded histories.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<TimeSeries>,
    /// The mesh at peak force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contacts: Option<ContactSnapshot>,
}

impl Run {
    /// The model with its variant: runs that share it differ by integrator only.
    pub fn model_label(&self) -> String {
        match &self.variant {
            Some(variant) => format!("{}, {variant}", self.model),
            None => self.model.clone(),
        }
    }

    /// What metrics can be told of.
    ///
    /// # Errors
    /// [`Unfinished`] when it has no history, or one that ends before the run was to end.
    pub fn finished(&self) -> Result<Finished<'_>, Unfinished> {
        let end_s = self.end_s.unwrap_or(self.simulated_s);
        match &self.series {
            Some(series) => Finished::new(series, &self.ledger, end_s),
            None => Err(Unfinished {
                reached_s: f64::NEG_INFINITY,
                end_s,
            }),
        }
    }

    /// The metrics against one reference.
    pub fn against(&self, reference: &str) -> Option<&Metrics> {
        self.metrics.iter().find(|m| m.against == reference)
    }

    /// File name without ending, unique through `index`, the run's place in the record.
    pub fn file_stem(&self, index: usize) -> String {
        let mut stem = format!("run{:02}", index + 1);
        for part in [
            self.model.as_str(),
            self.variant.as_deref().unwrap_or(""),
            self.integrator.as_str(),
        ] {
            let slug = slug(part);
            if !slug.is_empty() {
                stem.push('-');
                stem.push_str(&slug);
            }
        }
        stem
    }
}

/// Lower-case letters, digits, single hyphens.
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

/// Engineering outputs of one run against one reference; see [`crate::metrics`] for definitions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Metrics {
    /// Relative L2 error of the force history [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub force_l2: Option<f64>,
    /// The same after the best shift in time [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub force_l2_aligned: Option<f64>,
    /// That shift: add it to the run's time to meet the reference \[s\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub time_shift_s: Option<f64>,
    /// Peak force of the run \[N\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub peak_force_n: Option<f64>,
    /// Deviation of the peak from the reference, over the reference [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub peak_force_rel: Option<f64>,
    /// Impulse of the contact force [N s].
    #[serde(skip_serializing_if = "not_a_number")]
    pub impulse_ns: Option<f64>,
    /// Deviation of the impulse from the reference, over the reference [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub impulse_rel: Option<f64>,
    /// Time in contact \[s\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub duration_s: Option<f64>,
    /// Last angular velocity of gear 1 [rad/s].
    #[serde(skip_serializing_if = "not_a_number")]
    pub omega1_end: Option<f64>,
    /// Last angular velocity of gear 2 [rad/s].
    #[serde(skip_serializing_if = "not_a_number")]
    pub omega2_end: Option<f64>,
    /// Largest deviation of a gear's last speed from the reference, over the span of that speed [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub rebound_rel: Option<f64>,
    /// Relative L2 error of the transmission error while the reference is in contact [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub transmission_error_l2: Option<f64>,
    /// Residual of the run's energy ledger over its largest entry [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub energy_drift_rel: Option<f64>,
    /// Id of the reference: `fe`, `calculix`, or `self` for the model's own converged solution.
    pub against: String,
}

impl Metrics {
    /// The value of a metric.
    pub fn get(&self, metric: Metric) -> Option<f64> {
        match metric {
            Metric::ForceL2 => self.force_l2,
            Metric::ForceL2Aligned => self.force_l2_aligned,
            Metric::TimeShift => self.time_shift_s,
            Metric::PeakForce => self.peak_force_n,
            Metric::PeakForceRel => self.peak_force_rel,
            Metric::Impulse => self.impulse_ns,
            Metric::ImpulseRel => self.impulse_rel,
            Metric::Duration => self.duration_s,
            Metric::Omega1End => self.omega1_end,
            Metric::Omega2End => self.omega2_end,
            Metric::Rebound => self.rebound_rel,
            Metric::TransmissionError => self.transmission_error_l2,
            Metric::EnergyDrift => self.energy_drift_rel,
        }
    }
}

/// Where energy and impulse went. Balance: `energy_end = energy_start + external_work
/// + parametric_work - dissipated + residual`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    /// Energy taken out by damping and friction \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub dissipated_j: Option<f64>,
    /// Work of stiffness that varies along the path of contact \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub parametric_work_j: Option<f64>,
    /// What the balance leaves over: the integrator's doing \[J\].
    #[serde(skip_serializing_if = "not_a_number")]
    pub residual_j: Option<f64>,
    /// The residual over the largest energy in the ledger [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub residual_rel: Option<f64>,
    /// Impulse of the contact force along the line of action [N s].
    #[serde(skip_serializing_if = "not_a_number")]
    pub impulse_ns: Option<f64>,
    /// Drift of the momentum invariant L1/r_b1 - L2/r_b2 over the impulse [-].
    #[serde(skip_serializing_if = "not_a_number")]
    pub invariant_drift_rel: Option<f64>,
}

/// A list of pairs as a JSON object that keeps its order.
mod ordered_map {
    use serde::de::{MapAccess, Visitor};
    use serde::{Deserializer, Serializer};

    type Pairs = Vec<(String, String)>;

    pub fn serialize<S: Serializer>(pairs: &Pairs, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(pairs.iter().map(|(k, v)| (k, v)))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Pairs, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Pairs;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object of strings")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Pairs, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(pairs)
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}
