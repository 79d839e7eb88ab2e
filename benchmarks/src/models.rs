//! The table of gear models that scenes may name: those of `models` and those of `reference`.

use gearbench_models::gear::table::{MODELS, Model};
use std::sync::LazyLock;

static ALL: LazyLock<Vec<Model>> = LazyLock::new(|| {
    let mut all = MODELS.to_vec();
    all.extend_from_slice(gearbench_reference::MODELS);
    all
});

/// All gear models.
#[must_use]
pub fn models() -> &'static [Model] {
    &ALL
}
