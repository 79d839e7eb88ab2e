//! Finding and table of a study of penalties.

use super::charts::{Series, series};
use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{percent, power};
use crate::record::Run;
use crate::view::View;

fn impulse(r: &Run) -> Option<f64> {
    r.metrics.first()?.impulse_ns
}

fn peak(r: &Run) -> Option<f64> {
    r.metrics.first()?.peak_force_n
}

fn still(r: &Run) -> Option<f64> {
    r.static_error_m
}

/// The least penalty from which on a quantity stays within 1 % of hard contact.
fn enough(s: &Series<'_>, get: fn(&Run) -> Option<f64>) -> Option<f64> {
    let limit = get(s.hard?)?;
    let mut found = None;
    let ended = s.soft.iter().rev().filter(|(_, r)| !r.status.is_failure());
    for (p, r) in ended {
        let near = |x: f64| (x / limit - 1.0).abs() <= 0.01;
        if !get(r).is_some_and(near) {
            break;
        }
        found = Some(*p);
    }
    found
}

/// The finding, as HTML.
pub fn finding(view: &View<'_>) -> String {
    let mut sentences = Vec::new();
    for s in &series(view) {
        let label = escape(&s.label);
        let Some(hard) = s.hard else {
            sentences.push(format!(
                "<b>{label}</b> has no run with hard contact to compare with."
            ));
            continue;
        };
        let Some((last, at)) = s
            .soft
            .iter()
            .rev()
            .find(|(_, r)| !r.status.is_failure())
            .map(|(p, r)| (*r, *p))
        else {
            sentences.push(format!(
                "No run of <b>{label}</b> with a penalty ended well."
            ));
            continue;
        };
        let off = |get: fn(&Run) -> Option<f64>| {
            let (a, b) = (get(last)?, get(hard)?);
            Some(format!("{}\u{a0}%", percent((a / b - 1.0).abs(), 2)))
        };
        let named = [
            ("peak force", off(peak)),
            ("impulse", off(impulse)),
            ("static transmission error", off(still)),
        ];
        let parts: Vec<String> = (named.into_iter())
            .filter_map(|(name, off)| Some(format!("{name} by {}", off?)))
            .collect();
        sentences.push(format!(
            "With a penalty of {} Pa/m <b>{label}</b> differs from hard contact in {}.",
            power(at, 1),
            parts.join(", ")
        ));
        let from: Vec<String> = [
            ("the force", enough(s, peak)),
            ("the transmission error", enough(s, still)),
        ]
        .into_iter()
        .filter_map(|(name, p)| Some(format!("{name} from {} Pa/m on", power(p?, 1))))
        .collect();
        if !from.is_empty() {
            sentences.push(format!("Within 1\u{a0}% are {}.", from.join(" and ")));
        }
    }
    if sentences.is_empty() {
        return "The record holds no run with a penalty.".into();
    }
    sentences.join(" ")
}

/// All penalties with their outputs and distances.
pub fn tables(view: &View<'_>) -> String {
    let all = series(view);
    let rows: Vec<(&Series<'_>, &Run)> = (all.iter())
        .flat_map(|s| {
            let soft = s.soft.iter().map(move |(_, r)| (s, *r));
            soft.chain(s.hard.map(|r| (s, r)))
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let get = |f: fn(&Run) -> Option<f64>| -> Vec<Option<f64>> {
        rows.iter()
            .map(|(_, r)| f(r).filter(|_| !r.status.is_failure()))
            .collect()
    };
    let off = |f: fn(&Run) -> Option<f64>| -> Vec<Option<f64>> {
        rows.iter()
            .map(|(s, r)| {
                let soft = !r.status.is_failure() && r.hard != Some(true);
                Some(f(r).filter(|_| soft)? / f(s.hard?)? - 1.0)
            })
            .collect()
    };
    let name = |r: &Run| match r.penalty_pa_per_m {
        Some(p) => power(p, 2),
        None => "hard".into(),
    };
    let columns = [
        Column::written(
            "Penalty",
            "Pa/m",
            rows.iter().map(|(_, r)| Some(name(r))).collect(),
        ),
        Column::text(
            "Status",
            rows.iter()
                .map(|(_, r)| Some(r.status.to_string()))
                .collect(),
        ),
        Column::numbers("Peak force", "N", 5, &get(peak)),
        Column::deviations("off", &off(peak)),
        Column::numbers("Impulse", "N s", 5, &get(impulse)),
        Column::deviations("off", &off(impulse)),
        Column::numbers("Static TE, mean", "m", 5, &get(still)),
        Column::deviations("off", &off(still)),
    ];
    let groups: Vec<Rows> = (all.iter())
        .map(|s| Rows {
            heading: Some((s.label.clone(), s.style)),
            count: s.soft.len() + usize::from(s.hard.is_some()),
            classes: (s.soft.iter())
                .map(|(_, r)| if r.status.is_failure() { "failed" } else { "" })
                .collect(),
        })
        .collect();
    format!(
        "<section class=\"glance\">\n<h2>By penalty</h2>\n{}<p class=\"note\">off: deviation from hard contact. TE: \
         transmission error at rest under the load of the settings.</p>\n</section>\n",
        table(&columns, &groups)
    )
}
