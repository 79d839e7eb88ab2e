//! Files of a regression check for other programs: summary in Markdown for a pull request, JUnit XML for a CI server,
//! CSV.

use super::{CheckRecord, CheckedEntry, CheckedValue, Finding, Verdict};
use crate::columns::Columns;
use crate::csv_table::{CsvTable, exact};
use crate::escape::markdown as markdown_text;
use crate::markup::column::Format;
use maud::{PreEscaped, html};

/// Largest number of findings in the summary; the page has all.
const MOST: usize = 40;

/// Returns the summary of a check in Markdown.
pub fn markdown(record: &CheckRecord) -> String {
    let mark = if record.holds() { "holds" } else { "moved" };
    let mut text = format!(
        "### gearbench check: {mark}\n\n{}.\n",
        markdown_text(&record.verdict())
    );
    let of = |verdict: Verdict| {
        (record.entries.iter()).flat_map(move |e| {
            let findings = e.findings.iter().filter(move |f| f.verdict == verdict);
            findings.map(move |f| (e, f))
        })
    };
    for (heading, verdict) in [
        ("Moved", Verdict::Moved),
        ("Reported alone", Verdict::Reported),
    ] {
        let found: Vec<(&CheckedEntry, &Finding)> = of(verdict).collect();
        if found.is_empty() {
            continue;
        }
        text.push_str(&format!(
            "\n**{heading}**\n\n| entry | quantity | now | baseline | change | allowed |\n|---|---|---|---|---|---|\n"
        ));
        for (e, f) in found.iter().take(MOST) {
            let change = f.change.map_or(String::new(), |c| {
                format!("{} %", crate::numbers::deviation(c, 3))
            });
            let [now, before] = f.texts();
            let name = e.measured.name();
            let cells = [&name, &f.what, &now, &before, &change, &f.allowed];
            let cells = cells.map(|c| markdown_text(c));
            text.push_str(&format!("| {} |\n", cells.join(" | ")));
        }
        if found.len() > MOST {
            text.push_str(&format!("\n{} more: see the page.\n", found.len() - MOST));
        }
    }
    text
}

/// Returns the check as JUnit XML: a suite for each case, a test for each quantity of an entry.
pub fn junit(record: &CheckRecord) -> String {
    let mut cases: Vec<&str> = Vec::new();
    for e in &record.entries {
        if !cases.contains(&e.measured.case.as_str()) {
            cases.push(&e.measured.case);
        }
    }
    let of = |case: &str| {
        let entries = record.entries.iter();
        let entries: Vec<&CheckedEntry> = entries.filter(|e| e.measured.case == case).collect();
        entries
    };
    let count = |entries: &[&CheckedEntry]| entries.iter().map(|e| e.findings.len()).sum::<usize>();
    let failed =
        |entries: &[&CheckedEntry]| entries.iter().map(|e| e.moved().count()).sum::<usize>();
    let every: Vec<&CheckedEntry> = record.entries.iter().collect();
    let xml = html! {
        testsuites name="gearbench check" tests=(count(&every)) failures=(failed(&every)) {
            @for case in &cases {
                @let entries = of(case);
                testsuite name=(case) tests=(count(&entries)) failures=(failed(&entries)) errors="0" skipped="0" {
                    @for e in &entries { @for f in &e.findings {
                        testcase classname=(format!("{}.{}.{}", case, e.measured.model, e.measured.method))
                            name=(format!("{} {}", f.kind, f.what)) {
                            @if f.verdict == Verdict::Moved {
                                failure message=(f.to_text()) type=(f.kind) { (e.measured.name()) ": " (f.to_text()) }
                            }
                        }
                    } }
                }
            }
        }
    };
    let lines = xml
        .0
        .replace("<testsuite ", "\n<testsuite ")
        .replace("<testcase", "\n<testcase");
    let text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n",
        PreEscaped(lines).0
    );
    // XML has no place for control characters.
    text.chars()
        .filter(|c| *c == '\n' || !c.is_control())
        .collect()
}

/// Formats a value as a cell, a number with all its digits.
fn value(value: &CheckedValue) -> String {
    match value {
        CheckedValue::Number(x) => exact(*x),
        CheckedValue::Text(text) => text.clone(),
    }
}

/// Returns the table with a row per quantity.
pub fn tables(record: &CheckRecord) -> Vec<CsvTable> {
    let rows = record
        .entries
        .iter()
        .flat_map(|e| e.findings.iter().map(move |f| (e, f)));
    vec![columns().table(rows)]
}

/// A quantity of an entry.
pub type Row<'a> = (&'a CheckedEntry, &'a Finding);

/// Returns the columns of quantities.
#[rustfmt::skip]
pub fn columns<'a>() -> Columns<'a, Row<'a>> {
    Columns::<Row<'_>>::of("check.csv", "`check`: one row per quantity.")
        .add("case", "case of the check", |(e, _)| e.measured.case.clone())
        .add("scene", "name of the scene", |(e, _)| e.measured.scene.clone())
        .model(|(e, _)| e.measured.model.clone())
        .add("method", "method with its step or tolerance", |(e, _)| e.measured.method.clone())
        .add("kind", "`status`, `metric`, `limit`, `work`, `runtime`, `parameter` or `entry`", |(_, f)| f.kind.to_string()).shown("Kind", Format::Text)
        .add("quantity", "key of the checked quantity", |(_, f)| f.what.clone()).shown("Quantity", Format::Text)
        .add("now", "its value in SI units, or a text", |(_, f)| value(&f.now))
        .add("baseline", "value in the stored baseline", |(_, f)| value(&f.before))
        .add("change", "change over the baseline", |(_, f)| f.change).shown("Change", Format::Deviations).result()
        .add("allowed", "allowed difference", |(_, f)| f.allowed.clone()).shown("Allowed", Format::Text)
        .add("verdict", "`held`, `reported` (a difference that does not fail the check) or `moved`", |(_, f)| f.verdict).shown("Verdict", Format::Text)
}
