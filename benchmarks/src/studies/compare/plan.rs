//! Plan of a comparison: models, integrators, references and yardstick.

use super::yardstick::{REFINED, YardstickChoice};
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::pictures::{Pictures, file_name};
use crate::experiment::reference_series::recorded;
use crate::scene_file::{ModelChoice, SceneError, SceneFile};
use gearbench_integrators::Scheme;
use gearbench_reference::data::Reference;
use gearbench_reports::record::{ReferenceSeries, SELF, Tolerance};
use std::path::PathBuf;

/// Plan of the frames of every run for ParaView.
#[derive(Clone, Debug)]
pub struct FramePlan {
    /// Folder to which the frames are written.
    pub folder: PathBuf,
    /// Number of frames of each run.
    pub frames: usize,
    /// First and last time of the frames [s].
    pub window: [f64; 2],
}

/// Plan of a comparison of models and integrators.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Conditions that all runs share.
    pub conditions: Conditions,
    /// Models that are compared.
    pub entries: Vec<Configuration>,
    /// Integrators of models without their own.
    pub methods: Vec<Scheme>,
    /// References that all models are compared with, measured or computed by other programs.
    pub references: Vec<ReferenceSeries>,
    /// Kind of yardstick that models are compared with.
    pub wanted: YardstickChoice,
    /// Frequency above which the force of a mesh counts as ripple [Hz].
    pub ripple_above: Option<f64>,
    /// Source of the published computing times.
    pub published: Option<String>,
    /// Tolerance that the scene specifies for an adequate model.
    pub tolerance: Option<Tolerance>,
    /// Plan of the frames for ParaView; `None` without frames.
    pub pictures: Option<FramePlan>,
}

impl Plan {
    /// Plans the comparison of some models with the settings of the scene: one timed repeat, a minute per run.
    pub fn of(scene: &SceneFile, choices: &[&ModelChoice], references: &[Reference]) -> Plan {
        Plan {
            conditions: Conditions::of(scene).compared_with(&scene.spec, references),
            entries: choices
                .iter()
                .map(|c| Configuration::of(scene, c))
                .collect(),
            methods: scene.study.integrators.clone(),
            references: (references.iter())
                .map(|r| recorded(r, &scene.spec))
                .collect(),
            wanted: match &scene.study.reference_model {
                Some(label) => YardstickChoice::Named(label.clone()),
                None => YardstickChoice::Stored,
            },
            ripple_above: scene.study.ripple_above,
            published: scene.study.published.clone(),
            tolerance: scene.tolerance.clone(),
            pictures: None,
        }
    }

    /// Returns the plan with the yardstick of the option `--yardstick`, else of the scene. A tolerance of models
    /// follows the option.
    ///
    /// # Errors
    /// [`SceneError`] when the option is no label of a model that is compared.
    pub fn compared_with(
        mut self,
        scene: &SceneFile,
        option: Option<&str>,
    ) -> Result<Self, SceneError> {
        if let Some(name) = option.filter(|name| *name != REFINED) {
            let choices = scene.select(Some(name))?;
            let is_compared = |c: &&ModelChoice| self.entries.iter().any(|e| e.label == c.label);
            let more = choices.into_iter().filter(|c| !is_compared(c));
            let more: Vec<Configuration> = more.map(|c| Configuration::of(scene, c)).collect();
            self.entries.extend(more);
        }
        self.wanted = YardstickChoice::of(scene, &self.entries, option);
        let of_models = self.tolerance.as_mut().filter(|t| t.against != SELF);
        if let (Some(tolerance), Some(name)) = (of_models, option) {
            tolerance.against = name.to_owned();
        }
        Ok(self)
    }

    /// Returns the plan with these integrators for all models.
    pub fn with_methods(mut self, methods: Vec<Scheme>) -> Self {
        for entry in &mut self.entries {
            entry.methods = None;
        }
        self.methods = methods;
        self
    }

    /// Returns the number of runs, one for each model and integrator.
    pub fn len(&self) -> usize {
        self.entries.iter().map(|e| self.methods_of(e).len()).sum()
    }

    /// The frames of a run: its name is that of its model and its method, with the resolution where the method comes twice.
    pub(super) fn pictures_of(&self, entry: &Configuration, method: &Scheme) -> Option<Pictures> {
        let FramePlan {
            folder,
            frames,
            window,
        } = self.pictures.clone()?;
        let same = |m: &&Scheme| m.method.to_string() == method.method.to_string();
        let mut name = format!("{} {}", entry.label, method.method);
        if self.methods_of(entry).iter().filter(same).count() > 1 {
            let resolution = method.resolution;
            let at = resolution.step().or(resolution.tolerance());
            name += &at.map_or_else(String::new, |at| format!(" {at:e}"));
        }
        Some(Pictures {
            folder,
            name: file_name(&name),
            frames,
            window,
        })
    }

    /// Returns the integrators of a model: its own, else those of the plan.
    pub(super) fn methods_of<'p>(&'p self, entry: &'p Configuration) -> &'p [Scheme] {
        entry.methods.as_deref().unwrap_or(&self.methods)
    }

    /// True if the plan contains no runs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
