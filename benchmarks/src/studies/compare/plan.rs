//! What the comparison runs.

use crate::experiment::configuration::Configuration;
use crate::experiment::external::external;
use crate::models::models;
use crate::scene_file::{ModelChoice, SceneFile};
use gearbench_integrators::Scheme;
use gearbench_models::gear::table::Model;
use gearbench_reference::ExternalReference;
use gearbench_reports::record::{ReferenceSeries, Tolerance};
use std::time::Duration;

/// What to compare.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// Name of the scene.
    pub name: String,
    /// One line for the reader.
    pub title: String,
    /// Command that makes the record again.
    pub command: String,
    /// Models.
    pub entries: Vec<Configuration>,
    /// Integrators.
    pub methods: Vec<Scheme>,
    /// Table of models.
    pub models: &'a [Model],
    /// End [s].
    pub duration: f64,
    /// Samples of the histories over the duration.
    pub samples: usize,
    /// External reference.
    pub reference: Option<ReferenceSeries>,
    /// Label of an entry whose first run is a further reference.
    pub reference_model: Option<String>,
    /// Source of published times.
    pub published: Option<String>,
    /// What the scene calls accurate enough.
    pub tolerance: Option<Tolerance>,
    /// Settings to show.
    pub settings: Vec<(String, String)>,
    /// Timed repeats.
    pub repeats: u32,
    /// Locate events.
    pub events: bool,
    /// Wall-clock bound of one integration.
    pub timeout: Duration,
}

impl Plan<'_> {
    /// The comparison of some models of a scene as the scene describes it: one timed repeat, a minute per run.
    pub fn of(
        scene: &SceneFile,
        choices: &[&ModelChoice],
        reference: Option<&ExternalReference>,
    ) -> Plan<'static> {
        Plan {
            name: scene.name.clone(),
            title: scene.title.clone(),
            command: String::new(),
            entries: choices
                .iter()
                .map(|c| Configuration::of(scene, c))
                .collect(),
            methods: scene.study.integrators.clone(),
            models: models(),
            duration: scene.duration,
            samples: scene.study.samples,
            reference: reference.map(external),
            reference_model: scene.study.reference_model.clone(),
            published: scene.study.published.clone(),
            tolerance: scene.tolerance.clone(),
            settings: Vec::new(),
            repeats: 1,
            events: scene.study.events,
            timeout: Duration::from_secs(60),
        }
    }

    /// The same under other integrators, for all models.
    #[must_use]
    pub fn with_methods(mut self, methods: Vec<Scheme>) -> Self {
        for entry in &mut self.entries {
            entry.methods = None;
        }
        self.methods = methods;
        self
    }

    /// Number of runs.
    pub fn len(&self) -> usize {
        self.entries.iter().map(|e| self.methods_of(e).len()).sum()
    }

    /// Its own integrators of a configuration, else those of all.
    pub(super) fn methods_of<'p>(&'p self, entry: &'p Configuration) -> &'p [Scheme] {
        entry.methods.as_deref().unwrap_or(&self.methods)
    }

    /// True when there is nothing to run.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Times to record at: those of the reference, and an even grid.
    pub(super) fn grid(&self) -> Vec<f64> {
        let n = self.samples.max(2) - 1;
        let mut grid: Vec<f64> = (0..=n)
            .map(|i| self.duration * i as f64 / n as f64)
            .collect();
        if let Some(r) = &self.reference {
            let last = r.series.time_s.last().copied().unwrap_or(0.0);
            grid.retain(|&t| t > last);
            let own = r
                .series
                .time_s
                .iter()
                .copied()
                .filter(|&t| t <= self.duration);
            let mut all: Vec<f64> = own.collect();
            all.append(&mut grid);
            grid = all;
        }
        grid
    }
}
