//! Terminal summary of a record of `truncation`.

use super::plan::FULL;
use crate::messages::Messages;
use gearbench_reports::numbers::percent;
use gearbench_reports::record::Results;
use gearbench_reports::truncation::{LIMITS, TruncationVariant, counts, variants};

/// Prints the table of errors and the fewest modes.
pub fn summarise(messages: &Messages, results: &Results) {
    let all = variants(results);
    messages.print_line("force-history error against full finite elements [%]");
    // Labels are sentences: columns go by letters, with a key above.
    let letters: Vec<String> = ('A'..='Z').map(String::from).take(all.len()).collect();
    for (letter, way) in letters.iter().zip(&all) {
        messages.print_line(&format!("  {letter}: {}", way.label));
    }
    let wide = 10;
    let heads: Vec<String> = letters.iter().map(|l| format!("{l:>wide$}")).collect();
    messages.print_line(&format!("{:>6}{}", "modes", heads.join("")));
    for n in counts(&all) {
        let cell = |w: &TruncationVariant<'_>| {
            let text = w.with(n).map_or(String::new(), |r| {
                let error = r.against(FULL).and_then(|m| m.force_l2);
                match error {
                    _ if r.status.is_failure() => r.status.as_str().to_string(),
                    Some(e) => percent(e, 3),
                    None => String::new(),
                }
            });
            format!("{text:>wide$}")
        };
        let cells: Vec<String> = all.iter().map(cell).collect();
        // A number of modes of which no way has an error is no row.
        if cells.iter().all(|c| c.trim().is_empty()) {
            continue;
        }
        messages.print_line(&format!("{n:>6}{}", cells.join("")));
    }
    for limit in LIMITS {
        let found: Vec<String> = (all.iter().filter(|w| w.residual))
            .map(|w| {
                let modes = w.fewest(FULL, limit).and_then(|r| r.modes);
                let modes = modes.map_or("none tried".into(), |n| n.to_string());
                format!("{modes} {}", w.label)
            })
            .collect();
        messages.print_line(&format!(
            "least number of modes for {} %: {}",
            100.0 * limit,
            found.join(", ")
        ));
    }
}
