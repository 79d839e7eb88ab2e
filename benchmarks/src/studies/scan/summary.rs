//! Terminal summary of a scan: its finding and the first failures.

use crate::messages::Messages;
use gearbench_reports::finding;
use gearbench_reports::record::Results;

/// Largest number of kinds of failures that are printed.
const MOST_FAILURES: usize = 5;

/// Prints the finding, and the kinds of failures with the first cell of each.
pub fn summarise(messages: &Messages, results: &Results) {
    for line in finding(results).unwrap_or_default() {
        messages.print_line(&line);
    }
    let Some(scan) = results.scan() else { return };
    for f in scan.failures.iter().take(MOST_FAILURES) {
        let c = &scan.configurations[f.configuration];
        messages.print_line(&format!(
            "{} of {}, {}: {}, first in cell {}: {}",
            f.count, c.label, c.integrator, f.status, f.first_cell, f.message
        ));
    }
}
