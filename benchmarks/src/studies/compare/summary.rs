//! Terminal summary of a record of `compare`.

use crate::cli::terminal::print_line;
use crate::experiment::run::LEFT_OUT;
use gearbench_reports::numbers::{digits_apart, short};
use gearbench_reports::record::{Results, Run, SELF, Status};
use gearbench_reports::{Metric, finding, yardstick_of};

/// True if the scene's tolerance excepts the model of a run.
fn is_excepted(results: &Results, run: &Run) -> bool {
    (results.tolerance.as_ref()).is_some_and(|t| t.except.contains(&run.model_label()))
}

/// Prints one line per run with its integration error and its error against the yardstick, failures with their reason,
/// and then the finding.
pub fn summarise(results: &Results) {
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
    print_line(&format!(
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
        print_line(&format!(
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
        print_line(&format!("{SELF} of {model}: {own}"));
    }
    for (what, pair) in results.settings.iter().filter(|(what, _)| what == LEFT_OUT) {
        print_line(&format!("{what}: {pair}"));
    }
    let failed = results
        .runs
        .iter()
        .filter(|r| r.status.is_failure())
        .count();
    if failed > 0 {
        print_line(&format!(
            "{failed} of {} runs failed; they are recorded as failures",
            results.runs.len()
        ));
    }
    let gated = || results.runs.iter().filter(|r| !is_excepted(results, r));
    let count = |status| gated().filter(|r| r.status == status).count();
    let [inaccurate, unchecked] = [Status::Inaccurate, Status::Unchecked].map(count);
    if results.tolerance.is_some() && inaccurate + unchecked > 0 {
        print_line(&format!(
            "of {} runs {inaccurate} are beyond the scene's tolerance, and {unchecked} were not judged by it: a run that was not judged has not passed",
            results.runs.len()
        ));
    }
    for sentence in finding(results).unwrap_or_default() {
        print_line(&sentence);
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
