//! What the terminal says of a record of `compare`.

use crate::cli::terminal::say;
use crate::experiment::run::LEFT_OUT;
use gearbench_reports::numbers::short;
use gearbench_reports::record::{Results, Status};

/// One line per run, failures with their reason.
pub fn summarise(results: &Results) {
    let against = results.references.first().map_or("self", |r| r.id.as_str());
    say(&format!(
        "{:<24} {:<30} {:>9} {:>9} {:>8}  force error against {against}",
        "model", "integrator", "step/rtol", "wall", "steps"
    ));
    for r in &results.runs {
        let resolution = r
            .step
            .or(r.rtol)
            .map_or(String::new(), |x| format!("{x:.0e}"));
        let wall = if r.wall_s < 1e-3 {
            format!("{:.0} us", r.wall_s * 1e6)
        } else if r.wall_s < 1.0 {
            format!("{:.1} ms", r.wall_s * 1e3)
        } else {
            format!("{:.2} s", r.wall_s)
        };
        let outcome = match (
            r.status,
            r.against(against).and_then(|m| m.force_l2_aligned),
        ) {
            (Status::Converged, Some(e)) => format!("{} %", short(100.0 * e, 3)),
            (Status::Converged, None) => "converged".into(),
            (status, _) => format!(
                "{status}: {}",
                r.message.as_deref().unwrap_or("no reason given")
            ),
        };
        say(&format!(
            "{:<24} {:<30} {:>9} {:>9} {:>8}  {}",
            r.model_label(),
            r.integrator,
            resolution,
            wall,
            r.steps,
            outcome
        ));
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
}
