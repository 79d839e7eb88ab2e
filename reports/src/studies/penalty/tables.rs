//! Finding and table of a study of penalties.

use super::charts::{Series, series};
use crate::markup::table::Table;
use crate::markup::{glance, note, sentences};
use crate::numbers::{percent, power};
use crate::record::Run;
use crate::view::View;
use maud::{Markup, html};

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

pub fn finding(view: &View<'_>) -> Markup {
    let mut text = Vec::new();
    for s in &series(view) {
        let label = html! { b { (s.label) } };
        let Some(hard) = s.hard else {
            text.push(html! { (label) " has no run with hard contact to compare with." });
            continue;
        };
        let Some((at, last)) = (s.soft.iter().rev()).find(|(_, r)| !r.status.is_failure()) else {
            text.push(html! { "No run of " (label) " with a penalty ended well." });
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
        text.push(html! {
            "With a penalty of " (power(*at, 1)) " Pa/m " (label) " differs from hard contact in " (parts.join(", ")) "."
        });
        let enough = [
            ("the force", enough(s, peak)),
            ("the transmission error", enough(s, still)),
        ];
        let from: Vec<String> = (enough.into_iter())
            .filter_map(|(name, p)| Some(format!("{name} from {} Pa/m on", power(p?, 1))))
            .collect();
        if !from.is_empty() {
            text.push(html! { "Within 1\u{a0}% are " (from.join(" and ")) "." });
        }
    }
    if text.is_empty() {
        text.push(html! { "The record holds no run with a penalty." });
    }
    sentences(text)
}

/// All penalties with their outputs and distances.
pub fn tables(view: &View<'_>) -> Markup {
    let all = series(view);
    let rows: Vec<(&Series<'_>, &Run)> = (all.iter())
        .flat_map(|s| {
            let soft = s.soft.iter().map(move |(_, r)| (s, *r));
            soft.chain(s.hard.map(|r| (s, r)))
        })
        .collect();
    if rows.is_empty() {
        return Markup::default();
    }
    type Get = fn(&Run) -> Option<f64>;
    type Row<'a> = (&'a Series<'a>, &'a Run);
    let get = |f: Get| move |(_, r): &Row<'_>| f(r).filter(|_| !r.status.is_failure());
    let off = |f: Get| {
        move |(s, r): &Row<'_>| {
            let soft = !r.status.is_failure() && r.hard != Some(true);
            Some(f(r).filter(|_| soft)? / f(s.hard?)? - 1.0)
        }
    };
    let table = Table::of(&rows)
        .grouped(|(s, _)| (s.label.clone(), s.style))
        .classed(|(_, r)| if r.status.is_failure() { "failed" } else { "" })
        .written("Penalty", "Pa/m", |(_, r)| {
            (r.penalty_pa_per_m).map_or_else(|| "hard".into(), |p| power(p, 2))
        })
        .text("Status", |(_, r)| r.status.to_string())
        .numbers("Peak force", "N", 5, get(peak))
        .deviations("off", off(peak))
        .numbers("Impulse", "N s", 5, get(impulse))
        .deviations("off", off(impulse))
        .numbers("Static TE, mean", "m", 5, get(still))
        .deviations("off", off(still));
    let remark = "off: deviation from hard contact. TE: transmission error at rest under the load of the settings.";
    glance("By penalty", html! { (table) (note(remark)) })
}
