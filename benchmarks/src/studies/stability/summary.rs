//! Terminal summary of a record of `stability`.

use crate::messages::Messages;
use gearbench_reports::numbers::{quantity, short};
use gearbench_reports::record::{Results, Status};
use gearbench_reports::stability::Map;

/// Prints the number of cells of each label, and the largest stable steps.
pub fn summarise(messages: &Messages, results: &Results) {
    let total: usize = results.maps().iter().map(|m| m.cells.len()).sum();
    let of = |s: Status| -> usize {
        let all = results.maps().iter().flat_map(|m| &m.cells);
        all.filter(|c| c.status == s).count()
    };
    let counted: Vec<String> = (Status::ALL.into_iter())
        .filter(|s| of(*s) > 0)
        .map(|s| format!("{} {s}", of(s)))
        .collect();
    messages.print_line(&format!("{total} cells: {}", counted.join(", ")));
    messages.print_line(&format!(
        "{:<26} {:<32} {:>14} {:>10} {:>8}  failing with",
        "model", "integrator", "largest stable", "theory", "ratio"
    ));
    for (i, map) in results.maps().iter().enumerate() {
        let same =
            |o: &Map| (o.model_label(), &o.integrator) == (map.model_label(), &map.integrator);
        // Sets of maps may share a pair of model and integrator.
        let Some(limit) = map
            .limit()
            .filter(|_| !results.maps()[..i].iter().any(same))
        else {
            continue;
        };
        let step = match (limit.stable_s, limit.unstable_s) {
            (Some(h), Some(_)) => quantity(h, "s", 3),
            (Some(h), None) => format!("> {}", quantity(h, "s", 3)),
            (None, Some(h)) => format!("< {}", quantity(h, "s", 3)),
            (None, None) => String::new(),
        };
        let theory = map.theory(map.own_row()).map(|(h, _)| h);
        messages.print_line(&format!(
            "{:<26} {:<32} {step:>14} {:>10} {:>8}  {}",
            map.model_label(),
            map.integrator,
            theory.map_or(String::new(), |h| quantity(h, "s", 3)),
            map.ratio().map_or(String::new(), |r| short(r, 3)),
            limit.status.map_or("", Status::as_str),
        ));
    }
}
