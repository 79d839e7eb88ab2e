//! What the terminal says of a fit.

use super::plan::Identification;
use crate::cli::terminal::say;

/// The error that is left, and the parameters with their intervals.
pub fn summarise(label: &str, reference: &str, r: &Identification) {
    let part = |what: &str, error: Option<f64>| {
        error.map(|e| format!("{what} within {:.3} % (relative L2)", 100.0 * e))
    };
    let parts = [
        part("force history", r.force_l2),
        part("static compliance", r.static_l2),
    ];
    say(&format!(
        "{label}: {} of {reference}, {} trials",
        parts.into_iter().flatten().collect::<Vec<_>>().join(", "),
        r.evaluations
    ));
    for p in &r.parameters {
        say(&format!(
            "  {:<26} {:>12.5e}  +- {:.1} % (95 %)",
            p.key,
            p.value,
            100.0 * p.relative_95
        ));
        if p.relative_95 > 0.5 {
            say(
                "    hardly identifiable: the force history does not tell this value apart from its neighbours",
            );
        }
    }
}
