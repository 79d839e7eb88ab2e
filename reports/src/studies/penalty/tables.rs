//! Finding and table of a study of penalties.

use super::charts::{Series, series};
use super::csv::columns;
use crate::markup::table::Table;
use crate::markup::{glance, note};
use crate::numbers::{per_cent, power};
use crate::record::Run;
use crate::view::{View, capital};
use maud::{Markup, PreEscaped, html};

fn impulse(r: &Run) -> Option<f64> {
    r.metrics.first()?.impulse_ns
}

fn peak(r: &Run) -> Option<f64> {
    r.metrics.first()?.peak_force_n
}

fn still(r: &Run) -> Option<f64> {
    r.static_error_m
}

/// Returns the least penalty from which on a quantity stays within 1 % of hard contact.
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

pub fn finding(view: &View<'_>) -> Vec<Markup> {
    let (mut off, mut enough_from, mut none) = (Vec::new(), Vec::new(), Vec::new());
    for s in &series(view) {
        let Some(hard) = s.hard else {
            none.push(format!(
                "{} has no run with hard contact to compare with",
                s.label
            ));
            continue;
        };
        let Some((at, last)) = (s.soft.iter().rev()).find(|(_, r)| !r.status.is_failure()) else {
            none.push(format!("no run of {} with a penalty ended well", s.label));
            continue;
        };
        let distance = |get: fn(&Run) -> Option<f64>| {
            let (a, b) = (get(last)?, get(hard)?);
            Some(per_cent((a / b - 1.0).abs(), 2))
        };
        let named = [
            ("peak force", distance(peak)),
            ("impulse", distance(impulse)),
            ("static transmission error", distance(still)),
        ];
        let parts: Vec<String> = (named.into_iter())
            .filter_map(|(name, off)| Some(format!("{name} by {}", off?)))
            .collect();
        let at = power(*at, 1);
        off.push(html! {
            "with a penalty of " (at) " Pa/m " b { (s.label) } " differs from hard contact in " (parts.join(", "))
        });
        let enough = [
            ("the force", enough(s, peak)),
            ("the transmission error", enough(s, still)),
        ];
        let from: Vec<String> = (enough.into_iter())
            .filter_map(|(name, p)| Some(format!("{name} from {} Pa/m on", power(p?, 1))))
            .collect();
        if !from.is_empty() {
            enough_from.push(html! { (from.join(" and ")) " (" (s.label) ")" });
        }
    }
    let sentence = |head: &str, parts: &[Markup]| {
        let parts: Vec<&str> = parts.iter().map(|p| p.0.as_str()).collect();
        (!parts.is_empty()).then(|| PreEscaped(capital(&format!("{head}{}.", parts.join("; ")))))
    };
    let none: Vec<Markup> = none.iter().map(|text| html! { (text) }).collect();
    let all = [
        sentence("", &off),
        sentence("Within 1\u{a0}% are ", &enough_from),
        sentence("", &none),
    ];
    let all: Vec<Markup> = all.into_iter().flatten().collect();
    if all.is_empty() {
        return vec![html! { "The record holds no run with a penalty." }];
    }
    all
}

/// Returns the table of all penalties with forces, impulses and distances.
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
    type Field = fn(&Run) -> Option<f64>;
    type Row<'a> = (&'a Series<'a>, &'a Run);
    let columns = columns();
    fn ended<'a>((_, r): &Row<'a>) -> Option<&'a Run> {
        (!r.status.is_failure()).then_some(r)
    }
    let off = |f: Field| {
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
        .columns_by_key(&columns, &["status"], |(_, r)| Some(*r))
        .columns_by_key(&columns, &["peak_force_n"], ended)
        .deviations("Peak force, off", off(peak))
        .result()
        .columns_by_key(&columns, &["impulse_ns"], ended)
        .deviations("Impulse, off", off(impulse))
        .result()
        .columns_by_key(&columns, &["static_transmission_error_m"], ended)
        .deviations("Static TE, mean, off", off(still))
        .result();
    let remark = "Off: deviation from hard contact. TE: transmission error at rest under the load of the settings.";
    glance("By penalty", html! { (table) (note(remark)) })
}
