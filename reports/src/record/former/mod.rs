//! Records of former versions, read as records of this version.
//!
//! | difference | converted by |
//! |---|---|
//! | former studies of penalties, of numbers of modes and of error over cost have their quantities in their runs, now they are rows of their table | `tables` |
//! | schema 1, and schema 2 before its release, have columns of the first mesh and of the first two gears without their names | `columns` |

mod columns;
mod tables;

use super::{Results, ordered_map};
use serde::Deserialize;
use serde_json::Value;
pub use tables::STUDIES;

/// The number of the oldest schema that is read.
pub const SCHEMA: u32 = 1;

/// Returns the record of a former version as this version has it; `None` if the text is a record of this version.
///
/// # Errors
/// When the text is no record.
pub fn upgrade(text: &str) -> serde_json::Result<Option<Results>> {
    // Records of this version are not parsed a second time.
    let may_be = |study: &str| text.contains(&format!("\"{study}\""));
    if !STUDIES.into_iter().any(may_be) && !columns::may_be_former(text) {
        return Ok(None);
    }
    let mut record: Value = serde_json::from_str(text)?;
    let gears = columns::upgrade(&mut record);
    let is_table = tables::upgrade(&mut record)?;
    if gears.is_none() && !is_table {
        return Ok(None);
    }
    let mut results: Results = serde_json::from_value(record)?;
    // Objects of a `Value` are sorted by name.
    #[derive(Deserialize)]
    struct Ordered {
        #[serde(default, with = "ordered_map")]
        settings: Vec<(String, String)>,
    }
    results.settings = serde_json::from_str::<Ordered>(text)?.settings;
    let place = |gear: &str| gears.iter().flatten().position(|g| g == gear);
    for metrics in results.runs.iter_mut().flat_map(|r| &mut r.metrics) {
        metrics.speeds_end.sort_by_key(|(gear, _)| place(gear));
    }
    Ok(Some(results))
}
