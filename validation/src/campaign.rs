//! A set of scenes, gone through by several threads, with a journal: one line per scene as soon as it is validated, so that
//! a check that was stopped goes on where it ended.

use crate::sampling::{Set, full_order, sample};
use crate::validate::{ValidationError, validate};
use gearbench::experiment::journal::{Finished, JOURNAL, Journal};
use gearbench::experiment::machine::COMMIT;
use gearbench::experiment::parallel::{in_parallel, lock};
use gearbench_reports::choice_check::ValidatedChoice;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Mutex;

/// What to check.
#[derive(Clone, Debug)]
pub struct Plan {
    pub set: Set,
    pub scenes: [usize; 2],
    /// Scenes that are validated at the same time.
    pub threads: usize,
    pub folder: PathBuf,
    pub fresh: bool,
}

/// A validated scene in the journal.
#[derive(Debug, Serialize, Deserialize)]
#[serde(transparent)]
struct Validated(ValidatedChoice);

impl Finished for Validated {
    fn key(&self) -> String {
        self.0.number.to_string()
    }
}

impl Plan {
    /// What scenes of a journal belong to: those of another set or of another version are not taken over.
    fn echo(&self) -> Vec<(String, String)> {
        [
            ("set", self.set.name.clone()),
            ("seed", self.set.seed.to_string()),
            ("full order", self.set.full_order.to_string()),
            ("commit", COMMIT.to_owned()),
        ]
        .map(|(what, value)| (what.to_owned(), value))
        .into()
    }
}

/// Validates the scenes of a plan; `progress` is told each as it is done, and how many are.
///
/// # Errors
/// [`ValidationError`]: a sampling that fails, a journal that cannot be written, an interruption. Scenes that cannot be validated
/// are rows.
pub fn check(
    plan: &Plan,
    progress: impl Fn(&ValidatedChoice, usize) + Sync,
) -> Result<Vec<ValidatedChoice>, ValidationError> {
    let [first, last] = plan.scenes;
    let full = full_order(&plan.set)?;
    // A version with changes is not told by its commit.
    let fresh = plan.fresh || COMMIT.ends_with('+');
    let journal = Journal::<Validated>::open(&plan.folder.join(JOURNAL), &plan.echo(), fresh)?;
    let all: Vec<usize> = (first..=last).collect();
    let left: Vec<usize> = (all.iter().copied())
        .filter(|n| journal.get(&n.to_string()).is_none())
        .collect();
    let journal = Mutex::new((journal, all.len() - left.len()));
    in_parallel(plan.threads, &left, |number| {
        let row = validate(&sample(&plan.set, *number)?, full.contains(number));
        let (journal, done) = &mut *lock(&journal);
        *done += 1;
        progress(&row, *done);
        journal.store(&Validated(row))?;
        Ok::<(), ValidationError>(())
    })?;
    let (journal, _) = &*lock(&journal);
    Ok(all
        .iter()
        .filter_map(|n| journal.get(&n.to_string()))
        .map(|validated| validated.0.clone())
        .collect())
}
