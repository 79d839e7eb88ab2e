//! Finding and tables of a study of mode counts.

use super::{LIMITS, TruncationVariant, counts, variants};
use crate::markup::table::Table;
use crate::markup::{failed_of, glance, note, section};
use crate::metrics::Metric;
use crate::numbers::{self, per_cent, percent, quantity, times};
use crate::record::Run;
use crate::view::{View, capital};
use maud::{Markup, html};

fn against(view: &View<'_>) -> String {
    view.against.clone().unwrap_or_default()
}

fn error(run: &Run, against: &str) -> Option<f64> {
    let e = run.against(against)?.get(Metric::ForceL2);
    e.filter(|e| e.is_finite())
}

/// Returns the number of modes of a run and their highest frequency, in words.
fn modes_text(run: &Run) -> String {
    let modes = run.modes.unwrap_or(0);
    match run.highest_hz {
        Some(f) if modes > 0 => format!("{modes} (to {})", quantity(f, "Hz", 3)),
        _ => modes.to_string(),
    }
}

pub fn finding(view: &View<'_>) -> Vec<Markup> {
    let (all, id) = (variants(view.results), against(view));
    if all.is_empty() {
        return vec![html! { "The record holds no run with modes." }];
    }
    let mut sentences: Vec<Markup> = Vec::new();
    let fewest: Vec<Markup> = (all.iter().filter(|w| w.residual))
        .map(|way| {
            let reached = LIMITS.map(|limit| {
                let text = numbers::limit(limit);
                match way.fewest(&id, limit) {
                    Some(run) => format!("{} for {text}", run.modes.unwrap_or(0)),
                    None => format!("no number tried for {text}"),
                }
            });
            html! { (reached.join(", ")) " when chosen " b { (way.label) } }
        })
        .collect();
    if !fewest.is_empty() {
        sentences.push(html! {
            "With residual compliance the fewest modes per gear are "
            @for (i, text) in fewest.iter().enumerate() { @if i > 0 { "; " } (text) }
            " (error of the force history against " (view.reference_name(&id)) ")."
        });
    }
    let truncated = all.iter().filter(|w| !w.residual);
    let marked = truncated.flat_map(|w| w.runs.iter().filter(|(_, r)| r.mark.is_some()));
    let marked: Vec<Markup> = marked
        .filter_map(|(_, run)| mark_sentence(&all, run, &id))
        .collect();
    if !marked.is_empty() {
        sentences.push(html! {
            @for (i, text) in marked.iter().enumerate() { @if i > 0 { "; " } (text) } "."
        });
    }
    if sentences.is_empty() {
        sentences.push(html! { "No run could be compared with a reference." });
    }
    sentences.push(html! { (capital(&failed_of(view.results))) "." });
    sentences
}

/// Returns the sentence that compares a marked run with the best run with residual compliance and no more modes.
fn mark_sentence(all: &[TruncationVariant<'_>], run: &Run, id: &str) -> Option<Markup> {
    let name = capital(run.mark.as_deref()?);
    let modes = run.modes?;
    if run.status.is_failure() {
        return Some(html! { (name) " (" (modes) " modes) failed: " (run.status.as_str()) });
    }
    let own = error(run, id)?;
    let better = (all.iter().filter(|w| w.residual))
        .flat_map(|w| w.errors(id, Metric::ForceL2))
        .filter(|(n, _, _)| *n <= modes)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let compared = match better {
        Some((n, e, other)) => format!(
            ", {}that of {n} modes with residual compliance ({}, {} in place of {})",
            times(own / e),
            per_cent(e, 2),
            quantity(other.wall_s, "s", 2),
            quantity(run.wall_s, "s", 2),
        ),
        None => String::new(),
    };
    Some(html! {
        (name) " (" (modes) " modes per gear) has an error of " (per_cent(own, 3)) (compared)
    })
}

pub fn tables(view: &View<'_>) -> Markup {
    let (all, id) = (variants(view.results), against(view));
    if all.is_empty() {
        return Markup::default();
    }
    let mut fewest = Table::of(&all).text("Modes chosen", |w| w.label.clone());
    for limit in LIMITS {
        let heading = format!("Within {}", numbers::limit(limit));
        fewest = (fewest.written(&heading, "", |w| w.fewest(&id, limit).map(modes_text))).result();
    }
    let fewest = fewest.written("Least error", "", |w| {
        let of = w.errors(&id, Metric::ForceL2);
        let (n, e, _) = of.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!("{} with {n}", per_cent(e, 3)))
    });
    let fewest = fewest.result();
    let tried = counts(&all);
    let mut errors = Table::of(&tried).written("Modes per gear", "", |n| n.to_string());
    for way in &all {
        errors = errors.written(&way.label, "%", |n| {
            let run = way.with(*n)?;
            if run.status.is_failure() {
                return Some(run.status.to_string());
            }
            error(run, &id).map(|e| percent(e, 3))
        });
        errors = errors.result();
    }
    let reference = view.reference_name(&id);
    let fewest_note = format!(
        "The fewest modes from which on every larger number that was tried stays within the limit of the force-history error \
         against {reference}, and the highest frequency among them. A dash: none of those tried."
    );
    let errors_note = format!(
        "Relative L2 error of the contact-force history against {reference}, not shifted in time."
    );
    html! {
        (glance("Fewest modes per gear", html! { (fewest) (note(fewest_note)) }))
        (section("Force-history error by number of modes", html! { (errors) (note(errors_note)) }))
    }
}
