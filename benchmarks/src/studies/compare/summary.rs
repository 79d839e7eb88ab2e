//! What the terminal says of a record of `compare`.

use crate::cli::terminal::say;
use crate::experiment::run::LEFT_OUT;
use gearbench_reports::numbers::{digits_apart, short};
use gearbench_reports::record::{Results, Run, SELF, Status};
use gearbench_reports::{Metric, metric_against};

/// Whether the scene's tolerance excepts the model of a run.
fn is_excepted(results: &Results, run: &Run) -> bool {
    (results.tolerance.as_ref()).is_some_and(|t| t.except.contains(&run.model_label()))
}

/// One line per run, failures with their reason.
pub fn summarise(results: &Results) {
    let against = results.references.first().map_or(SELF, |r| r.id.as_str());
    let metric = metric_against(results, against, Metric::default());
    say(&format!(
        "{:<24} {:<30} {:>10} {:>9} {:>8}  {} against {against}",
        "model",
        "integrator",
        "step/rtol",
        "wall",
        "steps",
        metric.words()
    ));
    // As many digits as tell the runs of the table apart.
    let steps: Vec<f64> = results.runs.iter().filter_map(|r| r.step).collect();
    let rtols: Vec<f64> = results.runs.iter().filter_map(|r| r.rtol).collect();
    let [step_digits, rtol_digits] = [steps, rtols].map(|all| digits_apart(&all, 1));
    for r in &results.runs {
        let resolution = match (r.step, r.rtol) {
            (Some(h), _) => format!("{:.*e} s", step_digits - 1, h),
            (_, Some(rtol)) => format!("{:.*e}", rtol_digits - 1, rtol),
            _ => String::new(),
        };
        let wall = if r.wall_s < 1e-3 {
            format!("{:.0} us", r.wall_s * 1e6)
        } else if r.wall_s < 1.0 {
            format!("{:.1} ms", r.wall_s * 1e3)
        } else {
            format!("{:.2} s", r.wall_s)
        };
        let error = r.against(against).and_then(|m| m.get(metric));
        let outcome = match (r.status, error) {
            (Status::Converged, Some(e)) => format!("{} %", short(100.0 * e, 3)),
            (Status::Unchecked, Some(e)) => {
                let why = r.message.as_deref().unwrap_or("not judged");
                format!("{} %, {why}", short(100.0 * e, 3))
            }
            // The scene shows this model for its error.
            (Status::Inaccurate, Some(e)) if is_excepted(results, r) => format!(
                "{} %, beyond the tolerance, from which the scene excepts the model",
                short(100.0 * e, 3)
            ),
            (status, _) => format!(
                "{status}: {}",
                r.message.as_deref().unwrap_or("no reason given")
            ),
        };
        say(&format!(
            "{:<24} {:<30} {:>10} {:>9} {:>8}  {}",
            r.model_label(),
            r.integrator,
            resolution,
            wall,
            r.steps,
            outcome
        ));
    }
    for (model, own) in own_solutions(results) {
        say(&format!("{SELF} of {model}: {own}"));
    }
    for (what, pair) in results.settings.iter().filter(|(what, _)| what == LEFT_OUT) {
        say(&format!("{what}: {pair}"));
    }
    let failed = results
        .runs
        .iter()
        .filter(|r| r.status.is_failure())
        .count();
    if failed > 0 {
        say(&format!(
            "{failed} of {} runs failed; they are recorded as failures",
            results.runs.len()
        ));
    }
    let gated = || results.runs.iter().filter(|r| !is_excepted(results, r));
    let count = |status| gated().filter(|r| r.status == status).count();
    let [inaccurate, unchecked] = [Status::Inaccurate, Status::Unchecked].map(count);
    if results.tolerance.is_some() && inaccurate + unchecked > 0 {
        say(&format!(
            "of {} runs {inaccurate} are beyond the scene's tolerance, and {unchecked} were not judged by it: a run that was not judged has not passed",
            results.runs.len()
        ));
    }
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
