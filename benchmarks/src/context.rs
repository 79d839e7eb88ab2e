//! Models, contact laws, messages, memory and interruption of a command or a study, and the use of its record.
//!
//! A program makes a context and hands it on, to the loading of scenes first: a scene keeps its context, and the
//! conditions of its studies have it from there. The thread that loads the scenes and runs the studies works
//! [within](Resources::within) the resources of the context. Two studies with contexts of their own do not know of each
//! other.

use crate::experiment::interruption::Interruption;
use crate::messages::Messages;
use gearbench_models::gear::table::Model;
use gearbench_models::law::ForceLaw;
use gearbench_reference::resources::Resources;
use gearbench_reports::record::Source;
use std::fmt;
use std::sync::Arc;

/// Use of the record of a study.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RecordUse {
    /// The record is written to a folder, as a command does; the result of the command has no histories.
    #[default]
    Written,
    /// The record is returned with its histories. It is also written if the study names a folder; otherwise the study
    /// has a folder of its own for the time that it runs.
    Returned,
}

/// A function of the pieces done, their total number or 0, and the present piece.
pub type ProgressFunction = dyn Fn(usize, usize, &str) + Send + Sync;

/// The receiver of the progress of a study.
#[derive(Clone)]
pub struct ProgressObserver(pub Arc<ProgressFunction>);

impl fmt::Debug for ProgressObserver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ProgressObserver")
    }
}

/// Models, contact laws, messages, memory and interruption of a command or a study; a clone is the same context.
#[derive(Clone, Debug)]
pub struct Context {
    /// The gear models that scenes can name.
    pub models: Arc<[Model]>,
    /// The contact laws of the program, which scenes name by `normal_force`.
    pub laws: Arc<[Arc<dyn ForceLaw>]>,
    /// The request that its studies end.
    pub interruption: Interruption,
    /// The sources of the record that is rerun, one a scene, or the text of a scene that a program made: each replaces the
    /// file of its name and its calibrations.
    pub rerun: Arc<[Source]>,
    /// Output and warnings.
    pub messages: Messages,
    /// Memory and cache.
    pub resources: Resources,
    /// Use of the record of a study.
    pub record: RecordUse,
    /// Receives the progress of a study in place of the terminal.
    pub progress: Option<ProgressObserver>,
}

impl Default for Context {
    /// The context of a program that adds nothing.
    fn default() -> Self {
        Context {
            models: crate::models::models().into(),
            laws: Arc::new([]),
            interruption: Interruption::default(),
            rerun: Arc::new([]),
            messages: Messages::default(),
            resources: Resources::default(),
            record: RecordUse::default(),
            progress: None,
        }
    }
}

impl Context {
    /// Adds the text of a scene of this name, in place of its file. Paths in it count from the folder of the name.
    #[must_use]
    pub fn with_scene(mut self, name: &str, text: &str) -> Self {
        let others = self.rerun.iter().filter(|source| source.name != name);
        let source = Source {
            name: name.to_owned(),
            scene: text.to_owned(),
            ..Source::default()
        };
        self.rerun = others.cloned().chain([source]).collect();
        self
    }

    /// Adds a contact law, which scenes select by its name. An existing law with the same name is kept.
    #[must_use]
    pub fn with_law(mut self, law: Arc<dyn ForceLaw>) -> Self {
        if self.laws.iter().all(|l| l.name() != law.name()) {
            self.laws = [&*self.laws, &[law]].concat().into();
        }
        self
    }

    /// Adds a model to the table. An existing model with the same id is kept.
    #[must_use]
    pub fn with_model(mut self, model: Model) -> Self {
        if self.models.iter().all(|m| m.id != model.id) {
            self.models = [&*self.models, &[model]].concat().into();
        }
        self
    }
}

#[cfg(test)]
mod tests;
