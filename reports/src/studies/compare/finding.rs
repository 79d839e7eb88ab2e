//! The finding of a comparison in sentences: yardstick, cheapest adequate model, errors and costs.
//!
//! Errors of models and errors of integration are never in one sentence. If the record has only each model's own
//! converged solution to compare with, the finding is about the integration alone and states this.

use super::{Kind, Yardstick};
use crate::markup::failed_of;
use crate::numbers::{limit, per_cent, quantity, times};
use crate::record::{Run, SELF, Tolerance};
use crate::studies::choose::Adequacy;
use crate::view::{INTEGRATION, View, capital, resolution};
use maud::{Markup, html};

/// Returns the sentences of the finding.
pub fn finding(view: &View<'_>) -> Vec<Markup> {
    let mut sentences: Vec<Markup> = view.yardstick.iter().map(|y| yardstick(y)).collect();
    sentences.push(cheapest(view));
    sentences.extend(least(view));
    let failed = failed_of(view.results);
    sentences.push(match costs(view).as_slice() {
        [(label, ratio), ..] => html! {
            (capital(label)) " costs " (times(*ratio)) "as much processor time as "
            (view.groups[0].label) " at the same method and step; " (failed) "."
        },
        [] => html! { (capital(&failed)) "." },
    });
    sentences
}

/// Returns the sentence on the yardstick and its own error.
fn yardstick(y: &Yardstick) -> Markup {
    let what = match y.kind {
        Kind::Stored => "",
        Kind::Refined => ", made for this comparison",
        Kind::Model => ", the most detailed model of the scene",
        Kind::Named => ", the model that was named for it",
    };
    html! {
        "Models are compared with " b { (y.title) } (what) "; " (y.own_error())
        @if !y.note.is_empty() { " (" (y.note) ")" }
        "."
    }
}

fn named(run: &Run) -> Markup {
    let at = resolution(run);
    html! {
        b { (run.model_label()) } " under " b { (run.integrator) }
        @if !at.is_empty() { " (" (at) ")" }
    }
}

fn cheapest_of<'a>(runs: impl Iterator<Item = &'a Run>) -> Option<&'a Run> {
    runs.filter(|r| r.cost_s().is_finite())
        .min_by(|a, b| a.cost_s().total_cmp(&b.cost_s()))
}

fn cheapest(view: &View<'_>) -> Markup {
    let runs = &view.results.runs;
    if runs.is_empty() {
        return html! { "The record holds no runs." };
    }
    if runs.iter().all(|r| r.status.is_failure()) {
        return html! { "None of the " (runs.len()) " runs reached a usable end." };
    }
    match view.limit {
        Some(_) if view.against.as_deref() == Some(SELF) => of_integration(view),
        Some(most) => within(view, most),
        None => without_tolerance(view),
    }
}

/// Returns the sentence for a scene without tolerance.
fn without_tolerance(view: &View<'_>) -> Markup {
    let by_integration = view
        .results
        .tolerance
        .as_ref()
        .filter(|t| t.against == SELF);
    match (&view.yardstick, by_integration) {
        (Some(_), Some(t)) => html! {
            "The tolerance of the scene (" (limit_text(view, t)) ") is one of integration, so that no model is called adequate or not."
        },
        (Some(_), None) => html! {
            "The scene has no `tolerance`, so that no model is called adequate or not."
        },
        (None, _) => of_integration(view),
    }
}

/// Formats the limit of a tolerance with its metric.
fn limit_text(view: &View<'_>, tolerance: &Tolerance) -> String {
    let most = match tolerance.metric.unit() {
        "" => limit(tolerance.limit),
        unit => quantity(tolerance.limit, unit, 3),
    };
    format!(
        "{} of at most {most} against {}",
        tolerance.metric.words(),
        view.reference_name(&tolerance.against),
    )
}

/// Returns the sentence for models that are compared with their own converged solutions alone: the cost of their
/// integration.
fn of_integration(view: &View<'_>) -> Markup {
    let runs = view.results.runs.iter();
    let found = cheapest_of(runs.filter(|r| view.adequate(r)));
    let nothing =
        "Nothing more detailed than the models is in the record: their own errors are not known.";
    let time = |r: &Run| quantity(r.cost_s(), "s", 3);
    let tolerance = view.results.tolerance.as_ref();
    // A tolerance of models says nothing of their integration.
    if let Some(t) = tolerance.filter(|t| t.against != SELF) {
        return html! {
            (nothing) " The tolerance of the scene (" (limit_text(view, t)) ") is not applied, since " (t.against)
            " has no result in the record."
        };
    }
    match (found, tolerance) {
        (Some(run), Some(t)) => html! {
            (nothing) " The cheapest run that is integrated within the scene's tolerance (" (limit_text(view, t)) ") is "
            (named(run)) ", in " (time(run)) "."
        },
        (Some(run), None) => html! {
            (nothing) " The cheapest run whose integration converged is " (named(run)) ", in " (time(run)) "."
        },
        (None, Some(t)) => html! {
            (nothing) " No run is integrated within the scene's tolerance (" (limit_text(view, t)) ")."
        },
        (None, None) => html! { (nothing) " The integration of no run was judged as converged." },
    }
}

/// Returns the reason why a model is not decided, for the end of a sentence.
fn undecided(view: &View<'_>) -> String {
    match view.yardstick.as_ref().map(|y| (&y.title, y.error)) {
        Some((title, Some(own))) => {
            format!("{title} has an error of {} itself.", per_cent(own, 2))
        }
        Some((title, None)) => format!("the error of {title} itself is not known."),
        None => "the error of the reference itself is not known.".into(),
    }
}

/// Returns the sentence on the adequate models.
fn within(view: &View<'_>, most: f64) -> Markup {
    let time = |r: &Run| quantity(r.cost_s(), "s", 3);
    let runs = || (view.results.runs.iter()).filter(|r| !view.is_yardstick(r));
    let with = |wanted: Adequacy| runs().filter(move |r| view.verdict(r) == Some(wanted));
    let asked = format!(
        "{} of at most {}",
        view.metric.words(),
        match view.metric.unit() {
            "" => limit(most),
            _ => view.error_text(most),
        }
    );
    let did = |r: &Run| {
        let error = view.error(r).map_or(String::new(), |e| view.error_text(e));
        html! { (named(r)) ": " (error) " in " (time(r)) }
    };
    let found = cheapest_of(with(Adequacy::Adequate));
    let fair = cheapest_of(with(Adequacy::Adequate).filter(|r| !view.is_fitted(r)));
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
        (None, _) => match cheapest_of(with(Adequacy::NotDecided)) {
            Some(run) => html! {
                "The cheapest run that may be within the scene's tolerance (" (asked) ") is " (did(run)) ". It is not decided, since "
                @if run.agrees_by_chance(view.metric, most) { "its error of integration alone exceeds the tolerance." }
                @else { (undecided(view)) }
            },
            None => {
                let closest = (runs().filter(|r| !r.status.is_failure()))
                    .filter_map(|r| Some((r, view.error(r)?)))
                    .min_by(|a, b| a.1.total_cmp(&b.1));
                match closest {
                    Some((run, _)) => html! {
                        "No run is within the scene's tolerance (" (asked) "); closest comes " (did(run)) "."
                    },
                    None => html! {
                        "No run could be compared under the scene's tolerance (" (asked) ")."
                    },
                }
            }
        },
    }
}

/// Returns the sentences on the least error of each model, with predictions and fits apart.
fn least(view: &View<'_>) -> Option<Markup> {
    let of = |fitted: bool| -> Vec<String> {
        (view.groups.iter())
            .filter_map(|g| view.best(g))
            .filter(|(_, run)| view.is_fitted(run) == fitted && !view.is_yardstick(run))
            .filter_map(|(_, run)| {
                let e = view.error_text(view.error(run)?);
                Some(format!("{} {e}", run.model_label()))
            })
            .collect()
    };
    let (fair, fitted) = (of(false).join(", "), of(true).join(", "));
    let kind = match view.kind_of_error() {
        INTEGRATION => "Least error of integration".to_owned(),
        _ => format!("{} of each model", capital(view.metric.words())),
    };
    Some(match (fair.is_empty(), fitted.is_empty()) {
        (true, true) => return None,
        (false, true) => html! { (kind) ": " (fair) "." },
        (true, false) => html! { "What the fits to this history leave: " (fitted) "." },
        (false, false) => html! {
            (kind) " that was not fitted to this history: " (fair) "; what the fits to it leave: " (fitted) "."
        },
    })
}

/// Computes, for every model but the first, the median ratio of its processor time to the first model's, over the runs
/// at the same method and step that did not fail.
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
                    let ratio = run.cost_s() / counterpart.cost_s();
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
