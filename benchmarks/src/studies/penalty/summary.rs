//! Terminal summary of a record of `penalty`.

use crate::messages::Messages;
use gearbench_reports::record::Results;

/// Prints one line per penalty.
pub fn summarise(messages: &Messages, results: &Results) {
    messages.print_line(&format!(
        "{:>10} {:>12} {:>13} {:>13}  {}",
        "Pa/m", "peak force", "impulse", "static TE", "status"
    ));
    for r in &results.runs {
        let name = r
            .penalty_pa_per_m
            .map_or("hard".into(), |p| format!("{p:.1e}"));
        let m = r.metrics.first();
        let text = |x: Option<f64>, unit: &str, scale: f64| {
            x.map_or(String::new(), |x| format!("{:.5} {unit}", scale * x))
        };
        messages.print_line(&format!(
            "{name:>10} {:>12} {:>13} {:>13}  {}",
            text(m.and_then(|m| m.peak_force_n), "kN", 1e-3),
            text(m.and_then(|m| m.impulse_ns), "N s", 1.0),
            text(r.static_error_m, "um", 1e6),
            r.status
        ));
    }
}
