//! Terminal summary of a record of `precision`.

use super::run::COARSE;
use crate::experiment::budget::NOT_TRIED;
use crate::messages::Messages;
use gearbench_reports::numbers::{percent, quantity};
use gearbench_reports::precision::{Cost, LEVELS, Precision as Told, family, modes_and_step};
use gearbench_reports::record::{Results, SELF, Status};

/// Prints the Pareto front of error and cost against every reference, and the cheapest run within each error limit.
pub fn summarise(messages: &Messages, results: &Results) {
    let told = Told::of(results);
    for id in &told.references {
        let metric = told.headline_against(id);
        let cloud = told.cloud(id, metric, Cost::Processor);
        if cloud.shown.is_empty() {
            continue;
        }
        messages.print_line(&format!("Pareto front against {id}, {metric}"));
        for i in cloud.front(|_| true) {
            let s = &cloud.shown[i];
            let fitted = if s.is_fitted() { ", fitted to it" } else { "" };
            messages.print_line(&format!(
                "  {:>10} %  {:>9}  {} ({}){fitted}",
                percent(s.point.error, 3),
                quantity(s.run.cost_s(), "s", 3),
                family(s.run),
                modes_and_step(s.run)
            ));
        }
        for fitted_too in [false, true] {
            if fitted_too && !cloud.has_fitted() {
                continue;
            }
            let which = match (cloud.has_fitted(), fitted_too) {
                (false, _) => "cheapest within a limit",
                (true, false) => "cheapest within a limit, without fitted models",
                (true, true) => "cheapest within a limit, fitted models included",
            };
            let lines: Vec<String> = (LEVELS.iter())
                .filter_map(|l| cloud.cheapest_runs(*l, fitted_too))
                .map(|s| format!("{} {}", s.level(), s.winner()))
                .collect();
            if !lines.is_empty() {
                messages.print_line(&format!("{which}:\n  {}", lines.join("\n  ")));
            }
        }
    }
    if told.references.is_empty() {
        // Without a reference there is the integrators' own error.
        let metric = told.headline_against(SELF);
        messages.print_line(&format!(
            "error against each model's own converged solution, {metric}"
        ));
        let sound = results.runs.iter().filter(|r| !r.status.is_failure());
        for r in sound {
            let own = r.against(SELF).and_then(|m| m.get(metric));
            messages.print_line(&format!(
                "  {:>10}  {:>9}  {} ({})",
                own.map_or("unknown".into(), |e| format!("{} %", percent(e, 3))),
                quantity(r.cost_s(), "s", 3),
                family(r),
                modes_and_step(r)
            ));
        }
    }
    let shown = |what: &str| what == COARSE || what == NOT_TRIED;
    for (what, which) in results.settings.iter().filter(|(what, _)| shown(what)) {
        messages.print_line(&format!("{what}: {which}"));
    }
    let failed = (results.runs.iter())
        .filter(|r| r.status.is_failure())
        .count();
    let timeouts = (results.runs.iter())
        .filter(|r| r.status == Status::Timeout)
        .count();
    messages.print_line(&format!(
        "{} runs, {failed} of them failed{}",
        results.runs.len(),
        match timeouts {
            0 => String::new(),
            n => format!(", {n} because they exceeded --timeout"),
        }
    ));
}
