//! The page of a regression check: quantities beyond their tolerance, then all quantities.

use super::files::{self, columns};
use super::{CheckRecord, CheckedEntry, Finding, Kind, Verdict};
use crate::markup::table::Table;
use crate::markup::{glance, note, section};
use crate::view::capital;
use maud::{Markup, html};

/// A finding with the entry that it is of, and that one's place.
type Row<'a> = (usize, &'a CheckedEntry, &'a Finding);

fn rows(record: &CheckRecord, keep: impl Fn(&Finding) -> bool) -> Vec<Row<'_>> {
    let entries = record.entries.iter().enumerate();
    let findings = entries.flat_map(|(i, e)| e.findings.iter().map(move |f| (i, e, f)));
    findings.filter(|(_, _, f)| keep(f)).collect()
}

/// Returns the verdict, and the changed parameters where they are known.
pub fn finding(record: &CheckRecord) -> Vec<Markup> {
    let mut all = vec![html! { b { (capital(&record.verdict())) "." } }];
    let mut changed: Vec<String> = rows(record, |f| f.kind == Kind::Parameter)
        .iter()
        .map(|(_, _, f)| {
            let [now, before] = f.texts();
            format!("{} from {before} to {now}", f.what)
        })
        .collect();
    changed.sort();
    changed.dedup();
    if !changed.is_empty() {
        let more = changed.len().saturating_sub(3);
        changed.truncate(3);
        let more = match more {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        all.push(html! { "The models were built with other constants: " (changed.join("; ")) (more) "." });
    }
    all
}

fn table(rows: &[Row<'_>]) -> Markup {
    fn of<'a>((_, e, f): &Row<'a>) -> Option<files::Row<'a>> {
        Some((e, f))
    }
    let table = Table::of(rows)
        .grouped(|(i, e, _)| (e.measured.name(), *i))
        .classed(|(_, _, f)| {
            if f.verdict == Verdict::Moved {
                "failed"
            } else {
                ""
            }
        })
        .columns_by_key(&columns(), &["quantity", "kind"], of)
        .written("Now", "", |(_, _, f)| f.texts()[0].clone())
        .result()
        .written("Baseline", "", |(_, _, f)| f.texts()[1].clone())
        .result()
        .columns_by_key(&columns(), &["change", "allowed", "verdict"], of);
    html! { (table) }
}

/// Returns the tables of quantities beyond their tolerance and of those that are reported alone; empty without a
/// baseline.
pub fn moved(record: &CheckRecord) -> Markup {
    // Against nothing everything is new.
    if record.stored.is_none() {
        return Markup::default();
    }
    let moved = rows(record, |f| f.verdict == Verdict::Moved);
    let reported = rows(record, |f| f.verdict == Verdict::Reported);
    let remark = "Errors and results in SI units; runtime is the processor time of one integration over that of a fixed kernel \
                  timed beside it.";
    html! {
        @if !moved.is_empty() { (glance("What moved", html! { (table(&moved)) (note(remark)) })) }
        @if !reported.is_empty() { (glance("Different, and reported alone", table(&reported))) }
    }
}

/// Returns the table of all quantities of all entries.
pub fn all(record: &CheckRecord) -> Markup {
    let all = rows(record, |_| true);
    if all.is_empty() {
        return Markup::default();
    }
    section("Every quantity", table(&all))
}
