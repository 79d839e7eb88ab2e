//! Terminal summary of a record of `check`.

use crate::cli::terminal::say;
use gearbench_reports::check::{CheckRecord, Finding, Kind};

/// Lines of an entry, most.
const MOST: usize = 12;

/// Prints the deviations from the baseline, entry by entry, and the verdict.
pub(super) fn summarise(record: &CheckRecord) {
    // Against nothing everything is new.
    let against = record.stored.as_ref().map_or(&[][..], |_| &record.entries);
    for entry in against {
        let moved: Vec<&Finding> = entry.moved().collect();
        let reported: Vec<&Finding> = entry.reported().collect();
        if moved.is_empty() && reported.iter().all(|f| f.kind == Kind::Parameter) {
            continue;
        }
        say(&entry.measured.name());
        tell("moved", &moved);
        tell("noted", &reported);
    }
    say(&format!("check: {}", record.verdict()));
}

fn tell(word: &str, findings: &[&Finding]) {
    for f in findings.iter().take(MOST) {
        say(&format!("  {word}  {}", f.told()));
    }
    if findings.len() > MOST {
        say(&format!("  and {} more", findings.len() - MOST));
    }
}
