//! The table of gear models that scenes may name: those of `models`, those of `reference`, and those that a program
//! joins to them.

use gearbench_models::gear::table::{MODELS, Model};
use std::sync::{LazyLock, PoisonError, RwLock};

/// A joined table takes the place of the one before; each lives as long as the program.
static TABLE: LazyLock<RwLock<&'static [Model]>> =
    LazyLock::new(|| RwLock::new([MODELS, gearbench_reference::MODELS].concat().leak()));

/// Returns the table of all gear models.
#[must_use]
pub fn models() -> &'static [Model] {
    &TABLE.read().unwrap_or_else(PoisonError::into_inner)
}

/// Joins a model to the table, for all scenes and studies from here on. An id that is taken keeps its model.
pub fn join(model: Model) {
    let mut table = TABLE.write().unwrap_or_else(PoisonError::into_inner);
    if table.iter().all(|m| m.id != model.id) {
        *table = [*table, &[model]].concat().leak();
    }
}
