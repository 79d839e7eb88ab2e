//! Finding and tables of a study of mode counts.

use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{percent, quantity, short, significant};
use crate::record::{Metrics, Run};
use crate::studies::truncation::{LIMITS, Way, counts, ways};
use crate::view::View;

fn against(view: &View<'_>) -> String {
    view.against.clone().unwrap_or_else(|| "fe".into())
}

fn l2(m: &Metrics) -> Option<f64> {
    m.force_l2
}

fn error(run: &Run, against: &str) -> Option<f64> {
    l2(run.against(against)?).filter(|e| e.is_finite())
}

fn reach(run: &Run) -> String {
    let modes = run.modes.unwrap_or(0);
    match run.highest_hz {
        Some(f) if modes > 0 => format!("{modes} (to {})", quantity(f, "Hz", 3)),
        _ => modes.to_string(),
    }
}

/// The finding, as HTML.
pub fn finding(view: &View<'_>) -> String {
    let (all, id) = (ways(view.results), against(view));
    if all.is_empty() {
        return "The record holds no run of the elastic model.".into();
    }
    let reference = escape(&view.reference_name(&id));
    let mut sentences = Vec::new();
    for way in all.iter().filter(|w| w.residual) {
        let reached: Vec<String> = LIMITS
            .iter()
            .map(|limit| {
                let limit_text = format!("{}\u{a0}%", short(100.0 * limit, 2));
                match way.fewest(&id, *limit) {
                    Some(run) => format!("{} for {limit_text}", run.modes.unwrap_or(0)),
                    None => format!("no number tried for {limit_text}"),
                }
            })
            .collect();
        sentences.push(format!(
            "With residual compliance and modes chosen <b>{}</b>, the fewest modes per gear are {} of the force \
             history against {reference}.",
            escape(&way.label),
            reached.join(", ")
        ));
    }
    for truncated in all.iter().filter(|w| !w.residual) {
        for (_, run) in truncated.runs.iter().filter(|(_, r)| r.mark.is_some()) {
            sentences.extend(beside(&all, run, &id));
        }
    }
    if sentences.is_empty() {
        sentences.push("No run could be held against a reference.".into());
    }
    let failed: usize = (view.results.runs.iter())
        .filter(|r| r.status.is_failure())
        .count();
    sentences.push(match failed {
        0 => format!("None of the {} runs failed.", view.results.runs.len()),
        n => format!(
            "{n} of {} runs failed and are shown as failures.",
            view.results.runs.len()
        ),
    });
    sentences.join(" ")
}

/// A run that is pointed out beside the best that residual compliance does with no more modes.
fn beside(all: &[Way<'_>], run: &Run, id: &str) -> Option<String> {
    let mark = run.mark.as_deref()?;
    let (first, rest) = mark.split_at(mark.chars().next().map_or(0, char::len_utf8));
    let name = escape(&(first.to_uppercase() + rest));
    let modes = run.modes?;
    if run.status.is_failure() {
        return Some(format!(
            "{name} ({modes} modes) failed: {}.",
            run.status.as_str()
        ));
    }
    let own = error(run, id)?;
    let better = (all.iter().filter(|w| w.residual))
        .flat_map(|w| w.errors(id, l2))
        .filter(|(n, _, _)| *n <= modes)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let compared = match better {
        Some((n, e, other)) => format!(
            ", {} times that of {n} modes with residual compliance ({}\u{a0}%, {} in place of {})",
            significant(own / e, 2),
            percent(e, 2),
            quantity(other.wall_s, "s", 2),
            quantity(run.wall_s, "s", 2),
        ),
        None => String::new(),
    };
    Some(format!(
        "{name} ({modes} modes per gear) has an error of {}\u{a0}%{compared}.",
        percent(own, 3)
    ))
}

/// The two tables.
pub fn tables(view: &View<'_>) -> String {
    let (all, id) = (ways(view.results), against(view));
    if all.is_empty() {
        return String::new();
    }
    let plain = |n: usize| {
        [Rows {
            heading: None,
            count: n,
            classes: Vec::new(),
        }]
    };
    let labels = || all.iter().map(|w| Some(w.label.clone())).collect();
    let mut columns = vec![Column::text("Modes chosen", labels())];
    for limit in LIMITS {
        let cells = all
            .iter()
            .map(|w| w.fewest(&id, limit).map(reach))
            .collect();
        let heading = format!("{} %", short(100.0 * limit, 2));
        columns.push(Column::written(&heading, "", cells));
    }
    let least = |w: &Way<'_>| {
        let of = w.errors(&id, l2);
        let (n, e, _) = of.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!("{}\u{a0}% with {n}", percent(e, 3)))
    };
    columns.push(Column::written(
        "Least error",
        "",
        all.iter().map(least).collect(),
    ));
    let mut out = format!(
        "<section class=\"glance\">\n<h2>Fewest modes per gear</h2>\n{}<p class=\"note\">The fewest modes from which on \
         every larger number that was tried stays within the limit of the force-history error against {}, and the \
         highest frequency among them. A dash: none of those tried.</p>\n</section>\n",
        table(&columns, &plain(all.len())),
        escape(&view.reference_name(&id))
    );

    let tried = counts(&all);
    let numbers = tried.iter().map(|n| Some(n.to_string())).collect();
    let mut columns = vec![Column::written("Modes per gear", "", numbers)];
    for way in &all {
        let cell = |n: &usize| {
            let run = way.with(*n)?;
            Some(match error(run, &id) {
                _ if run.status.is_failure() => run.status.as_str().to_string(),
                Some(e) => percent(e, 3),
                None => return None,
            })
        };
        columns.push(Column::written(
            &way.label,
            "%",
            tried.iter().map(cell).collect(),
        ));
    }
    out.push_str(&format!(
        "<section>\n<h2>Force-history error by number of modes</h2>\n{}<p class=\"note\">Relative L2 error of the \
         contact-force history against {}, not shifted in time.</p>\n</section>\n",
        table(&columns, &plain(tried.len())),
        escape(&view.reference_name(&id))
    ));
    out
}
