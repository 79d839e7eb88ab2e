//! Conditions that all runs of a study share, and the header of its record.

use super::machine;
use super::run::{Job, NO_BOUND};
use crate::context::Context;
use crate::scene_file::SceneFile;
use gearbench_integrators::Scheme;
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reference::data::{Channel, Quantity, Reference};
use gearbench_reports::record::{Part, Results};
use std::time::Duration;

/// Conditions that all runs of a study share: duration, sampling, event location, bounds of time and steps.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// The context of the scene.
    pub context: Context,
    /// Name of the scene.
    pub name: String,
    /// Title of the study in one line.
    pub title: String,
    /// Command line that reproduces the record.
    pub command: String,
    /// Name and value of each setting that the report lists.
    pub settings: Vec<(String, String)>,
    /// End of the simulated time [s].
    pub duration: f64,
    /// Number of samples of the histories over the duration.
    pub samples: usize,
    /// True if all quantities that references may have are recorded ([`Conditions::compared_with`]).
    pub measurable: bool,
    /// True if contact events are located.
    pub events: bool,
    /// Number of timed repeats of each run.
    pub repeats: u32,
    /// Bound on the processor time of one integration, without recording.
    pub timeout: Duration,
    /// Bound on the number of steps of one integration.
    pub max_steps: u64,
}

/// Progress callback: number of runs done, their total number so far, and the name of the next run.
pub type Progress<'a> = &'a (dyn Fn(usize, usize, &str) + Sync);

/// Progress callback without output.
pub fn silent(_: usize, _: usize, _: &str) {}

/// Equidistant times from zero to an end [s].
pub fn even(samples: usize, end: f64) -> Vec<f64> {
    let n = samples.max(2) - 1;
    (0..=n).map(|i| end * i as f64 / n as f64).collect()
}

/// Returns values from one end to the other, evenly spaced on a logarithmic scale, with exact ends.
pub fn logarithmic(from: f64, to: f64, points: usize) -> Vec<f64> {
    let last = points.max(2) - 1;
    let at = |i: usize| match i {
        0 => from,
        i if i == last => to,
        i => from * ((to / from).ln() * i as f64 / last as f64).exp(),
    };
    (0..=last).map(at).collect()
}

impl Conditions {
    /// The conditions of a scene: one timed repeat, no bound on processor time or steps.
    pub fn of(scene: &SceneFile) -> Self {
        Conditions {
            context: scene.context.clone(),
            name: scene.name.clone(),
            title: scene.title.clone(),
            command: String::new(),
            settings: Vec::new(),
            duration: scene.duration,
            samples: scene.study.samples,
            measurable: false,
            events: scene.study.events,
            repeats: 1,
            timeout: NO_BOUND,
            max_steps: u64::MAX,
        }
    }
    /// Also records what some reference may contain besides forces and the motion of gears, for comparison with it.
    #[must_use]
    pub fn compared_with<'r>(
        mut self,
        scene: &SceneSpec,
        references: impl IntoIterator<Item = &'r Reference>,
    ) -> Self {
        let gears = scene.gears.len();
        let is_further = |c: &Channel| match c.quantity {
            Quantity::Torque(_) | Quantity::MountTorque(_) => true,
            Quantity::Speed(g) | Quantity::Angle(g) => g >= gears,
            Quantity::Force(_) | Quantity::TransmissionError(_) | Quantity::ShaftTorque(_) => false,
        };
        let mut references = references.into_iter();
        self.measurable |= references.any(|r| r.channels.iter().any(is_further));
        self
    }

    /// Equidistant sampling times of the histories [s].
    pub fn grid(&self) -> Vec<f64> {
        even(self.samples, self.duration)
    }

    /// The job of one run under these conditions.
    pub fn job<'j>(
        &'j self,
        (scene, modelling): (&'j SceneSpec, &'j Modelling),
        method: &'j Scheme,
        grid: &'j [f64],
    ) -> Job<'j> {
        Job {
            scene,
            modelling,
            context: &self.context,
            method,
            t_end: self.duration,
            grid,
            also_steps: true,
            forces: false,
            measurable: self.measurable,
            paths: false,
            histories: false,
            motion: false,
            pictures: None,
            events: self.events,
            repeats: self.repeats,
            timeout: self.timeout,
            max_steps: self.max_steps,
        }
    }

    /// The record of a study with its own part, without results yet.
    pub fn record(&self, part: Part) -> Results {
        Results {
            header: machine::header(&self.name, &self.title, &self.command),
            part,
            settings: self.settings.clone(),
            ..Results::default()
        }
    }
}
