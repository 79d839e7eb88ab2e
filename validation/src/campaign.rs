//! Validation of a set of scenes on several threads. Each validated scene is stored at once, so that an interrupted
//! check continues where it ended.

use crate::choices::ValidatedChoice;
use crate::sampling::{Set, full_order, sample};
use crate::validate::{ValidationError, against_full, validate};
use gearbench::experiment::key::Key;
use gearbench::experiment::parallel::{in_parallel, lock};
use gearbench::experiment::runner::Runner;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// The scenes of a set to validate, and the number of threads.
#[derive(Clone, Debug)]
pub struct Plan {
    pub set: Set,
    pub scenes: Vec<usize>,
    /// Number of scenes that are validated at the same time.
    pub threads: usize,
}

impl Plan {
    /// Key of a scene in the journal, which distinguishes sets.
    fn key(&self, number: usize) -> Key {
        let set = &self.set;
        Key::new("validated")
            .and(&(&set.name, set.seed, &set.own))
            .and(&number)
    }
}

/// Validates the scenes of a plan; `progress` receives each finished scene and the number of finished ones.
///
/// # Errors
/// [`ValidationError`]: a sampling that fails, a journal that cannot be written, an interruption. Scenes that cannot be validated
/// are rows.
pub fn check(
    plan: &Plan,
    runner: &Runner<'_>,
    progress: impl Fn(&ValidatedChoice, usize) + Sync,
) -> Result<Vec<ValidatedChoice>, ValidationError> {
    let full = full_order(&plan.set)?;
    let rows = Mutex::new(BTreeMap::new());
    in_parallel(plan.threads, &plan.scenes, |number| {
        let row: ValidatedChoice =
            runner.piece(plan.key(*number), || validate(&sample(&plan.set, *number)?))?;
        let mut rows = lock(&rows);
        progress(&row, rows.len() + 1);
        rows.insert(*number, row);
        Ok::<(), ValidationError>(())
    })?;
    let mut rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    // Full finite elements take minutes a scene: they come when all else is there.
    let full: Vec<usize> = full.into_iter().filter(|n| rows.contains_key(n)).collect();
    let held = Mutex::new(BTreeMap::new());
    in_parallel(plan.threads, &full, |number| {
        let chosen = rows.get(number).and_then(|row| row.chosen.as_deref());
        let found = runner.piece(plan.key(*number).and(&("full order", chosen)), || {
            against_full(&sample(&plan.set, *number)?, chosen)
        });
        let found = match found {
            Err(e @ ValidationError::Reference { .. }) => Err(e.to_string()),
            other => Ok(other?),
        };
        lock(&held).insert(*number, found);
        Ok::<(), ValidationError>(())
    })?;
    for (number, found) in held.into_inner().unwrap_or_else(PoisonError::into_inner) {
        if let Some(row) = rows.get_mut(&number) {
            match found {
                Ok(found) => {
                    row.full_error = found.chosen;
                    row.densest_error = found.refined;
                }
                Err(why) => row.note = Some(why),
            }
        }
    }
    Ok(rows.into_values().collect())
}
