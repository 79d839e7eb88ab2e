//! Plan of a study of coupling: models, hubs of the host, extrapolations and communication steps.

use super::frames::Frame;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use gearbench_integrators::{Resolution, Scheme};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::coupling::{Extrapolation, Motion};

/// Energy error of a coupling over the vibration energy above which it counts as unstable [-].
pub const ALLOWED: f64 = 0.5;
/// Energy error of a coupling over the vibration energy at which a run is given up [-].
pub const HOPELESS: f64 = 1e3;
/// Largest default communication step over the time `1/omega` of the hubs on their teeth.
const LARGEST: f64 = 4.0;
/// Communication steps over a run at least.
const FEWEST: f64 = 2.5;

/// Model that is run in two coupled parts.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Model that is coupled to the host.
    pub configuration: Configuration,
    /// Frames of the hubs in the host.
    pub frames: Vec<Frame>,
    /// Integrator of the gears, and of the whole system.
    pub method: Scheme,
    /// Angular frequency [rad/s] and damping ratio of the hubs on the teeth in contact; `None` without contact.
    pub oscillator: Option<[f64; 2]>,
    /// Communication steps, ascending [s].
    pub steps: Vec<f64>,
}

/// Plan of a study of coupling.
#[derive(Clone, Debug)]
pub struct Plan {
    pub conditions: Conditions,
    pub entries: Vec<Entry>,
    pub extrapolations: Vec<Extrapolation>,
    pub motions: Vec<Motion>,
    /// Relative L2 error of the force within which a run is accurate.
    pub tolerance: f64,
}

impl Plan {
    /// Returns all combinations of models, extrapolations and motions of the study, in order.
    pub fn lines(&self) -> Vec<(usize, Extrapolation, Motion)> {
        let mut all = Vec::new();
        for entry in 0..self.entries.len() {
            for &motion in &self.motions {
                all.extend((self.extrapolations.iter()).map(|x| (entry, *x, motion)));
            }
        }
        all
    }

    /// Returns the number of runs, including those of models as one system.
    pub fn len(&self) -> usize {
        let ways = self.extrapolations.len() * self.motions.len();
        let of = |e: &Entry| 1 + ways * e.steps.len();
        self.entries.iter().map(of).sum()
    }
}

/// Returns the default communication steps [s]: the step of the gears doubled until the motion of hubs on their teeth
/// cannot be resolved.
pub fn default_steps(method: &Scheme, oscillator: Option<[f64; 2]>, duration: f64) -> Vec<f64> {
    let most = duration / FEWEST;
    let last = oscillator.map_or(most, |[omega, _]| (LARGEST / omega).min(most));
    let first = match method.resolution {
        Resolution::Step(h) => h.min(most),
        Resolution::Tolerance(_) => 1e-3 * last,
    };
    let doubled = std::iter::successors(Some(first), |h| Some(2.0 * h));
    doubled
        .take_while(|h| *h < 1.5 * last || *h == first)
        .collect()
}

/// Returns the elastic model with plain truncation: its lowest modes, without the residual compliance of the others.
pub fn truncated(of: &Configuration, method: Scheme, step: f64) -> Configuration {
    let mut entry = of.clone();
    ElasticParameters::change(&mut entry.modelling, |p| {
        p.residual = Some(false);
        p.choose = Some(gearbench_reference::reduction::choose::Criterion::Frequency);
        p.target_error = None;
        p.step_s = Some(step);
    });
    entry.label = format!("{}-truncated", of.label);
    entry.methods = Some(vec![method]);
    entry
}

/// True if the gears keep the compliance of the truncated modes; `None` if no gear is elastic.
pub fn keeps_residual(of: &Configuration) -> Option<bool> {
    let gears = of.modelling.gears.iter().filter_map(ElasticParameters::of);
    gears.map(|p| p.keeps_residual()).reduce(|a, b| a && b)
}
