//! Terminal summary of a record of `sweep`.

use crate::messages::Messages;
use gearbench_reports::record::{Results, Status};
use gearbench_reports::sweep::bistable;

/// Prints one line per model, and the failures.
pub fn summarise(messages: &Messages, results: &Results) {
    messages.print_line(&format!(
        "{:<28} {:>11} {:>9} {:>13} {:>13} {:>8} {:>9}",
        "model", "static TE", "fn", "largest TE", "at", "speeds", "wall"
    ));
    let mut labels: Vec<String> = results.statics().iter().map(|s| s.label.clone()).collect();
    labels.dedup();
    for label in labels {
        let statics = results.statics().iter().find(|s| s.label == label);
        let runs: Vec<_> = (results.runs.iter())
            .filter(|r| r.model_label() == label)
            .collect();
        // A run that has not settled has no amplitude for its speed.
        let peak = (runs.iter().filter(|r| r.status.holds()))
            .filter_map(|r| r.steady.as_ref())
            .max_by(|a, b| a.error_rms_m.total_cmp(&b.error_rms_m));
        let um = |x: f64| format!("{:.3} um", 1e6 * x);
        messages.print_line(&format!(
            "{label:<28} {:>11} {:>9} {:>13} {:>13} {:>8} {:>9}",
            statics.map_or(String::new(), |s| um(s.error_peak_to_peak_m)),
            statics
                .and_then(|s| s.resonance_hz)
                .map_or(String::new(), |f| format!("{:.0} Hz", f)),
            peak.map_or(String::new(), |p| format!("{} rms", um(p.error_rms_m))),
            peak.map_or(String::new(), |p| format!("{:.0} Hz", p.mesh_frequency_hz)),
            runs.len(),
            match runs.len() {
                0 => String::new(),
                _ => format!("{:.1} s", runs.iter().map(|r| r.wall_s).sum::<f64>()),
            }
        ));
    }
    for two in bistable(results) {
        let ranges: Vec<String> = (two.ranges.iter())
            .map(|[a, b]| format!("{a:.0} to {b:.0} Hz"))
            .collect();
        messages.print_line(&format!(
            "{} has two steady motions, for increasing and for decreasing speed: {}",
            two.label,
            ranges.join(", ")
        ));
    }
    let failed: Vec<_> = (results.runs.iter())
        .filter(|r| r.status.is_failure())
        .collect();
    if let Some(first) = failed.first() {
        messages.print_line(&format!(
            "{} of {} runs failed; the first: {}: {}",
            failed.len(),
            results.runs.len(),
            first.status,
            first.message.as_deref().unwrap_or("no reason given")
        ));
    }
    let unsettled: Vec<_> = (results.runs.iter())
        .filter(|r| r.status == Status::Inaccurate)
        .collect();
    if let Some(first) = unsettled.first() {
        messages.print_line(&format!(
            "{} of {} runs are inaccurate, hence exit code 1; the first: {}, {}",
            unsettled.len(),
            results.runs.len(),
            first.model_label(),
            first.message.as_deref().unwrap_or("no reason given")
        ));
    }
}
