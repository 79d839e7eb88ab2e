//! Finding and tables of a study of accuracy against cost.

use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{count, percent, quantity, short};
use crate::record::{Run, Status};
use crate::studies::precision::pareto::cheapest;
use crate::studies::precision::{
    Cloud, Cost, LEVELS, Precision, SELF, Shown, family, is_ours, rung,
};
use crate::view::{View, resolution};

/// The error from which on the lead is asked about.
const ASKED: f64 = LEVELS[0];

fn level(x: f64) -> String {
    format!("{}\u{a0}%", short(100.0 * x, 2))
}

/// The finding, as HTML.
pub fn finding(view: &View<'_>) -> String {
    let told = Precision::of(view.results);
    let metric = told.headline();
    let mut parts: Vec<String> = Vec::new();
    for id in &told.references {
        let cloud = told.cloud(id, metric, Cost::Wall);
        if cloud.shown.is_empty() {
            continue;
        }
        let which = if cloud.has_fitted() {
            ", nothing fitted"
        } else {
            ""
        };
        parts.push(format!(
            "<b>Against {}</b> ({}{which}): {} {}{}",
            escape(&view.reference_name(id)),
            metric.words(),
            stretches(&cloud),
            lead(&cloud),
            fits(&cloud)
        ));
    }
    if parts.is_empty() {
        parts.push(
            "No run is held against a reference: the charts show what integrators lose against each model's own \
             converged solution."
                .into(),
        );
    }
    let all = view.results.runs.len();
    let failed = (view.results.runs.iter()).filter(|r| r.status.is_failure());
    parts.push(match failed.count() {
        0 => format!("None of the {all} runs failed."),
        n => format!("{n} of {all} runs failed; each stands with its reason."),
    });
    parts.join("</p>\n<p>")
}

/// What a stretch of the front is called.
fn name(s: &Shown<'_>) -> String {
    if is_ours(s.run) {
        "elastic gears with residual compliance under trigonometric".into()
    } else {
        escape(&family(s.run))
    }
}

/// Who is on the front at which errors, among what was not fitted.
fn stretches(cloud: &Cloud<'_>) -> String {
    let all = cloud.stretches(|s| !s.is_fitted());
    let text: Vec<String> = all
        .iter()
        .map(|(s, least)| {
            let at = |x: f64| percent(x, 3);
            if s.point.error == *least {
                format!("{} at {}\u{a0}%", name(s), at(*least))
            } else {
                format!(
                    "{} from {} to {}\u{a0}%",
                    name(s),
                    at(s.point.error),
                    at(*least)
                )
            }
        })
        .collect();
    format!(
        "on the front are, from cheap to accurate, {}.",
        text.join("; ")
    )
}

/// How far ours hold the front, and by how much they lead.
fn lead(cloud: &Cloud<'_>) -> String {
    if !cloud.has_ours() {
        return String::new();
    }
    let Some((least, cheaper)) = cloud.held(false) else {
        return "Elastic gears with residual compliance under the trigonometric method are not on it.".into();
    };
    let down = format!("down to {}\u{a0}%", percent(least, 3));
    let reach = match cheaper {
        Some(x) if x > ASKED => format!("for every error below {}, {down}", level(ASKED)),
        Some(x) => format!("for errors below {}\u{a0}%, {down}", percent(x, 3)),
        None => format!("for every error {down}"),
    };
    let lines: Vec<String> = (LEVELS.iter())
        .filter_map(|l| cloud.standing(*l, false))
        .map(|s| {
            let next = format!(
                "{}: <b>{}</b>, {}",
                s.level(),
                escape(&s.own()),
                escape(&s.beside_next())
            );
            match s.other {
                Some((other, _))
                    if s.next.is_some_and(|(n, _)| !std::ptr::eq(n.run, other.run)) =>
                {
                    format!("{next} and {}", escape(&s.beside_other()))
                }
                None if s.next.is_some() => format!("{next}; no other model gets there"),
                _ => next,
            }
        })
        .collect();
    let cheapest = if lines.is_empty() {
        String::new()
    } else {
        format!(" Cheapest within a limit: {}.", lines.join("; "))
    };
    format!(
        "<b>Elastic gears with residual compliance under the trigonometric method hold the front {reach}.</b>{cheapest}"
    )
}

/// What models that were fitted to this very history change.
fn fits(cloud: &Cloud<'_>) -> String {
    if !cloud.has_fitted() {
        return String::new();
    }
    let all = cloud.stretches(|_| true);
    let fitted: Vec<String> = (all.iter().filter(|(s, _)| s.is_fitted()))
        .map(|(s, least)| {
            format!(
                "{} to {}\u{a0}%",
                escape(&family(s.run)),
                percent(*least, 3)
            )
        })
        .collect();
    if fitted.is_empty() {
        return " Models fitted to this very history are not on the front.".into();
    }
    let over = match cloud.held(true) {
        Some((_, Some(x))) if cloud.has_ours() => {
            format!("; elastic gears take over below {}\u{a0}%", percent(x, 3))
        }
        _ => String::new(),
    };
    format!(
        " Models fitted to this very history are cheaper as far as their fit reaches: {}{over}.",
        fitted.join(", ")
    )
}

fn plain(n: usize) -> [Rows; 1] {
    [Rows {
        heading: None,
        count: n,
        classes: Vec::new(),
    }]
}

/// Fronts, and what each model costs within limits of the error.
pub fn tables(view: &View<'_>) -> String {
    let told = Precision::of(view.results);
    let metric = told.headline();
    let mut out = String::new();
    for id in &told.references {
        let cloud = told.cloud(id, metric, Cost::Wall);
        if cloud.shown.is_empty() {
            continue;
        }
        let name = escape(&view.reference_name(id));
        out.push_str(&format!(
            "<section class=\"glance\">\n<h2>Pareto front against {name}</h2>\n{}<p class=\"note\">Runs that no other beats \
             in wall time and in {} at once{}.</p>\n</section>\n",
            front(&cloud),
            metric.words(),
            if cloud.has_fitted() {
                ", fitted models included; a check stands where a run is on the front of the models that were not fitted \
                 to this history"
            } else {
                ""
            },
        ));
        out.push_str(&format!(
            "<section class=\"glance\">\n<h2>Cheapest run of each model against {name}</h2>\n{}<p class=\"note\">Least wall \
             time among the runs within the limit of the {}; a dash: none gets there.</p>\n</section>\n",
            within(&told, &cloud),
            metric.words(),
        ));
    }
    out
}

fn front(cloud: &Cloud<'_>) -> String {
    let fair = cloud.front(|s| !s.is_fitted());
    let mut all = cloud.front(|_| true);
    all.extend(
        fair.iter()
            .filter(|i| !all.contains(i))
            .copied()
            .collect::<Vec<_>>(),
    );
    all.sort_by(|a, b| {
        cloud.shown[*a]
            .point
            .cost
            .total_cmp(&cloud.shown[*b].point.cost)
    });
    let rows: Vec<&Shown<'_>> = all.iter().map(|i| &cloud.shown[*i]).collect();
    let text = |f: &dyn Fn(&Run) -> String| rows.iter().map(|s| Some(f(s.run))).collect::<Vec<_>>();
    let numbers =
        |f: &dyn Fn(&Shown<'_>) -> Option<f64>| rows.iter().map(|s| f(s)).collect::<Vec<_>>();
    let columns = [
        Column::text("Model", text(&Run::model_label)),
        Column::text("Integrator", text(&|r| r.integrator.clone())),
        Column::text("Resolution", text(&rung)),
        Column::percents("Error", 3, &numbers(&|s| Some(s.point.error))),
        // From microseconds to seconds: each time with its own prefix.
        Column::written("Wall time", "", text(&|r| quantity(r.wall_s, "s", 3))),
        Column::written(
            "min \u{2013} max",
            "",
            rows.iter()
                .map(|s| {
                    let [low, high] = s.run.wall_spread_s?;
                    Some(format!(
                        "{} \u{2013} {}",
                        quantity(low, "s", 3),
                        quantity(high, "s", 3)
                    ))
                })
                .collect(),
        ),
        Column::written("Steps", "", text(&|r| count(r.steps))),
        Column::written("Force evals", "", text(&|r| count(r.force_evaluations))),
        Column::written("Factoris.", "", text(&|r| count(r.factorisations))),
        Column::text(
            "Fitted",
            rows.iter().map(|s| s.run.fitted_to.clone()).collect(),
        ),
        Column::text(
            "Front, nothing fitted",
            if cloud.has_fitted() {
                all.iter()
                    .map(|i| fair.contains(i).then(|| "\u{2713}".to_owned()))
                    .collect()
            } else {
                vec![None; all.len()]
            },
        ),
    ];
    table(&columns, &plain(rows.len()))
}

fn within(told: &Precision<'_>, cloud: &Cloud<'_>) -> String {
    let models: Vec<(usize, &String)> = (told.models.iter().enumerate())
        .filter(|(i, _)| cloud.shown.iter().any(|s| s.style == *i))
        .collect();
    let of = |style: usize| cloud.shown.iter().filter(move |s| s.style == style);
    let mut columns = vec![
        Column::text("Model", models.iter().map(|m| Some(m.1.clone())).collect()),
        Column::text(
            "Fitted to",
            models
                .iter()
                .map(|m| of(m.0).find_map(|s| s.run.fitted_to.clone()))
                .collect(),
        ),
    ];
    for limit in LEVELS {
        let cell = |style: usize| {
            let kept: Vec<&Shown<'_>> = of(style).collect();
            let points: Vec<_> = kept.iter().map(|s| s.point).collect();
            let s = kept[cheapest(&points, limit)?];
            Some(format!(
                "{} ({}, {})",
                quantity(s.run.wall_s, "s", 2),
                s.run.integrator,
                rung(s.run)
            ))
        };
        let heading = format!("\u{2264} {}", level(limit));
        columns.push(Column::text(
            &heading,
            models.iter().map(|m| cell(m.0)).collect(),
        ));
    }
    let least = |style: usize| {
        let best = of(style).map(|s| s.point.error).min_by(f64::total_cmp)?;
        Some(format!("{}\u{a0}%", percent(best, 3)))
    };
    columns.push(Column::written(
        "Least error",
        "",
        models.iter().map(|m| least(m.0)).collect(),
    ));
    table(&columns, &plain(models.len()))
}

/// All runs, shortly, and the failures counted.
pub fn runs(view: &View<'_>) -> String {
    let told = Precision::of(view.results);
    let metric = told.headline();
    let rows: Vec<&Run> = view
        .groups
        .iter()
        .flat_map(|g| g.runs.iter().map(|(_, r)| *r))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let groups: Vec<Rows> = (view.groups.iter())
        .map(|g| Rows {
            heading: Some((g.label.clone(), g.style)),
            count: g.runs.len(),
            classes: (g.runs.iter())
                .map(|(_, r)| if r.status.is_failure() { "failed" } else { "" })
                .collect(),
        })
        .collect();
    let text = |f: &dyn Fn(&Run) -> String| {
        rows.iter()
            .map(|r| Some(f(r)).filter(|t| !t.is_empty()))
            .collect::<Vec<_>>()
    };
    let error = |id: &str| -> Vec<Option<f64>> {
        let of = |r: &Run| r.against(id)?.get(metric).map(f64::abs);
        rows.iter()
            .map(|r| of(r).filter(|_| !r.status.is_failure()))
            .collect()
    };
    let mut columns = vec![
        Column::text("Integrator", text(&|r| r.integrator.clone())),
        Column::written(
            "Modes",
            "",
            text(&|r| r.modes.map_or(String::new(), |n| n.to_string())),
        ),
        Column::text("Step", text(&resolution)),
        Column::text("Status", text(&|r| r.status.to_string())),
    ];
    for id in told.references.iter().map(String::as_str).chain([SELF]) {
        let name = if id == SELF {
            "Integration error".into()
        } else {
            format!("Error, {id}")
        };
        columns.push(Column::percents(&name, 3, &error(id)));
    }
    columns.extend([
        Column::numbers(
            "Wall time",
            "s",
            3,
            &rows.iter().map(|r| Some(r.wall_s)).collect::<Vec<_>>(),
        ),
        Column::ranges(
            "min \u{2013} max",
            "s",
            3,
            &rows.iter().map(|r| r.wall_spread_s).collect::<Vec<_>>(),
        ),
        Column::written("Steps", "", text(&|r| count(r.steps))),
        Column::written("Force evals", "", text(&|r| count(r.force_evaluations))),
        Column::written("Factoris.", "", text(&|r| count(r.factorisations))),
    ]);
    format!(
        "<section>\n<h2>All runs</h2>\n{}<p class=\"note\">Errors: {}. precision.csv has every metric and the \
         spread of the times.</p>\n</section>\n{}",
        table(&columns, &groups),
        metric.words(),
        failures(&rows)
    )
}

/// Family, reason, runs.
type Fallen<'a> = (String, Status, Vec<&'a Run>);

/// Failures by family and reason.
fn failures(rows: &[&Run]) -> String {
    let mut found: Vec<Fallen<'_>> = Vec::new();
    for r in rows.iter().filter(|r| r.status.is_failure()) {
        let name = family(r);
        match found.iter_mut().find(|f| f.0 == name && f.1 == r.status) {
            Some(f) => f.2.push(r),
            None => found.push((name, r.status, vec![r])),
        }
    }
    if found.is_empty() {
        return "<section>\n<h2>Failures</h2>\n<p>Every run reached its end.</p>\n</section>\n"
            .into();
    }
    let cells =
        |f: &dyn Fn(&Fallen<'_>) -> String| found.iter().map(|x| Some(f(x))).collect::<Vec<_>>();
    let columns = [
        Column::text("Family", cells(&|f| f.0.clone())),
        Column::text("Reason", cells(&|f| f.1.to_string())),
        Column::written("Runs", "", cells(&|f| count(f.2.len() as u64))),
        Column::text(
            "At",
            cells(&|f| {
                let all: Vec<String> = f.2.iter().map(|r| rung(r)).collect();
                all.join("; ")
            }),
        ),
        Column::text(
            "Such as",
            cells(&|f| f.2[0].message.clone().unwrap_or_default()),
        ),
    ];
    format!(
        "<section>\n<h2>Failures</h2>\n{}</section>\n",
        table(&columns, &plain(found.len()))
    )
}
