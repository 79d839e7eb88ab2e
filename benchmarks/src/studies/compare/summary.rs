//! Terminal summary of a record of `compare`.

use crate::experiment::run::LEFT_OUT;
use crate::messages::Messages;
use gearbench_reports::numbers::{digits_apart, short};
use gearbench_reports::record::{Results, Run, SELF, Status};
use gearbench_reports::{Adequacy, Metric, finding, yardstick_of};

/// True if the scene's tolerance excepts the model of a run.
fn is_excepted(results: &Results, run: &Run) -> bool {
    (results.tolerance.as_ref()).is_some_and(|t| t.except.contains(&run.model_label()))
}

/// Prints one line per run with its integration error and its error against the yardstick, failures with their reason,
/// and then the finding.
pub fn summarise(messages: &Messages, results: &Results) {
    let yardstick = yardstick_of(results);
    let id = yardstick.as_ref().map(|y| y.id.as_str());
    let metric = match (&results.tolerance, id) {
        (Some(t), Some(id)) if t.against == id => t.metric,
        _ => Metric::default(),
    };
    let of_model = id.map(|id| (id, metric));
    let heading = of_model.map_or_else(String::new, |(id, metric)| {
        format!("{} against {id}", metric.words())
    });
    messages.print_line(&format!(
        "{:<24} {:<30} {:>10} {:>9} {:>8} {:>12}  {heading}",
        "model", "integrator", "step/rtol", "cpu", "steps", "integration"
    ));
    // As many digits as are needed to distinguish the runs of the table.
    let steps: Vec<f64> = results.runs.iter().filter_map(|r| r.step).collect();
    let rtols: Vec<f64> = results.runs.iter().filter_map(|r| r.rtol).collect();
    let [step_digits, rtol_digits] = [steps, rtols].map(|all| digits_apart(&all, 1));
    let error = |r: &Run, id: &str, metric: Metric| {
        let error = r.against(id)?.get(metric)?.abs();
        Some(match metric.unit() {
            "" => format!("{} %", short(100.0 * error, 3)),
            unit => format!("{} {unit}", short(error, 3)),
        })
    };
    for r in &results.runs {
        let resolution = match (r.step, r.rtol) {
            (Some(h), _) => format!("{:.*e} s", step_digits - 1, h),
            (_, Some(rtol)) => format!("{:.*e}", rtol_digits - 1, rtol),
            _ => String::new(),
        };
        let cost = match r.cost_s() {
            t if t < 1e-3 => format!("{:.0} us", t * 1e6),
            t if t < 1.0 => format!("{:.1} ms", t * 1e3),
            t => format!("{t:.2} s"),
        };
        let own = error(r, SELF, Metric::ForceL1).unwrap_or_default();
        let limited = results.tolerance.as_ref();
        let found = (of_model.and_then(|(id, metric)| error(r, id, metric)))
            .or_else(|| limited.and_then(|t| error(r, &t.against, t.metric)));
        let message = || r.message.as_deref().unwrap_or("no reason given");
        let outcome = match (r.status, found) {
            (Status::Converged, found) => found.filter(|_| of_model.is_some()).unwrap_or_default(),
            (Status::Unchecked, Some(e)) => format!("{e}, {}", message()),
            // The scene shows this model for its error.
            (Status::Inaccurate, Some(e)) if is_excepted(results, r) => {
                format!("{e}, beyond the tolerance, from which the scene excepts the model")
            }
            (Status::Inaccurate, Some(e)) => format!("{e}, {}: {}", r.status, message()),
            (status, _) => format!("{status}: {}", message()),
        };
        messages.print_line(&format!(
            "{:<24} {:<30} {:>10} {:>9} {:>8} {:>12}  {}",
            r.model_label(),
            r.integrator,
            resolution,
            cost,
            r.steps,
            own,
            outcome
        ));
    }
    for (model, own) in own_solutions(results) {
        messages.print_line(&format!("{SELF} of {model}: {own}"));
    }
    for (what, pair) in results.settings.iter().filter(|(what, _)| what == LEFT_OUT) {
        messages.print_line(&format!("{what}: {pair}"));
    }
    let failed = results
        .runs
        .iter()
        .filter(|r| r.status.is_failure())
        .count();
    if failed > 0 {
        messages.print_line(&format!(
            "{failed} of {} runs failed; they are recorded as failures",
            results.runs.len()
        ));
    }
    for line in verdicts(results).into_iter().chain(unsettled(results)) {
        messages.print_line(&line);
    }
    for sentence in finding(results).unwrap_or_default() {
        messages.print_line(&sentence);
    }
}

/// Counts the runs that are beyond the tolerance of the scene, not decided or not judged; `None` if there are none.
fn verdicts(results: &Results) -> Option<String> {
    let tolerance = results.tolerance.as_ref()?;
    let yardstick = yardstick_of(results);
    let not_decided = |r: &&Run| {
        let verdict = tolerance.verdict(r, yardstick.as_deref());
        verdict.is_some_and(|(_, verdict)| verdict == Adequacy::NotDecided)
    };
    let gated = || results.runs.iter().filter(|r| !is_excepted(results, r));
    let of_status = |status| gated().filter(move |r| r.status == status);
    let beyond = of_status(Status::Inaccurate).count();
    let (open, unjudged): (Vec<&Run>, Vec<&Run>) =
        of_status(Status::Unchecked).partition(not_decided);
    let parts = [
        (beyond, "beyond the scene's tolerance"),
        (
            open.len(),
            "not decided, since the yardstick or their integration is not accurate enough",
        ),
        (unjudged.len(), "not judged by the tolerance"),
    ];
    let parts: Vec<String> = (parts.into_iter().filter(|(n, _)| *n > 0))
        .map(|(n, what)| format!("{n} {what}"))
        .collect();
    (!parts.is_empty()).then(|| {
        format!(
            "of {} runs {}; only a run within the tolerance has passed",
            results.runs.len(),
            parts.join(", ")
        )
    })
}

/// Names the runs that the files of torque paths and load sharing leave out, with the reason.
fn unsettled(results: &Results) -> Vec<String> {
    let line = |run: &Run| {
        let paths = run.paths.as_ref().filter(|p| !p.has_settled())?;
        let files = match paths.sharing.is_empty() {
            true => "torque_paths.csv leaves",
            false => "torque_paths.csv and load_sharing.csv leave",
        };
        Some(format!(
            "{files} out {} under {}: the run has not settled, its means change by {} % between both halves of the time; simulate longer",
            run.model_label(),
            run.integrator,
            short(100.0 * paths.change_rel, 2)
        ))
    };
    results.runs.iter().filter_map(line).collect()
}

/// Models, each with the converged solution that its runs are judged by.
fn own_solutions(results: &Results) -> Vec<(String, String)> {
    let mut all: Vec<(String, String)> = Vec::new();
    for run in &results.runs {
        let Some(own) = &run.own_solution else {
            continue;
        };
        let row = (run.model_label(), own.to_string());
        if !all.contains(&row) {
            all.push(row);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_reports::comparison::{CompareRecord, Yardstick};
    use gearbench_reports::record::{Metrics, Part, Tolerance, TorquePaths};

    /// A run whose error and that of the yardstick reach across the tolerance is not decided; one without an error is
    /// not judged.
    #[test]
    fn runs_that_are_not_decided_are_not_called_unjudged() {
        let run = |status, error: Option<f64>| Run {
            status,
            metrics: (error.into_iter())
                .map(|e| Metrics {
                    against: "refined".into(),
                    peak_force_rel: Some(e),
                    ..Metrics::default()
                })
                .collect(),
            ..Run::called("rigid", "rigid")
        };
        let results = Results {
            tolerance: Some(Tolerance {
                metric: Metric::PeakForceRel,
                against: "refined".into(),
                limit: 0.05,
                except: Vec::new(),
            }),
            part: Part::Compare(CompareRecord {
                yardstick: Some(Yardstick {
                    id: "refined".into(),
                    error: Some(0.02),
                    ..Yardstick::default()
                }),
                ..CompareRecord::default()
            }),
            runs: vec![
                run(Status::Converged, Some(0.01)),
                run(Status::Inaccurate, Some(0.2)),
                run(Status::Unchecked, Some(0.045)),
                run(Status::Unchecked, None),
            ],
            ..Results::default()
        };
        let line = verdicts(&results).unwrap();
        for part in ["of 4 runs 1 beyond", "1 not decided", "1 not judged"] {
            assert!(line.contains(part), "{line}");
        }
        let passed = Results {
            runs: results.runs[..1].to_vec(),
            ..results
        };
        assert_eq!(verdicts(&passed), None);
    }

    /// The terminal names each run that the files of torque paths leave out.
    #[test]
    fn runs_that_have_not_settled_are_named_with_the_files_that_lack_them() {
        let run = |change_rel| Run {
            integrator: "dopri5".into(),
            paths: Some(TorquePaths {
                change_rel,
                ..TorquePaths::default()
            }),
            ..Run::called("rigid", "rigid")
        };
        let results = Results {
            runs: vec![run(0.01), run(0.4)],
            ..Results::default()
        };
        let lines = unsettled(&results);
        assert_eq!(lines.len(), 1, "{lines:?}");
        for part in ["torque_paths.csv", "rigid under dopri5", "40 %"] {
            assert!(lines[0].contains(part), "{lines:?}");
        }
    }
}
