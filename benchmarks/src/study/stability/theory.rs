//! Lines of theory over the rows of a map.

use super::plan::{MapPlan, Plan};
use gearbench_reports::stability::{Columns, MapLine};

/// The lines of a map: one per statement of the theory, with its step in every row.
#[must_use]
pub fn lines(_plan: &Plan<'_>, map: &MapPlan) -> Vec<MapLine> {
    if map.columns != Columns::Step {
        return Vec::new();
    }
    Vec::new()
}
