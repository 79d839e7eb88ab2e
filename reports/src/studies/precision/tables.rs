//! Finding and tables of a study of accuracy against cost.

use super::pareto::cheapest;
use super::{Cloud, Cost, LEVELS, Precision, Shown, family, is_ours, modes_and_step};
use crate::markup::table::Table;
use crate::markup::{note, runs as common, section};
use crate::numbers::{count, percent, quantity, short};
use crate::record::{Run, SELF, Status};
use crate::view::{View, capital, resolution};
use maud::{Markup, html};

/// The error from which on the lead is asked about.
const ASKED: f64 = LEVELS[0];

fn level(x: f64) -> String {
    format!("{}\u{a0}%", short(100.0 * x, 2))
}

fn three(x: f64) -> String {
    format!("{}\u{a0}%", percent(x, 3))
}

/// The finding, a paragraph each.
pub fn finding(view: &View<'_>) -> Vec<Markup> {
    let study = Precision::of(view.results);
    let metric = study.headline();
    let mut paragraphs = Vec::new();
    for id in &study.references {
        let cloud = study.cloud(id, metric, Cost::Wall);
        if cloud.shown.is_empty() {
            continue;
        }
        paragraphs.push(html! {
            b { "Against " (view.reference_name(id)) } " (" (metric.words())
            @if cloud.has_fitted() { ", nothing fitted" }
            "): " (stretches(&cloud)) " " (lead(&cloud)) (fits(&cloud))
        });
    }
    if paragraphs.is_empty() {
        paragraphs.push(html! {
            "No run is held against a reference: the charts show what integrators lose against each model's own converged \
             solution."
        });
    }
    let all = view.results.runs.len();
    let failed = (view.results.runs.iter()).filter(|r| r.status.is_failure());
    paragraphs.push(match failed.count() {
        0 => html! { "None of the " (all) " runs failed." },
        n => html! { (n) " of " (all) " runs failed; each stands with its reason." },
    });
    paragraphs
}

/// What a stretch of the front is called.
fn name(cloud: &Cloud<'_>, s: &Shown<'_>) -> String {
    let ours = cloud.ours().filter(|_| is_ours(s.run));
    ours.unwrap_or_else(|| family(s.run))
}

/// Who is on the front at which errors, among what was not fitted.
fn stretches(cloud: &Cloud<'_>) -> String {
    let all = cloud.stretches(|s| !s.is_fitted());
    let text: Vec<String> = (all.iter())
        .map(|(s, least)| match s.point.error {
            first if first == *least => format!("{} at {}", name(cloud, s), three(*least)),
            first => format!(
                "{} from {} to {}",
                name(cloud, s),
                percent(first, 3),
                three(*least)
            ),
        })
        .collect();
    format!(
        "on the front are, from cheap to accurate, {}.",
        text.join("; ")
    )
}

/// How far ours hold the front, and by how much they lead.
fn lead(cloud: &Cloud<'_>) -> Markup {
    let Some(ours) = cloud.ours().map(|name| capital(&name)) else {
        return Markup::default();
    };
    let Some((least, cheaper)) = cloud.held(false) else {
        return html! { (ours) " are not on it." };
    };
    let down = format!("down to {}", three(least));
    let range = match cheaper {
        Some(x) if x > ASKED => format!("for every error below {}, {down}", level(ASKED)),
        Some(x) => format!("for errors below {}, {down}", three(x)),
        None => format!("for every error {down}"),
    };
    let lines: Vec<Markup> = (LEVELS.iter())
        .filter_map(|l| cloud.standing(*l, false))
        .map(|s| {
            let same = |other: &Run| s.next.is_some_and(|(n, _)| std::ptr::eq(n.run, other));
            let more = match s.other {
                Some((other, _)) if s.next.is_some() && !same(other.run) => {
                    format!(" and {}", s.beside_other())
                }
                None if s.next.is_some() => "; no other model gets there".into(),
                _ => String::new(),
            };
            html! { (s.level()) ": " b { (s.own()) } ", " (s.beside_next()) (more) }
        })
        .collect();
    html! {
        b { (ours) " hold the front " (range) "." }
        @if !lines.is_empty() {
            " Cheapest within a limit: "
            @for (i, line) in lines.iter().enumerate() { @if i > 0 { "; " } (line) }
            "."
        }
    }
}

/// What models that were fitted to this very history change.
fn fits(cloud: &Cloud<'_>) -> String {
    if !cloud.has_fitted() {
        return String::new();
    }
    let all = cloud.stretches(|_| true);
    let fitted: Vec<String> = (all.iter().filter(|(s, _)| s.is_fitted()))
        .map(|(s, least)| format!("{} to {}", family(s.run), three(*least)))
        .collect();
    if fitted.is_empty() {
        return " Models fitted to this very history are not on the front.".into();
    }
    let over = match cloud.held(true) {
        Some((_, Some(x))) if cloud.ours().is_some() => {
            format!("; residual compliance takes over below {}", three(x))
        }
        _ => String::new(),
    };
    format!(
        " Models fitted to this very history are cheaper as far as their fit goes: {}{over}.",
        fitted.join(", ")
    )
}

/// Fronts, and what each model costs within limits of the error.
pub fn tables(view: &View<'_>) -> Markup {
    let study = Precision::of(view.results);
    let metric = study.headline();
    let clouds = (study.references.iter()).map(|id| study.cloud(id, metric, Cost::Wall));
    html! {
        @for cloud in clouds.filter(|c| !c.shown.is_empty()) {
            @let reference = view.reference_name(&cloud.against);
            section.glance {
                h2 { "Pareto front against " (reference) }
                (front(&cloud))
                p.note {
                    "Runs that no other beats in wall time and in " (metric.words()) " at once"
                    @if cloud.has_fitted() {
                        ", fitted models included; a check stands where a run is on the front of the models that were not \
                         fitted to this history"
                    }
                    "."
                }
            }
            section.glance {
                h2 { "Cheapest run of each model against " (reference) }
                (within(&study, &cloud))
                p.note {
                    "Least wall time among the runs within the limit of the " (metric.words()) "; a dash: none gets there."
                }
            }
        }
    }
}

fn front(cloud: &Cloud<'_>) -> Markup {
    let fair = cloud.front(|s| !s.is_fitted());
    let mut all = cloud.front(|_| true);
    all.extend(&fair);
    all.sort_unstable();
    all.dedup();
    let cost = |i: &usize| cloud.shown[*i].point.cost;
    all.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    let run = |i: &usize| cloud.shown[*i].run;
    let table = Table::of(&all)
        .text("Model", |i| run(i).model_label())
        .text("Integrator", |i| run(i).integrator.clone())
        .text("Resolution", |i| modes_and_step(run(i)))
        .percents("Error", 3, |i| cloud.shown[*i].point.error)
        // From microseconds to seconds: each time with its own prefix.
        .written("Wall time", "", |i| quantity(run(i).wall_s, "s", 3))
        .written("min \u{2013} max", "", |i| {
            let [low, high] = run(i).wall_spread_s?.map(|t| quantity(t, "s", 3));
            Some(format!("{low} \u{2013} {high}"))
        })
        .written("Steps", "", |i| count(run(i).steps))
        .written("Force evals", "", |i| count(run(i).force_evaluations))
        .written("Factoris.", "", |i| count(run(i).factorisations))
        .text("Fitted", |i| run(i).fitted_to.clone())
        .text("Front, nothing fitted", |i| {
            (cloud.has_fitted() && fair.contains(i)).then(|| "\u{2713}".to_owned())
        });
    html! { (table) }
}

fn within(study: &Precision<'_>, cloud: &Cloud<'_>) -> Markup {
    let of = |style: usize| cloud.shown.iter().filter(move |s| s.style == style);
    let models: Vec<usize> = (0..study.models.len())
        .filter(|i| of(*i).next().is_some())
        .collect();
    let mut table = Table::of(&models)
        .text("Model", |m| study.models[*m].clone())
        .text("Fitted to", |m| {
            of(*m).find_map(|s| s.run.fitted_to.clone())
        });
    for limit in LEVELS {
        table = table.text(&format!("\u{2264} {}", level(limit)), |m| {
            let kept: Vec<&Shown<'_>> = of(*m).collect();
            let points: Vec<_> = kept.iter().map(|s| s.point).collect();
            let run = kept[cheapest(&points, limit)?].run;
            let time = quantity(run.wall_s, "s", 2);
            Some(format!(
                "{time} ({}, {})",
                run.integrator,
                modes_and_step(run)
            ))
        });
    }
    let table = table.written("Least error", "", |m| {
        let best = of(*m).map(|s| s.point.error).min_by(f64::total_cmp);
        best.map(three)
    });
    html! { (table) }
}

/// All runs, shortly, and the failures counted.
pub fn runs(view: &View<'_>) -> Markup {
    let study = Precision::of(view.results);
    let metric = study.headline();
    let rows = common::rows(view);
    if rows.is_empty() {
        return Markup::default();
    }
    let mut table = Table::of(&rows)
        .grouped(|(_, label, style)| ((*label).into(), *style))
        .classed(|(r, ..)| if r.status.is_failure() { "failed" } else { "" })
        .text("Integrator", |(r, ..)| r.integrator.clone())
        .written("Modes", "", |(r, ..)| common::modes(r))
        .text("Step", |(r, ..)| resolution(r))
        .text("Status", |(r, ..)| r.status.to_string());
    for id in study.references.iter().map(String::as_str).chain([SELF]) {
        let metric = study.headline_against(id);
        let heading = match id {
            SELF => "Integration error".into(),
            id => format!("Error, {id}"),
        };
        table = table.percents(&heading, 3, |(r, ..)| {
            let error = r.against(id)?.get(metric).map(f64::abs);
            error.filter(|_| !r.status.is_failure())
        });
    }
    let table = table
        .numbers("Wall time", "s", 3, |(r, ..)| r.wall_s)
        .ranges("min \u{2013} max", "s", 3, |(r, ..)| r.wall_spread_s)
        .written("Steps", "", |(r, ..)| count(r.steps))
        .written("Force evals", "", |(r, ..)| count(r.force_evaluations))
        .written("Factoris.", "", |(r, ..)| count(r.factorisations));
    let remark = format!(
        "Errors: {}; of the integration, {}. precision.csv has every metric and the spread of the times.",
        metric.words(),
        study.headline_against(SELF).words()
    );
    html! {
        (section("All runs", html! { (table) (note(remark)) }))
        (failures(rows.iter().map(|(r, ..)| *r)))
    }
}

/// Failures by family and reason.
fn failures<'a>(runs: impl Iterator<Item = &'a Run>) -> Markup {
    let mut found: Vec<(String, Status, Vec<&Run>)> = Vec::new();
    for r in runs.filter(|r| r.status.is_failure()) {
        let name = family(r);
        match found.iter_mut().find(|f| f.0 == name && f.1 == r.status) {
            Some(f) => f.2.push(r),
            None => found.push((name, r.status, vec![r])),
        }
    }
    if found.is_empty() {
        return section("Failures", html! { p { "Every run reached its end." } });
    }
    let table = Table::of(&found)
        .text("Family", |f| f.0.clone())
        .text("Reason", |f| f.1.to_string())
        .written("Runs", "", |f| count(f.2.len() as u64))
        .text("At", |f| {
            let all: Vec<String> = f.2.iter().map(|r| modes_and_step(r)).collect();
            all.join("; ")
        })
        .text("Such as", |f| f.2[0].message.clone());
    section("Failures", table)
}
