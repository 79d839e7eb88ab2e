//! The study of mode counts: error of the elastic model over the number of modes, by method of reduction.

mod charts;
pub(super) mod csv;
mod tables;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::metrics::Metric;
use crate::record::{Results, Run};
use crate::studies::StudyReport;
use crate::studies::compare::histories;
use crate::view::View;

/// Limits of the force-history error whose fewest modes a report names.
pub const LIMITS: [f64; 3] = [0.02, 0.01, 0.005];

/// Runs of one method of reduction, over the number of modes.
pub struct TruncationVariant<'a> {
    /// Variant of its runs, such as `by flank compliance`.
    pub label: String,
    /// Criterion by which modes are chosen: `flank-compliance` or `frequency`.
    pub choose: String,
    /// True if the truncated modes are kept as residual compliance.
    pub residual: bool,
    /// Runs of the method with their index in the record, ascending in modes.
    pub runs: Vec<(usize, &'a Run)>,
}

impl<'a> TruncationVariant<'a> {
    /// Returns the runs that ended well and have a finite metric against a reference: modes, magnitude, run.
    pub fn errors(&self, against: &str, metric: Metric) -> Vec<(usize, f64, &'a Run)> {
        (self.runs.iter())
            .filter(|(_, r)| !r.status.is_failure())
            .filter_map(|(_, r)| {
                let e = r.against(against)?.get(metric)?.abs();
                e.is_finite().then_some((r.modes?, e, *r))
            })
            .collect()
    }

    /// Returns the run with the fewest modes from which on every number of modes is within the limit of the
    /// force-history error; a failed run is beyond every limit.
    pub fn fewest(&self, against: &str, limit: f64) -> Option<&'a Run> {
        let mut found = None;
        for (_, run) in self.runs.iter().rev() {
            let error = run.against(against).and_then(|m| m.force_l2);
            if run.status.is_failure() || error.is_none_or(|e| e.is_nan() || e > limit) {
                break;
            }
            found = Some(*run);
        }
        found
    }

    /// Returns the run with the given number of modes.
    pub fn with(&self, modes: usize) -> Option<&'a Run> {
        let found = self.runs.iter().find(|(_, r)| r.modes == Some(modes));
        found.map(|(_, r)| *r)
    }
}

/// Returns the methods of reduction of a record in the order of appearance; runs without modes (references, other
/// models) belong to none.
pub fn variants(results: &Results) -> Vec<TruncationVariant<'_>> {
    let mut ways: Vec<TruncationVariant<'_>> = Vec::new();
    for (index, run) in results.runs.iter().enumerate() {
        let (Some(_), Some(residual)) = (run.modes, run.residual) else {
            continue;
        };
        let label = run.variant.clone().unwrap_or_else(|| run.model.clone());
        match ways.iter_mut().find(|w| w.label == label) {
            Some(way) => way.runs.push((index, run)),
            None => ways.push(TruncationVariant {
                label,
                choose: run.choose.clone().unwrap_or_default(),
                residual,
                runs: vec![(index, run)],
            }),
        }
    }
    for way in &mut ways {
        way.runs.sort_by_key(|(_, r)| r.modes);
    }
    ways
}

/// Returns all numbers of modes in the study, ascending.
pub fn counts<'w, 'a: 'w>(ways: impl IntoIterator<Item = &'w TruncationVariant<'a>>) -> Vec<usize> {
    let mut all: Vec<usize> = (ways.into_iter())
        .flat_map(|w| w.runs.iter().filter_map(|(_, r)| r.modes))
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Returns the report of a study of mode counts.
pub(super) fn report(view: &View<'_>) -> Result<StudyReport, DrawError> {
    let mut charts = charts::truncation(view)?;
    charts.extend(histories::force(std::slice::from_ref(view))?);
    Ok(StudyReport {
        finding: tables::finding(view),
        tables: tables::tables(view),
        charts,
        details: runs::all(view),
        csv: csv::tables(view.results),
        ..StudyReport::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Metrics, Status};

    fn run(modes: usize, error: f64, status: Status) -> Run {
        Run {
            model: "elastic".into(),
            integrator: "trigonometric".into(),
            variant: Some("by frequency".into()),
            choose: Some("frequency".into()),
            modes: Some(modes),
            residual: Some(true),
            status,
            metrics: vec![Metrics {
                force_l2: Some(error),
                against: "fe".into(),
                ..Metrics::default()
            }],
            ..Run::default()
        }
    }

    #[test]
    fn the_fewest_modes_hold_for_all_that_are_more() {
        let good = Status::Converged;
        let results = Results {
            runs: vec![
                run(100, 0.004, good),
                run(0, 0.009, good),
                run(25, 0.08, good),
                run(50, 0.009, good),
            ],
            ..Results::default()
        };
        let ways = variants(&results);
        assert_eq!((ways.len(), counts(&ways)), (1, vec![0, 25, 50, 100]));
        let fewest = |limit| ways[0].fewest("fe", limit).and_then(|r| r.modes);
        // Without modes the error happens to be small, but more modes spoil it.
        assert_eq!(fewest(0.01), Some(50));
        assert_eq!(fewest(0.1), Some(0));
        assert_eq!(fewest(0.005), Some(100));
        assert_eq!(fewest(0.001), None);
        assert_eq!(ways[0].fewest("calculix", 1.0).and_then(|r| r.modes), None);
    }

    #[test]
    fn a_failed_run_counts_as_beyond_every_limit() {
        let results = Results {
            runs: vec![
                run(10, 0.001, Status::Converged),
                run(50, 0.001, Status::BlowUp),
                run(100, 0.001, Status::Converged),
            ],
            ..Results::default()
        };
        let ways = variants(&results);
        let fewest = ways[0].fewest("fe", 0.01).and_then(|r| r.modes);
        assert_eq!(fewest, Some(100));
        assert_eq!(ways[0].errors("fe", Metric::ForceL2).len(), 2);
    }
}
