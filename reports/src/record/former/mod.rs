//! Records of former versions, read as records of this version.
//!
//! | difference | converted by |
//! |---|---|
//! | schema 1 has the quantities of a study of penalties in its runs, now they are rows of its table | `penalty` |
//! | schema 1, and schema 2 before its release, have columns of the first mesh and of the first two gears without their names | `columns` |

mod columns;
mod penalty;

use super::{Results, ordered_map};
use serde::Deserialize;
use serde_json::Value;

/// The number of the oldest schema that is read.
pub const SCHEMA: u32 = 1;

/// Name of the study of penalties in schema 1.
pub const PENALTY: &str = "penalty";

/// Returns the record of a former version as this version has it; `None` if the text is a record of this version.
///
/// # Errors
/// When the text is no record.
pub fn upgrade(text: &str) -> serde_json::Result<Option<Results>> {
    // Records of this version are not parsed a second time.
    let may_be = |study: &str| text.contains(&format!("\"{study}\""));
    if !may_be(PENALTY) && !columns::may_be_former(text) {
        return Ok(None);
    }
    let mut record: Value = serde_json::from_str(text)?;
    let gears = columns::upgrade(&mut record);
    let penalty = penalty::upgrade(&mut record)?;
    if gears.is_none() && !penalty {
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
