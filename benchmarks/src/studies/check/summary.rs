//! Terminal summary of a record of `check`.

use crate::messages::Messages;
use gearbench_reports::check::{CheckRecord, Finding, Kind};

/// Lines of an entry, most.
const MOST: usize = 12;

/// Prints the deviations from the baseline, entry by entry, and the verdict.
pub(super) fn summarise(messages: &Messages, record: &CheckRecord) {
    // Against nothing everything is new.
    let against = record.stored.as_ref().map_or(&[][..], |_| &record.entries);
    for entry in against {
        let moved: Vec<&Finding> = entry.moved().collect();
        let reported: Vec<&Finding> = entry.reported().collect();
        if moved.is_empty() && reported.iter().all(|f| f.kind == Kind::Parameter) {
            continue;
        }
        messages.print_line(&entry.measured.name());
        print_findings(messages, "moved", &moved);
        print_findings(messages, "noted", &reported);
    }
    messages.print_line(&format!("check: {}", record.verdict()));
}

fn print_findings(messages: &Messages, word: &str, findings: &[&Finding]) {
    for f in findings.iter().take(MOST) {
        messages.print_line(&format!("  {word}  {}", f.to_text()));
    }
    if findings.len() > MOST {
        messages.print_line(&format!("  and {} more", findings.len() - MOST));
    }
}
