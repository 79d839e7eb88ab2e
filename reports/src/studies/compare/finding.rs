//! The finding: three sentences in plain words, computed from the record, that say what was fitted to what.

use crate::markup::failed_of;
use crate::numbers::{limit, quantity, times};
use crate::record::Run;
use crate::view::{INTEGRATION, View, capital, resolution};
use maud::{Markup, html};

/// The cheapest run that will do; the least error of each model; costs and failures.
pub fn finding(view: &View<'_>) -> Vec<Markup> {
    let mut sentences = vec![cheapest(view)];
    sentences.extend(least(view));
    let failed = failed_of(view.results);
    sentences.push(match costs(view).as_slice() {
        [(label, ratio), ..] => html! {
            (capital(label)) " costs " (times(*ratio)) "as much as "
            (view.groups[0].label) " at the same method and step; " (failed) "."
        },
        [] => html! { (capital(&failed)) "." },
    });
    sentences
}

fn named(run: &Run) -> Markup {
    let at = resolution(run);
    html! {
        b { (run.model_label()) } " under " b { (run.integrator) }
        @if !at.is_empty() { " (" (at) ")" }
    }
}

fn cheapest_of<'a>(runs: impl Iterator<Item = &'a Run>) -> Option<&'a Run> {
    runs.filter(|r| r.wall_s.is_finite())
        .min_by(|a, b| a.wall_s.total_cmp(&b.wall_s))
}

fn cheapest(view: &View<'_>) -> Markup {
    let runs = &view.results.runs;
    if runs.is_empty() {
        return html! { "The record holds no runs." };
    }
    if runs.iter().all(|r| r.status.is_failure()) {
        return html! { "None of the " (runs.len()) " runs reached a usable end." };
    }
    let adequate = |r: &&Run| view.adequate(r);
    let found = cheapest_of(runs.iter().filter(adequate));
    let time = |r: &Run| quantity(r.wall_s, "s", 3);
    let Some(tolerance) = &view.results.tolerance else {
        return match found {
            Some(run) => html! {
                "The cheapest run that converged is " (named(run)) ", in " (time(run)) "."
            },
            None => html! { "No run converged." },
        };
    };
    let most = match view.metric.unit() {
        "" => limit(tolerance.limit),
        _ => view.error_text(tolerance.limit),
    };
    let asked = format!(
        "{} of at most {most} against {}",
        tolerance.metric.words(),
        view.reference_name(&tolerance.against),
    );
    let did = |r: &Run| {
        let error = view.error(r).map_or(String::new(), |e| view.error_text(e));
        html! { (named(r)) ": " (error) " in " (time(r)) }
    };
    let predicted = |r: &&Run| !view.is_fitted(r);
    let fair = cheapest_of(runs.iter().filter(adequate).filter(predicted));
    match (found, fair) {
        (Some(run), Some(other)) if view.is_fitted(run) => html! {
            "The cheapest run that predicts the scene within its tolerance (" (asked) ") is " (did(other)) "; "
            (named(run)) " takes " (time(run)) ", but its constants were fitted to this very history, so that its "
            (view.error(run).map_or(String::new(), |e| view.error_text(e))) " is what the fit leaves, not a prediction."
        },
        (Some(run), None) => html! {
            "No model predicts the scene within its tolerance (" (asked) "): the cheapest run that keeps it, " (did(run))
            ", has constants that were fitted to this very history, and its error is what the fit leaves."
        },
        (Some(run), _) => html! {
            "The cheapest run within the scene's tolerance (" (asked) ") is " (did(run)) "."
        },
        (None, _) => {
            let closest = (runs.iter().filter(|r| !r.status.is_failure()))
                .filter_map(|r| Some((r, view.error(r)?)))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            match closest {
                Some((run, _)) => html! {
                    "No run is within the scene's tolerance (" (asked) "); closest comes " (did(run)) "."
                },
                None => {
                    html! { "No run could be held against the scene's tolerance (" (asked) ")." }
                }
            }
        }
    }
}

/// The least error of each model, predictions and fits apart.
fn least(view: &View<'_>) -> Option<Markup> {
    let of = |fitted: bool| -> Vec<String> {
        (view.groups.iter())
            .filter_map(|g| view.best(g))
            .filter(|(_, run)| view.is_fitted(run) == fitted)
            .filter_map(|(_, run)| {
                let e = view.error_text(view.error(run)?);
                Some(format!("{} {e}", run.model_label()))
            })
            .collect()
    };
    let (fair, fitted) = (of(false).join(", "), of(true).join(", "));
    let kind = match view.kind_of_error() {
        INTEGRATION => "Least integration error",
        _ => "Least error",
    };
    Some(match (fair.is_empty(), fitted.is_empty()) {
        (true, true) => return None,
        (false, true) => html! { (kind) " by model: " (fair) "." },
        (true, false) => html! { "What the fits to this history leave: " (fitted) "." },
        (false, false) => html! {
            (kind) " of what was not fitted to this history: " (fair) "; what the fits to it leave: " (fitted) "."
        },
    })
}

/// For every model but the first: the median ratio of its wall time to the first model's, over
/// the runs at the same method and step that did not fail.
pub fn costs(view: &View<'_>) -> Vec<(String, f64)> {
    let Some((base, others)) = view.groups.split_first() else {
        return Vec::new();
    };
    others
        .iter()
        .filter_map(|group| {
            let mut ratios: Vec<f64> = group
                .runs
                .iter()
                .filter_map(|(_, run)| {
                    let (_, counterpart) = base.runs.iter().find(|(_, b)| {
                        b.integrator == run.integrator && b.step == run.step && b.rtol == run.rtol
                    })?;
                    let ratio = run.wall_s / counterpart.wall_s;
                    let usable = !run.status.is_failure() && !counterpart.status.is_failure();
                    (usable && ratio.is_finite() && ratio > 0.0).then_some(ratio)
                })
                .collect();
            ratios.sort_by(f64::total_cmp);
            let median = ratios.get(ratios.len() / 2)?;
            Some((group.label.clone(), *median))
        })
        .collect()
}
