//! Terminal summary of a record of `coupling`.

use crate::messages::Messages;
use gearbench_reports::numbers::{percent, quantity};
use gearbench_reports::record::Results;

/// Prints one line per model and extrapolation.
pub fn summarise(messages: &Messages, results: &Results) {
    messages.print_line(&format!(
        "{:<28} {:<22} {:>13} {:>13} {:>10} {:>24}",
        "model", "extrapolation", "accurate to", "stable to", "theory", "energy error, least step"
    ));
    for c in results.couplings() {
        let up_to = |[held, next]: [Option<f64>; 2]| match (held, next) {
            (Some(h), Some(_)) => quantity(h, "s", 3),
            (Some(h), None) => format!(">= {}", quantity(h, "s", 3)),
            (None, Some(h)) => format!("< {}", quantity(h, "s", 3)),
            (None, None) => String::new(),
        };
        let theory = c.theory_s.map_or(String::new(), |h| quantity(h, "s", 3));
        let energy = (c.cells.first()).and_then(|x| x.energy_error_rel);
        let energy = energy.map_or(String::new(), |e| format!("{} %", percent(e, 2)));
        messages.print_line(&format!(
            "{:<28} {:<22} {:>13} {:>13} {theory:>10} {energy:>24}",
            c.model_label(),
            c.manner(),
            up_to(c.accurate()),
            up_to(c.stable()),
        ));
    }
}
