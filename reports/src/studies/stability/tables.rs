//! Finding and tables of a study of stability.

use super::csv;
use super::{Limit, Map, is_lost, unique_pairs};
use crate::markup::table::Table;
use crate::markup::{glance, note, section};
use crate::numbers::{count, counted, per_cent, quantity, times};
use crate::record::Status;
use maud::{Markup, html};

/// Returns the labels of models in the order of appearance.
fn models(maps: &[Map]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for label in maps.iter().map(Map::model_label) {
        if !found.contains(&label) {
            found.push(label);
        }
    }
    found
}

/// Returns the largest stable step in words.
fn step(limit: &Limit) -> String {
    match (limit.stable_s, limit.unstable_s) {
        (Some(h), Some(_)) => quantity(h, "s", 3),
        (Some(h), None) => format!("\u{2265} {}", quantity(h, "s", 3)),
        (None, Some(h)) => format!("< {}", quantity(h, "s", 3)),
        (None, None) => String::new(),
    }
}

pub fn finding(maps: &[Map]) -> Vec<Markup> {
    let total: usize = maps.iter().map(|m| m.cells.len()).sum();
    if total == 0 {
        return vec![html! { "The record holds no map." }];
    }
    let of = |s: Status| -> usize {
        let cells = maps.iter().flat_map(|m| &m.cells);
        cells.filter(|c| c.status == s).count()
    };
    let mut failures: Vec<(usize, Status)> = (Status::ALL.into_iter())
        .filter(|s| s.is_failure())
        .map(|s| (of(s), s))
        .filter(|(n, _)| *n > 0)
        .collect();
    failures.sort_by_key(|f| std::cmp::Reverse(f.0));
    let part = |n: usize| per_cent(n as f64 / total as f64, 2);
    let words: Vec<String> = (failures.iter())
        .map(|(n, s)| format!("{s} {}", part(*n)))
        .collect();
    let failed = match words.as_slice() {
        [] => ", none failed".into(),
        all => format!("; the others failed: {}", all.join(", ")),
    };
    let mut parts = vec![html! {
        "Of " (count(total as u64)) " runs " (part(of(Status::Converged))) " converged, "
        @if of(Status::Unchecked) > 0 { (part(of(Status::Unchecked))) " ended with a sound energy balance only, " }
         (part(of(Status::Inaccurate)))
        " ended but were inaccurate" (failed) "."
    }];
    let about: Vec<Markup> = (models(maps).into_iter())
        .filter_map(|label| {
            let of_model = unique_pairs(maps)
                .into_iter()
                .filter(|m| m.model_label() == label);
            about(&label, &of_model.collect::<Vec<&Map>>())
        })
        .collect();
    if !about.is_empty() {
        parts.push(html! {
            "Largest stable steps at the scene's own parameters: "
            @for (i, text) in about.iter().enumerate() { @if i > 0 { "; " } (text) }
            "."
        });
    }
    parts.extend(explicit_sentence(maps).map(|text| html! { (text) }));
    parts
}

/// Returns the sentence on the smallest and the largest limit of a model, and on the methods that never failed.
fn about(label: &str, maps: &[&Map]) -> Option<Markup> {
    let mut limited: Vec<(f64, &Map)> = (maps.iter())
        .filter_map(|m| {
            let l = m.limit()?;
            Some((l.unstable_s.and(l.stable_s)?, *m))
        })
        .collect();
    limited.sort_by(|a, b| a.0.total_cmp(&b.0));
    let unlimited = (maps.iter())
        .filter(|m| m.limit().is_some_and(|l| l.unstable_s.is_none()))
        .count();
    let held = match unlimited {
        0 => String::new(),
        n if limited.is_empty() => format!(
            "{} stable at every step tried",
            counted(n, "integrator", "integrators")
        ),
        n => format!(
            ", {} stable at every step tried",
            counted(n, "other", "others")
        ),
    };
    let one = |(h, m): &(f64, &Map)| {
        let theory = m
            .ratio()
            .map_or(String::new(), |r| format!(", {}what theory says", times(r)));
        format!("{} ({}{theory})", quantity(*h, "s", 3), m.integrator)
    };
    let range = match limited.as_slice() {
        [] if unlimited == 0 => return None,
        [] => String::new(),
        [only] => one(only),
        [first, .., last] => format!("from {} to {}", one(first), one(last)),
    };
    Some(html! { b { (label) } " " (range) (held) })
}

/// Returns the sentence on combinations of step and parameters at which every explicit method is unstable, and the
/// numbers of those at which an implicit one is stable or accurate.
fn explicit_sentence(maps: &[Map]) -> Option<String> {
    let (mut lost, mut kept, mut accurate) = (0, 0, 0);
    for label in models(maps) {
        let mut sets: Vec<usize> = maps.iter().map(|m| m.set).collect();
        sets.sort_unstable();
        sets.dedup();
        for set in sets {
            let of: Vec<&Map> = (maps.iter())
                .filter(|m| m.set == set && m.model_label() == label && m.limit().is_some())
                .collect();
            let (implicit, explicit): (Vec<&Map>, Vec<&Map>) =
                of.into_iter().partition(|m| m.implicit);
            let Some(first) = explicit.first().filter(|_| !implicit.is_empty()) else {
                continue;
            };
            let alike = |m: &&Map| m.at == first.at && m.axes == first.axes;
            if !explicit.iter().chain(&implicit).all(alike) {
                continue;
            }
            for i in 0..first.cells.len() {
                let status = |m: &Map| m.cells.get(i).map_or(Status::Timeout, |c| c.status);
                if explicit.iter().all(|m| is_lost(status(m))) {
                    lost += 1;
                    kept += usize::from(implicit.iter().any(|m| !is_lost(status(m))));
                    accurate += usize::from(implicit.iter().any(|m| status(m).holds()));
                }
            }
        }
    }
    (lost > 0).then(|| {
        format!(
            "Of {} combinations of step and parameters at which every explicit method lost its stability, an implicit one held in \
             {} and stayed within the tolerance in {}.",
            count(lost),
            count(kept as u64),
            count(accurate as u64)
        )
    })
}

/// Returns the tables of the largest stable steps and of the frequency of each label.
pub fn tables(maps: &[Map]) -> Markup {
    html! { (limits(maps)) (labels(maps)) (references(maps)) }
}

/// Returns the maps ordered by model, in the order of appearance.
fn by_model<'a>(maps: impl Iterator<Item = &'a Map>) -> Vec<&'a Map> {
    let mut all: Vec<&Map> = maps.collect();
    let order: Vec<String> = all.iter().map(|m| m.model_label()).collect();
    all.sort_by_key(|m| order.iter().position(|l| *l == m.model_label()));
    all
}

/// Returns a table of maps under the names of their models.
fn table<'r, 'a>(rows: &'r [&'a Map]) -> Table<'r, &'a Map> {
    let mut labels: Vec<String> = rows.iter().map(|m| m.model_label()).collect();
    labels.dedup();
    Table::of(rows)
        .grouped(|m| {
            let label = m.model_label();
            let place = labels.iter().position(|l| *l == label);
            (label, place.unwrap_or(0))
        })
        .text("Integrator", |m| m.integrator.clone())
}

fn limits(maps: &[Map]) -> Markup {
    let rows = by_model((unique_pairs(maps).into_iter()).filter(|m| m.limit().is_some()));
    if rows.is_empty() {
        return Markup::default();
    }
    fn of<'a>(map: &&'a Map) -> Option<csv::MapLimit<'a>> {
        Some((map, map.limit()?))
    }
    let table = table(&rows)
        .written("Largest stable step", "", |m| Some(step(&m.limit()?)))
        .result()
        .columns_by_key(&csv::limits(), &["theory_s", "ratio", "failing_with"], of)
        .text("Beyond", |m| {
            let again = m.limit()?.holds_again;
            again.then_some("some larger steps hold again")
        })
        .columns_by_key(
            &csv::limits(),
            &["largest_accurate_s", "contact_pulls_from_s"],
            of,
        );
    let remark = note(
        "At the scene's own parameters: the largest step up to which every run held, closed in on to 2\u{a0}% between the \
         last that held and the first that failed. Theory is linear, at the closed contact of largest force; a run that is \
         short, damped or mostly in free flight may survive a larger step (Dormand-Prince grows so slowly beyond its limit \
         that short runs do not show it), and one whose energy swings near the limit fails before it. Accurate: within the \
         tolerance against the model's own converged solution. From the step in the last column on the force history of a \
         contact dips below zero between steps: the run goes on, but its force is none that a contact has.",
    );
    glance("Largest stable steps", html! { (table) (remark) })
}

fn labels(maps: &[Map]) -> Markup {
    let rows = by_model(maps.iter());
    if rows.is_empty() {
        return Markup::default();
    }
    let mut table = table(&rows).text("Over", |m| {
        let ids: Vec<&str> = m.axes.iter().map(|a| a.id.as_str()).collect();
        ids.join(", ")
    });
    for (i, status) in Status::ALL.into_iter().enumerate() {
        table = table.written(status.as_str(), "", |m| {
            Some(m.counts()[i])
                .filter(|n| *n > 0)
                .map(|n| n.to_string())
        });
        if !status.is_failure() {
            table = table.result();
        }
    }
    section("How runs ended", table)
}

/// Returns the table of converged solutions: method and check, or the reason why there is none.
fn references(maps: &[Map]) -> Markup {
    let mut lines: Vec<(String, String, usize, f64)> = Vec::new();
    for label in models(maps) {
        let Some(map) = maps.iter().find(|m| m.model_label() == label) else {
            continue;
        };
        for r in &map.references {
            let text = match &r.missing {
                Some(why) => format!("none: {why}"),
                None => r.method.clone(),
            };
            let checked = r.checked.unwrap_or(0.0);
            match lines.iter_mut().find(|l| l.0 == label && l.1 == text) {
                Some(line) => {
                    line.2 += 1;
                    line.3 = line.3.max(checked);
                }
                None => lines.push((label.clone(), text, 1, checked)),
            }
        }
    }
    let table = Table::of(&lines)
        .text("Model", |l| l.0.clone())
        .text("Converged solution, and what checks it", |l| l.1.clone())
        .written("Rows", "", |l| l.2.to_string())
        .written(
            "The two differ by at most, in the metric of the tolerance",
            "",
            |l| Some(per_cent(l.3, 2)).filter(|_| l.3 > 0.0),
        )
        .result();
    section("Converged solutions of the cells", table)
}
