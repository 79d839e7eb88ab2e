//! Terminal summary of a record of `check`.

use crate::cli::terminal::print_line;
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
        print_line(&entry.measured.name());
        print_findings("moved", &moved);
        print_findings("noted", &reported);
    }
    print_line(&format!("check: {}", record.verdict()));
}

fn print_findings(word: &str, findings: &[&Finding]) {
    for f in findings.iter().take(MOST) {
        print_line(&format!("  {word}  {}", f.to_text()));
    }
    if findings.len() > MOST {
        print_line(&format!("  and {} more", findings.len() - MOST));
    }
}
