//! Runs of the study over the number of modes.

use super::plan::{Case, FULL, ModeBound, Plan, VARIANTS};
use crate::experiment::decimation::decimate_run;
use crate::experiment::run::{Job, RunError, run};
use crate::experiment::runner::Runner;
use gearbench_reports::metrics::compare_all;
use gearbench_reports::record::{Part, ReferenceSeries, Results, Run};
use gearbench_reports::truncation::{LIMITS, variants};

/// Factor by which the time limit of the full model exceeds that of other runs.
const PATIENCE: u32 = 10;

/// Runs the full model and all truncated ones, and computes the errors of the truncated ones.
///
/// # Errors
/// [`RunError`] when a model cannot be built, the full model does not reach the end, or the user interrupts.
pub fn study(plan: &Plan, runner: &Runner<'_>) -> Result<Results, RunError> {
    let grid = plan.conditions.grid();
    let cases = plan.cases();
    let mut total = 1 + cases.len();
    runner.report_progress(0, total, "full finite elements");
    let full = &plan.full;
    let job = Job {
        repeats: 0,
        timeout: PATIENCE * plan.conditions.timeout,
        histories: true,
        ..(plan.conditions).job((&full.scene, &full.modelling), &plan.full_method, &grid)
    };
    let mut reference: Run = runner.piece(job.key(), || run(&job))?;
    reference.end_s = Some(job.t_end);
    reference.model = FULL.into();
    let Some(series) = reference
        .series
        .clone()
        .filter(|_| !reference.status.is_failure())
    else {
        return Err(RunError::Reference(format!(
            "the full model under {} did not complete the run: {}",
            plan.full_method.method,
            reference.message.as_deref().unwrap_or("no reason given")
        )));
    };
    for external in &plan.external {
        let metrics = reference.finished();
        let metrics = metrics.map(|r| compare_all(r, &external.all_series(), &external.id));
        reference.metrics.extend(metrics);
    }
    let mut references = vec![ReferenceSeries {
        id: FULL.into(),
        title: "full finite elements on the same mesh".into(),
        source: format!(
            "the first run of this record: {} coordinates under {}",
            reference.dofs, plan.full_method.method
        ),
        series,
        ..ReferenceSeries::default()
    }];
    references.extend(plan.external.iter().cloned());

    let mut results = Results {
        references,
        runs: vec![reference],
        ..plan.conditions.record(Part::Truncation)
    };
    let held = (job.key(), &plan.external);
    let one = |case: &Case, results: &mut Results, total: usize| -> Result<(), RunError> {
        let what = format!("{}, {}", case.modes, case.way.label);
        runner.report_progress(results.runs.len(), total, &what);
        let modelling = plan.modelling(case);
        let method = plan.method(case);
        let job = Job {
            histories: true,
            ..(plan.conditions).job((&plan.elastic.scene, &modelling), &method, &grid)
        };
        let mut row = runner.row(job.key().and(&held), &method, || {
            let mut row = run(&job)?;
            for r in &results.references {
                let metrics = (row.finished()).map(|run| compare_all(run, &r.all_series(), &r.id));
                row.metrics.extend(metrics);
            }
            row.contacts = None;
            decimate_run(&mut row, &[]);
            Ok::<_, RunError>(row)
        })?;
        row.model.clone_from(&plan.elastic.model);
        row.variant = Some(case.way.label.into());
        row.choose = Some(case.way.choose.id().into());
        row.residual = Some(case.way.residual);
        // The modes that were kept, as the model says; a model without any keeps none.
        row.modes = Some(row.modes.unwrap_or(0));
        row.mark = case.mark.map(Into::into);
        runner.reserve_memory(&row);
        results.runs.push(row);
        Ok(())
    };
    for case in &cases {
        one(case, &mut results, total)?;
    }
    if plan.refine {
        for way in VARIANTS.iter().filter(|w| w.residual && w.step == 1.0) {
            for limit in LIMITS {
                while let Some(modes) = between(&results, way.label, limit) {
                    total += 1;
                    let case = Case {
                        way: *way,
                        modes: ModeBound::Count(modes),
                        mark: None,
                    };
                    let before = counts(&results, way.label).len();
                    one(&case, &mut results, total)?;
                    // Families are kept whole: another number asked for may be one that was had.
                    if counts(&results, way.label).len() == before {
                        results.runs.pop();
                        break;
                    }
                }
            }
        }
    }
    keep_histories(&mut results);
    Ok(results)
}

/// Numbers of modes that a way has kept, ascending, each once.
fn counts(results: &Results, label: &str) -> Vec<usize> {
    let mut all: Vec<usize> = (results.runs.iter())
        .filter(|r| r.variant.as_deref() == Some(label))
        .filter_map(|r| r.modes)
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The number of modes halfway between the fewest that keep a limit and the next smaller that was tried; `None` when
/// there is none in between, or nothing keeps the limit.
fn between(results: &Results, label: &str, limit: f64) -> Option<usize> {
    let ways = variants(results);
    let way = ways.iter().find(|w| w.label == label)?;
    let fewest = way.fewest(FULL, limit)?.modes?;
    let below = (counts(results, label).into_iter())
        .filter(|n| *n < fewest)
        .max()?;
    (fewest - below > 1).then_some(below + (fewest - below) / 2)
}

/// Keeps only the histories that reports show: the reference, marked runs, the best of each variant and the one that
/// reaches the middle limit.
fn keep_histories(results: &mut Results) {
    let mut keep = vec![0];
    for way in variants(results) {
        let least = (way
            .errors(FULL, gearbench_reports::Metric::ForceL2)
            .into_iter())
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(_, _, r)| r.clone());
        let middle = way.fewest(FULL, LIMITS[1]).cloned();
        for (i, r) in &way.runs {
            let is = |o: &Option<Run>| o.as_ref().is_some_and(|o| o.modes == r.modes);
            if r.mark.is_some() || is(&least) || is(&middle) {
                keep.push(*i);
            }
        }
    }
    for (i, run) in results.runs.iter_mut().enumerate() {
        if !keep.contains(&i) {
            run.series = None;
            run.histories = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_reports::record::Metrics;

    /// A run of a made-up model whose error falls with its modes.
    fn row(modes: usize) -> Run {
        Run {
            model: "elastic".into(),
            integrator: "trigonometric".into(),
            variant: Some("by frequency".into()),
            modes: Some(modes),
            residual: Some(true),
            metrics: vec![Metrics {
                force_l2: Some(0.5 / (1.0 + modes as f64)),
                against: "fe".into(),
                ..Metrics::default()
            }],
            ..Run::default()
        }
    }

    #[test]
    fn halving_finds_the_fewest_modes() {
        let mut results = Results {
            runs: [0, 10, 25, 50, 100, 200].map(row).to_vec(),
            ..Results::default()
        };
        let mut tried = 0;
        while let Some(modes) = between(&results, "by frequency", 0.01) {
            results.runs.push(row(modes));
            tried += 1;
        }
        // 0.5 / (1 + n) falls to 1 % at 49 modes.
        let ways = variants(&results);
        assert_eq!(ways[0].fewest("fe", 0.01).and_then(|r| r.modes), Some(49));
        assert!(tried <= 5, "{tried} runs");
        assert_eq!(between(&results, "by frequency", 1e-6), None);
        assert_eq!(between(&results, "another", 0.01), None);
    }
}
