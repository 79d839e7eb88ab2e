//! Finding and tables of a study of accuracy against cost.

use super::pareto::cheapest;
use super::{Cost, LEVELS, Precision, WorkPrecision, WorkPrecisionPoint, family, modes_and_step};
use crate::markup::table::Table;
use crate::markup::{failed_of, note, runs as common, section};
use crate::numbers::{self, count, counted, per_cent, quantity};
use crate::record::{Run, SELF, Status};
use crate::view::{View, capital, resolution};
use maud::{Markup, html};

/// The limits that the finding names; the table has all.
const NAMED: [f64; 2] = [LEVELS[0], LEVELS[2]];

/// Returns the finding: the cheapest run against the first reference, the effect of fits, and failures.
pub fn finding(view: &View<'_>) -> Vec<Markup> {
    let study = Precision::of(view.results);
    let clouds = clouds(&study);
    let failed = html! { (capital(&failed_of(view.results))) "." };
    let Some(cloud) = clouds.first() else {
        return vec![
            html! {
                "No run is compared with a reference: the charts show the error of integration, against each model's own converged \
                 solution."
            },
            failed,
        ];
    };
    let within: Vec<Markup> = (NAMED.iter())
        .map(|limit| {
            let text = numbers::limit(*limit);
            match cloud.cheapest(*limit, |s| !s.is_fitted()) {
                Some(s) => html! {
                    "within " (text) " " b { (s.run.model_label()) } " under " (s.run.integrator) " ("
                    (modes_and_step(s.run)) ", " (quantity(s.run.cost_s(), "s", 2)) ")"
                },
                None => html! { "within " (text) " nothing" },
            }
        })
        .collect();
    let mut sentences = vec![html! {
        "Cheapest against " b { (view.reference_name(&cloud.against)) } " by " (study.headline().words())
        @if cloud.has_fitted() { ", among what was not fitted to it" }
        ": " @for (i, text) in within.iter().enumerate() { @if i > 0 { "; " } (text) } "."
    }];
    sentences.extend(fits(cloud));
    let others = clouds.len() - 1;
    sentences.push(if others > 0 {
        html! {
            "Other limits and " (counted(others, "reference", "references")) " more stand in the tables; "
            (failed_of(view.results)) "."
        }
    } else {
        failed
    });
    sentences
}

/// Returns the points against every reference that has any.
fn clouds<'a>(study: &Precision<'a>) -> Vec<WorkPrecision<'a>> {
    let metric = study.headline();
    let all = (study.references.iter()).map(|id| study.cloud(id, metric, Cost::Processor));
    all.filter(|c| !c.shown.is_empty()).collect()
}

/// Returns the sentence on models that were fitted to this very history; `None` when the front has none.
fn fits(cloud: &WorkPrecision<'_>) -> Option<Markup> {
    let all = cloud.stretches(WorkPrecisionPoint::is_fitted);
    let least = (all.iter().map(|s| s.1)).min_by(f64::total_cmp)?;
    let mut models: Vec<String> = all.iter().map(|(s, _)| s.run.model_label()).collect();
    models.sort();
    models.dedup();
    let cheap = cloud.stretches(|_| true).iter().any(|(s, _)| s.is_fitted());
    Some(html! {
        (capital(&models.join(" and "))) @if models.len() > 1 { " were" } @else { " was" } " fitted to this very history: down to " (per_cent(least, 3))
        @if cheap { " that costs less, but is the rest of a fit, not a prediction." }
        @else { " is the rest of a fit, not a prediction, and it is not even cheaper." }
    })
}

/// Returns the tables of fronts, of the cheapest families, and of the cost of each model within limits of the error.
pub fn tables(view: &View<'_>) -> Markup {
    let study = Precision::of(view.results);
    let metric = study.headline();
    html! {
        @for cloud in &clouds(&study) {
            @let reference = &cloud.against;
            section.glance {
                h2 { "Cheapest run of each model against " (reference) }
                (within(&study, cloud))
                p.note {
                    "Reference: " (view.reference_name(reference)) ". Least processor time among the runs within the limit of the " (metric.words()) "; a dash: no run is within it."
                    @if cloud.has_fitted() {
                        " A model that was fitted to this very history is not predicted by it: its error is the rest of the fit."
                    }
                }
            }
            (leaders(cloud))
            section {
                h2 { "Pareto front against " (reference) }
                (front(cloud))
                p.note {
                    "Runs that no other beats in processor time and in " (metric.words()) " at once"
                    @if cloud.has_fitted() {
                        ", fitted models included; a check stands where a run is on the front of the models that were not \
                         fitted to this history"
                    }
                    "."
                }
            }
        }
    }
}

/// Returns the table of the cheapest run with residual compliance compared with its next rivals, limit by limit.
fn leaders(cloud: &WorkPrecision<'_>) -> Markup {
    let of = |fitted_too: bool| {
        let all = LEVELS
            .iter()
            .filter_map(move |l| cloud.cheapest_runs(*l, fitted_too));
        all.map(move |s| (s, fitted_too)).collect::<Vec<_>>()
    };
    let mut rows = of(false);
    // Rows with fitted models are added only where a fit changes the result.
    let fits = of(true).into_iter();
    rows.extend(fits.filter(|(s, _)| s.next.is_some_and(|(rival, _)| rival.is_fitted())));
    if rows.is_empty() {
        return Markup::default();
    }
    let table = Table::of(&rows)
        .text("Within", |(s, _)| s.level())
        .text("Among", |(_, fitted_too)| {
            let all = if *fitted_too {
                "fits included"
            } else {
                "nothing fitted"
            };
            cloud.has_fitted().then(|| all.to_string())
        })
        .key()
        .text("Cheapest with residual compliance", |(s, _)| s.own())
        .result()
        .text("Beside the next model and integrator", |(s, _)| {
            s.next_clause()
        })
        .result()
        .text("Beside the next other model", |(s, _)| s.other_clause())
        .result();
    section(
        &format!("Residual compliance against {}", cloud.against),
        table,
    )
}

fn front(cloud: &WorkPrecision<'_>) -> Markup {
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
        .key()
        .text("Resolution", |i| modes_and_step(run(i)))
        .key()
        .percents("Error", 3, |i| cloud.shown[*i].point.error)
        .result()
        // From microseconds to seconds: each time with its own prefix.
        .written("Processor time", "", |i| quantity(run(i).cost_s(), "s", 3))
        .result()
        .text("Fitted to", |i| run(i).fitted_to.clone())
        .result()
        .text("Front, nothing fitted", |i| {
            (cloud.has_fitted() && fair.contains(i)).then(|| "\u{2713}".to_owned())
        })
        .result()
        .written("Wall time, least \u{2013} greatest", "", |i| {
            let [low, high] = run(i).wall_spread_s?.map(|t| quantity(t, "s", 3));
            Some(format!("{low} \u{2013} {high}"))
        })
        .written("Steps", "", |i| count(run(i).steps))
        .written("Force evaluations", "", |i| count(run(i).force_evaluations))
        .written("Factorisations", "", |i| count(run(i).factorisations));
    html! { (table) }
}

fn within(study: &Precision<'_>, cloud: &WorkPrecision<'_>) -> Markup {
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
        let heading = format!("Within {}", numbers::limit(limit));
        table = table.text(&heading, |m| {
            let kept: Vec<&WorkPrecisionPoint<'_>> = of(*m).collect();
            let points: Vec<_> = kept.iter().map(|s| s.point).collect();
            let run = kept[cheapest(&points, limit)?].run;
            let time = quantity(run.cost_s(), "s", 2);
            Some(format!(
                "{time} ({}, {})",
                run.integrator,
                modes_and_step(run)
            ))
        });
        table = table.result();
    }
    let table = table.written("Least error", "", |m| {
        let best = of(*m).map(|s| s.point.error).min_by(f64::total_cmp);
        best.map(|e| per_cent(e, 3))
    });
    html! { (table.result()) }
}

/// Returns the table of all runs and the number of failures by reason.
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
        .key()
        .text("Step", |(r, ..)| resolution(r))
        .key()
        .text("Status", |(r, ..)| r.status.to_string());
    for id in study.references.iter().map(String::as_str).chain([SELF]) {
        let metric = study.headline_against(id);
        let heading = match id {
            SELF => "Integration error".into(),
            id => format!("Error against {}", view.reference_name(id)),
        };
        table = table.percents(&heading, 3, |(r, ..)| {
            let error = r.against(id)?.get(metric).map(f64::abs);
            error.filter(|_| !r.status.is_failure())
        });
        table = table.result();
    }
    let table = table
        .numbers("Processor time", "s", 3, |(r, ..)| r.cost_s())
        .result()
        .ranges("Wall time, least \u{2013} greatest", "s", 3, |(r, ..)| {
            r.wall_spread_s
        })
        .written("Steps", "", |(r, ..)| count(r.steps))
        .written("Force evaluations", "", |(r, ..)| {
            count(r.force_evaluations)
        })
        .written("Factorisations", "", |(r, ..)| count(r.factorisations));
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

/// Returns the table of failures by family and reason.
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
        .text("Model and integrator", |f| f.0.clone())
        .text("Reason", |f| f.1.to_string())
        .result()
        .written("Runs", "", |f| count(f.2.len() as u64))
        .result()
        .text("At", |f| {
            let all: Vec<String> = f.2.iter().map(|r| modes_and_step(r)).collect();
            all.join("; ")
        })
        .text("Such as", |f| f.2[0].message.clone());
    section("Failures", table)
}
