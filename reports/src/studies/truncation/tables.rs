//! Finding and tables of a study of mode counts.

use super::{LIMITS, Way, counts, ways};
use crate::markup::table::Table;
use crate::markup::{failed_of, glance, note, section, sentences};
use crate::metrics::Metric;
use crate::numbers::{percent, quantity, short, significant};
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

/// A number of modes and the frequency that they go up to.
fn kept(run: &Run) -> String {
    let modes = run.modes.unwrap_or(0);
    match run.highest_hz {
        Some(f) if modes > 0 => format!("{modes} (to {})", quantity(f, "Hz", 3)),
        _ => modes.to_string(),
    }
}

pub fn finding(view: &View<'_>) -> Markup {
    let (all, id) = (ways(view.results), against(view));
    if all.is_empty() {
        return html! { "The record holds no run with modes." };
    }
    let mut parts: Vec<Markup> = Vec::new();
    for way in all.iter().filter(|w| w.residual) {
        let reached = LIMITS.map(|limit| {
            let text = format!("{}\u{a0}%", short(100.0 * limit, 2));
            match way.fewest(&id, limit) {
                Some(run) => format!("{} for {text}", run.modes.unwrap_or(0)),
                None => format!("no number tried for {text}"),
            }
        });
        parts.push(html! {
            "With residual compliance and modes chosen " b { (way.label) } ", the fewest modes per gear are "
            (reached.join(", ")) " of the force history against " (view.reference_name(&id)) "."
        });
    }
    let truncated = all.iter().filter(|w| !w.residual);
    let marked = truncated.flat_map(|w| w.runs.iter().filter(|(_, r)| r.mark.is_some()));
    parts.extend(marked.filter_map(|(_, run)| beside(&all, run, &id)));
    if parts.is_empty() {
        parts.push(html! { "No run could be held against a reference." });
    }
    let runs = view.results.runs.len();
    let none = || format!("None of the {runs} runs failed.");
    parts.push(html! { (failed_of(view.results).unwrap_or_else(none)) });
    sentences(parts)
}

/// A run that is pointed out beside the best that residual compliance does with no more modes.
fn beside(all: &[Way<'_>], run: &Run, id: &str) -> Option<Markup> {
    let name = capital(run.mark.as_deref()?);
    let modes = run.modes?;
    if run.status.is_failure() {
        return Some(html! { (name) " (" (modes) " modes) failed: " (run.status.as_str()) "." });
    }
    let own = error(run, id)?;
    let better = (all.iter().filter(|w| w.residual))
        .flat_map(|w| w.errors(id, Metric::ForceL2))
        .filter(|(n, _, _)| *n <= modes)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let compared = match better {
        Some((n, e, other)) => format!(
            ", {} times that of {n} modes with residual compliance ({}\u{a0}%, {} in place of {})",
            significant(own / e, 2),
            percent(e, 2),
            quantity(other.wall_s, "s", 2),
            quantity(run.wall_s, "s", 2),
        ),
        None => String::new(),
    };
    Some(html! {
        (name) " (" (modes) " modes per gear) has an error of " (percent(own, 3)) "\u{a0}%" (compared) "."
    })
}

pub fn tables(view: &View<'_>) -> Markup {
    let (all, id) = (ways(view.results), against(view));
    if all.is_empty() {
        return Markup::default();
    }
    let mut fewest = Table::of(&all).text("Modes chosen", |w| w.label.clone());
    for limit in LIMITS {
        let heading = format!("{} %", short(100.0 * limit, 2));
        fewest = fewest.written(&heading, "", |w| w.fewest(&id, limit).map(kept));
    }
    let fewest = fewest.written("Least error", "", |w| {
        let of = w.errors(&id, Metric::ForceL2);
        let (n, e, _) = of.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!("{}\u{a0}% with {n}", percent(e, 3)))
    });
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
