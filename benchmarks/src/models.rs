//! The table of gear models that scenes can name: those of the crates `models` and `reference`, and those that a
//! program adds.

use gearbench_models::gear::table::{MODELS, Model};
use std::sync::{LazyLock, PoisonError, RwLock};

/// The present table. An extended table replaces it; every table lives as long as the program.
static TABLE: LazyLock<RwLock<&'static [Model]>> =
    LazyLock::new(|| RwLock::new([MODELS, gearbench_reference::MODELS].concat().leak()));

/// Returns the table of all gear models.
#[must_use]
pub fn models() -> &'static [Model] {
    &TABLE.read().unwrap_or_else(PoisonError::into_inner)
}

/// Adds a model to the table, for all later scenes and studies. An existing model with the same id is kept.
pub fn join(model: Model) {
    let mut table = TABLE.write().unwrap_or_else(PoisonError::into_inner);
    if table.iter().all(|m| m.id != model.id) {
        *table = [*table, &[model]].concat().leak();
    }
}
