//! Finding and tables of a study of stability.

use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{count, percent, quantity, short};
use crate::record::Status;
use crate::studies::stability::{Limit, Map, is_lost, once};
use crate::view::View;

/// Labels of models in the order of appearance.
fn models(maps: &[Map]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for label in maps.iter().map(Map::model_label) {
        if !found.contains(&label) {
            found.push(label);
        }
    }
    found
}

/// The largest stable step in words.
fn step(limit: &Limit) -> String {
    match (limit.stable_s, limit.unstable_s) {
        (Some(h), Some(_)) => quantity(h, "s", 3),
        (Some(h), None) => format!("\u{2265} {}", quantity(h, "s", 3)),
        (None, Some(h)) => format!("< {}", quantity(h, "s", 3)),
        (None, None) => String::new(),
    }
}

/// The finding, as HTML.
pub fn finding(view: &View<'_>) -> String {
    let maps = &view.results.maps;
    let total: usize = maps.iter().map(|m| m.cells.len()).sum();
    if total == 0 {
        return "The record holds no map.".into();
    }
    let of = |s: Status| -> usize {
        maps.iter()
            .map(|m| m.cells.iter().filter(|c| c.status == s).count())
            .sum()
    };
    let mut failures: Vec<(usize, Status)> = (Status::ALL.into_iter())
        .filter(|s| s.is_failure())
        .map(|s| (of(s), s))
        .filter(|(n, _)| *n > 0)
        .collect();
    failures.sort_by_key(|f| std::cmp::Reverse(f.0));
    let part = |n: usize| percent(n as f64 / total as f64, 2);
    let mut sentences = vec![format!(
        "Of {} runs {}\u{a0}% converged, {}\u{a0}% ended but were inaccurate{}.",
        count(total as u64),
        part(of(Status::Converged)),
        part(of(Status::Inaccurate)),
        if failures.is_empty() {
            ", none failed".into()
        } else {
            let words: Vec<String> = (failures.iter())
                .map(|(n, s)| format!("{s} {}\u{a0}%", part(*n)))
                .collect();
            format!("; the others failed: {}", words.join(", "))
        }
    )];
    for label in models(maps) {
        let of_model: Vec<&Map> = (once(maps).into_iter())
            .filter(|m| m.model_label() == label)
            .collect();
        sentences.extend(about(&label, &of_model));
    }
    sentences.extend(beside(maps));
    sentences.join(" ")
}

/// The explicit method with the largest and smallest limit of a model, and the implicit ones that never failed.
fn about(label: &str, maps: &[&Map]) -> Option<String> {
    let mut limited: Vec<(f64, &Map)> = (maps.iter())
        .filter_map(|m| {
            let l = m.limit()?;
            Some((l.unstable_s.and(l.stable_s)?, *m))
        })
        .collect();
    limited.sort_by(|a, b| b.0.total_cmp(&a.0));
    let unlimited: Vec<String> = (maps.iter())
        .filter(|m| m.limit().is_some_and(|l| l.unstable_s.is_none()))
        .map(|m| escape(&m.integrator))
        .collect();
    let name = escape(label);
    let mut parts = Vec::new();
    if let Some((h, m)) = limited.first() {
        let theory = m.ratio().map_or(String::new(), |r| {
            format!(", {} times what theory says", short(r, 2))
        });
        parts.push(format!(
            "at the scene's own parameters <b>{name}</b> bears its longest limited step under {} ({}{theory})",
            escape(&m.integrator),
            quantity(*h, "s", 3)
        ));
    }
    if let [.., (h, m)] = limited.as_slice()
        && limited.len() > 1
    {
        parts.push(format!(
            "its shortest under {} ({})",
            escape(&m.integrator),
            quantity(*h, "s", 3)
        ));
    }
    if !unlimited.is_empty() {
        let subject = if limited.is_empty() {
            format!("<b>{name}</b>: ")
        } else {
            String::new()
        };
        parts.push(format!(
            "{subject}{} held at every step tried",
            unlimited.join(", ")
        ));
    }
    let text = parts.join("; ");
    let begin = text.chars().next()?.to_uppercase().to_string();
    let rest = text.get(text.chars().next()?.len_utf8()..)?;
    Some(format!("{begin}{rest}."))
}

/// Where every explicit method of a model fails and an implicit one does not.
fn beside(maps: &[Map]) -> Option<String> {
    let (mut lost, mut kept, mut accurate) = (0, 0, 0);
    for label in models(maps) {
        let sets: Vec<usize> = maps.iter().map(|m| m.set).collect();
        let most = sets.into_iter().max().unwrap_or(0);
        for set in 0..=most {
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
                    accurate +=
                        usize::from(implicit.iter().any(|m| status(m) == Status::Converged));
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

/// The largest stable steps and how often each label occurs.
pub fn tables(view: &View<'_>) -> String {
    let all = once(&view.results.maps);
    limits(&all) + &labels(&view.results.maps) + &references(&view.results.maps)
}

/// Rows of the maps grouped by model.
fn grouped(maps: &[&Map], class: impl Fn(&Map) -> &'static str) -> Vec<Rows> {
    let mut groups: Vec<Rows> = Vec::new();
    for map in maps {
        let label = map.model_label();
        let style = groups.len();
        match groups.last_mut() {
            Some(g) if g.heading.as_ref().is_some_and(|h| h.0 == label) => {
                g.count += 1;
                g.classes.push(class(map));
            }
            _ => groups.push(Rows {
                heading: Some((label, style)),
                count: 1,
                classes: vec![class(map)],
            }),
        }
    }
    groups
}

/// Maps with those of a model beside each other.
fn by_model<'a>(maps: impl Iterator<Item = &'a Map>) -> Vec<&'a Map> {
    let mut all: Vec<&Map> = maps.collect();
    let order: Vec<String> = all.iter().map(|m| m.model_label()).collect();
    all.sort_by_key(|m| order.iter().position(|l| *l == m.model_label()));
    all
}

fn limits(maps: &[&Map]) -> String {
    let rows = by_model(maps.iter().copied().filter(|m| m.limit().is_some()));
    if rows.is_empty() {
        return String::new();
    }
    let cell = |f: &dyn Fn(&Map, Limit) -> Option<String>| -> Vec<Option<String>> {
        rows.iter().map(|m| f(m, m.limit()?)).collect()
    };
    let columns = [
        Column::text("Integrator", cell(&|m, _| Some(m.integrator.clone()))),
        Column::written("Largest stable step", "", cell(&|_, l| Some(step(&l)))),
        Column::written(
            "Theory",
            "",
            cell(&|m, _| m.theory(m.own_row()).map(|t| quantity(t.0, "s", 3))),
        ),
        Column::written(
            "Found over theory",
            "",
            cell(&|m, _| m.ratio().map(|r| short(r, 3))),
        ),
        Column::text("Fails with", cell(&|_, l| l.status.map(|s| s.to_string()))),
        Column::text(
            "Beyond",
            cell(&|_, l| l.holds_again.then(|| "some larger steps hold again".into())),
        ),
        Column::written(
            "Largest accurate step",
            "",
            cell(&|_, l| l.accurate_s.map(|h| quantity(h, "s", 3))),
        ),
        Column::written(
            "A contact pulls from",
            "",
            cell(&|_, l| l.pulls_from_s.map(|h| quantity(h, "s", 3))),
        ),
    ];
    format!(
        "<section class=\"glance\">\n<h2>Largest stable steps</h2>\n{}<p class=\"note\">At the scene's own parameters: \
         the largest step up to which every run held, closed in on to 2\u{a0}% between the last that held and the \
         first that failed. Theory is linear, at the closed contact of largest force; a run that is short, damped or \
         mostly in flight may survive a larger step (Dormand-Prince grows so slowly beyond its limit that short runs do \
         not show it), and one whose energy swings near the limit fails before it. \
         Accurate: within the tolerance against the model's own converged solution. From the step in the last column on the \
         force history of a contact dips below zero between steps: the run goes on, but its force is none that a contact \
         has.</p>\n</section>\n",
        table(&columns, &grouped(&rows, |_| ""))
    )
}

fn labels(maps: &[Map]) -> String {
    let rows = by_model(maps.iter());
    if rows.is_empty() {
        return String::new();
    }
    let mut columns = vec![
        Column::text(
            "Integrator",
            rows.iter().map(|m| Some(m.integrator.clone())).collect(),
        ),
        Column::text(
            "Over",
            rows.iter()
                .map(|m| {
                    let ids: Vec<&str> = m.axes.iter().map(|a| a.id.as_str()).collect();
                    Some(ids.join(", "))
                })
                .collect(),
        ),
    ];
    for (i, status) in Status::ALL.into_iter().enumerate() {
        let cells: Vec<Option<String>> = (rows.iter())
            .map(|m| {
                Some(m.counts()[i])
                    .filter(|n| *n > 0)
                    .map(|n| n.to_string())
            })
            .collect();
        columns.push(Column::written(status.as_str(), "", cells));
    }
    format!(
        "<section>\n<h2>How runs ended</h2>\n{}</section>\n",
        table(&columns, &grouped(&rows, |_| ""))
    )
}

/// The converged solutions: how they were made and checked, or why there are none.
fn references(maps: &[Map]) -> String {
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
    let columns = [
        Column::text("Model", lines.iter().map(|l| Some(l.0.clone())).collect()),
        Column::text(
            "Converged solution",
            lines.iter().map(|l| Some(l.1.clone())).collect(),
        ),
        Column::written(
            "Rows",
            "",
            lines.iter().map(|l| Some(l.2.to_string())).collect(),
        ),
        Column::written(
            "They differ by at most",
            "",
            lines
                .iter()
                .map(|l| Some(short(l.3, 2)).filter(|_| l.3 > 0.0))
                .collect(),
        ),
    ];
    let group = [Rows {
        heading: None,
        count: lines.len(),
        classes: Vec::new(),
    }];
    format!(
        "<section>\n<h2>What cells are held against</h2>\n{}</section>\n",
        table(&columns, &group)
    )
}
