//! What was chosen against the references of the scene: the estimate of a choice is an error against finer models, what was
//! measured may be further away.

use super::plan::Candidate;
use super::reason::per_cent;
use crate::experiment::conditions::Conditions;
use crate::experiment::referenced::recorded;
use crate::experiment::run::{Job, RunError, run};
use crate::scene_file::SceneFile;
use gearbench_reference::data::Reference;
use gearbench_reports::Metric;
use gearbench_reports::metrics::compare_all;

/// What such settings begin with.
pub(super) const AGAINST: &str = "the choice against";

/// Runs the choice over the whole scene and says how far it is from each reference, a setting of the record for each.
///
/// # Errors
/// [`RunError`] when it cannot run.
pub(super) fn against(
    scene: &SceneFile,
    candidate: &Candidate,
    references: &[Reference],
) -> Result<Vec<(String, String)>, RunError> {
    let conditions = Conditions {
        repeats: 0,
        ..Conditions::of(scene)
    };
    let grid = conditions.grid();
    let row = run(&Job {
        ..conditions.job(
            (&candidate.scene, &candidate.modelling),
            &candidate.method,
            &grid,
        )
    })?;
    let told = |r: &Reference| {
        let found = match row.finished() {
            Err(_) => format!(
                "the run did not reach the end: {}",
                row.message.as_deref().unwrap_or("no reason given")
            ),
            Ok(run) => {
                let recorded = recorded(r, &candidate.scene);
                let metrics = compare_all(run, &recorded.all_series(), &r.id);
                let errors = Metric::ALL
                    .into_iter()
                    .filter(|m| m.is_error() && *m != Metric::EnergyDrift);
                let errors = errors.filter_map(|m| {
                    Some(format!("{} {}", m.words(), per_cent(metrics.get(m)?.abs())))
                });
                errors.collect::<Vec<_>>().join(", ")
            }
        };
        (format!("{AGAINST} {}", r.id), found)
    };
    Ok(references.iter().map(told).collect())
}
