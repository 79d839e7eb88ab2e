//! The gear models of gearbench: those of the crates `models` and `reference`. A program adds its own to a
//! [context](crate::context::Context).

use gearbench_models::gear::table::{MODELS, Model};
use std::sync::LazyLock;

/// Returns the table of all gear models of gearbench.
#[must_use]
pub fn models() -> &'static [Model] {
    static TABLE: LazyLock<Vec<Model>> =
        LazyLock::new(|| [MODELS, gearbench_reference::MODELS].concat());
    &TABLE
}
