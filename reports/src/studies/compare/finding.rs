//! The finding: two sentences in plain words, computed from the record.

use crate::markup::sentences;
use crate::numbers::{quantity, short, significant};
use crate::record::Run;
use crate::view::{View, resolution};
use maud::{Markup, html};

/// The two sentences.
pub fn finding(view: &View<'_>) -> Markup {
    sentences([first(view), second(view)])
}

fn named(run: &Run) -> Markup {
    let at = resolution(run);
    html! {
        b { (run.model_label()) } " under " b { (run.integrator) }
        @if !at.is_empty() { " (" (at) ")" }
    }
}

fn cheapest<'a>(runs: impl Iterator<Item = &'a Run>) -> Option<&'a Run> {
    runs.filter(|r| r.wall_s.is_finite())
        .min_by(|a, b| a.wall_s.total_cmp(&b.wall_s))
}

fn first(view: &View<'_>) -> Markup {
    let runs = &view.results.runs;
    if runs.is_empty() {
        return html! { "The record holds no runs." };
    }
    if runs.iter().all(|r| r.status.is_failure()) {
        return html! { "None of the " (runs.len()) " runs reached a usable end." };
    }
    let adequate = cheapest(runs.iter().filter(|r| view.adequate(r)));
    let time = |r: &Run| quantity(r.wall_s, "s", 3);
    let Some(tolerance) = &view.results.tolerance else {
        return match adequate {
            Some(run) => html! {
                "The cheapest run that converged is " (named(run)) ", in " (time(run)) "."
            },
            None => html! { "No run converged." },
        };
    };
    let limit = match view.metric.unit() {
        "" => format!("{}\u{a0}%", short(100.0 * tolerance.limit, 3)),
        _ => view.error_text(tolerance.limit),
    };
    let metric = tolerance.metric.words();
    let article = if metric.starts_with(['a', 'e', 'i', 'o', 'u']) {
        "an"
    } else {
        "a"
    };
    let asked = format!(
        "{article} {metric} of at most {limit} against {}",
        view.reference_name(&tolerance.against),
    );
    let error = |r: &Run| view.error(r).map_or(String::new(), |e| view.error_text(e));
    if let Some(run) = adequate {
        return html! {
            "The cheapest run that meets the scene's tolerance, " (asked) ", is " (named(run)) ": " (error(run)) " in "
            (time(run)) "."
        };
    }
    let closest = (runs.iter().filter(|r| !r.status.is_failure()))
        .filter_map(|r| Some((r, view.error(r)?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    match closest {
        Some((run, _)) => html! {
            "No run meets the scene's tolerance, " (asked) "; closest comes " (named(run)) " with " (error(run)) "."
        },
        None => html! { "No run could be held against the scene's tolerance, " (asked) "." },
    }
}

fn second(view: &View<'_>) -> Markup {
    let failed = (view.results.runs.iter()).filter(|r| r.status.is_failure());
    let total = view.results.runs.len();
    let failures = match failed.count() {
        0 if total == 1 => "the run did not fail".to_owned(),
        0 => format!("none of the {total} runs failed"),
        1 => format!("one of {total} runs failed and is shown as a failure"),
        n => format!("{n} of {total} runs failed and are shown as failures"),
    };
    let best: Vec<String> = (view.groups.iter())
        .filter_map(|g| {
            let (_, run) = view.best(g)?;
            let e = view.error_text(view.error(run)?);
            Some(format!("{} {e} ({})", g.label, run.integrator))
        })
        .collect();
    if best.is_empty() {
        return html! { (crate::view::capital(&failures)) "." };
    }
    let ratio = match costs(view).as_slice() {
        [(label, ratio), ..] => format!(
            "; {label} costs {} times as much as {} at the same method and step",
            significant(*ratio, 2),
            view.groups[0].label
        ),
        [] => String::new(),
    };
    let kind = match view.against.as_deref() {
        Some("self") => "integration error",
        _ => "error",
    };
    html! { "Least " (kind) " per model: " (best.join(", ")) (ratio) "; " (failures) "." }
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
