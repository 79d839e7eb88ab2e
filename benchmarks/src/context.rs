//! Models, messages, memory and interruption of a command or a study.
//!
//! A program makes a context and hands it on, to the loading of scenes first: a scene keeps its context, and the
//! conditions of its studies have it from there. The thread that loads the scenes and runs the studies works
//! [within](Resources::within) the resources of the context. Two studies with contexts of their own do not know of each
//! other.

use crate::experiment::interruption::Interruption;
use crate::messages::Messages;
use gearbench_models::gear::table::Model;
use gearbench_reference::resources::Resources;
use gearbench_reports::record::Source;
use std::sync::Arc;

/// Models, messages, memory and interruption of a command or a study; a clone is the same context.
#[derive(Clone, Debug)]
pub struct Context {
    /// The gear models that scenes can name.
    pub models: Arc<[Model]>,
    /// The request that its studies end.
    pub interruption: Interruption,
    /// The source of the record that is rerun, which replaces its scene file and calibrations.
    pub rerun: Option<Arc<Source>>,
    /// Output and warnings.
    pub messages: Messages,
    /// Memory and cache.
    pub resources: Resources,
}

impl Default for Context {
    /// The context of a program that adds nothing.
    fn default() -> Self {
        Context {
            models: crate::models::models().into(),
            interruption: Interruption::default(),
            rerun: None,
            messages: Messages::default(),
            resources: Resources::default(),
        }
    }
}

impl Context {
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
