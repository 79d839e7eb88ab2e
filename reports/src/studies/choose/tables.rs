//! Answer, reason and ladder of a choice.

use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{percent, quantity};
use crate::studies::choose::{ChoiceRecord, RungRecord};
use crate::view::View;

fn per_cent(x: f64) -> String {
    format!("{}\u{a0}%", percent(x, 2))
}

/// The answer, as HTML.
pub fn finding(view: &View<'_>) -> String {
    let Some(choice) = &view.results.choice else {
        return "The record holds no choice.".into();
    };
    let wish = format!(
        "{} within {}",
        escape(&choice.metric_title),
        per_cent(choice.tolerance)
    );
    let Some(t) = choice.choice() else {
        return format!(
            "For the {wish} <b>nothing that was tried is adequate</b>{}.",
            choice.predicted_error.map_or(String::new(), |e| format!(
                ": the least estimate is {}",
                per_cent(e)
            ))
        );
    };
    let mut out = format!(
        "For the {wish}: <b>{}</b> under <b>{}</b>",
        escape(&t.rung),
        escape(&t.method())
    );
    if let (Some(e), Some(cost)) = (choice.predicted_error, choice.predicted_cost_s) {
        out.push_str(&format!(
            ", with an estimated error of {} and {} of processor time for the whole scene",
            per_cent(e),
            quantity(cost, "s", 3)
        ));
    }
    if let Some(setup) = choice.setup_s {
        out.push_str(&format!("; set-up {}", quantity(setup, "s", 2)));
    }
    out.push('.');
    out
}

/// Reason, warnings and the ladder.
pub fn tables(view: &View<'_>) -> String {
    let Some(choice) = &view.results.choice else {
        return String::new();
    };
    let mut out = String::from("<section>\n<h2>Reason</h2>\n");
    for sentence in &choice.reason {
        out.push_str(&format!("<p>{}</p>\n", escape(sentence)));
    }
    out.push_str("</section>\n");
    if !choice.outside.is_empty() {
        out.push_str("<section>\n<h2>Outside of what was checked</h2>\n");
        out.push_str("<p>Choices were not checked on scenes like this one:</p>\n<ul>\n");
        for sentence in &choice.outside {
            out.push_str(&format!("<li>{}</li>\n", escape(sentence)));
        }
        out.push_str("</ul>\n</section>\n");
    }
    out.push_str(&ladder(choice));
    out
}

fn ladder(choice: &ChoiceRecord) -> String {
    let families = choice.families();
    let of =
        |f: &str| -> Vec<&RungRecord> { (choice.rungs.iter()).filter(|r| r.family == f).collect() };
    let rows: Vec<&RungRecord> = families.iter().flat_map(|f| of(f)).collect();
    if rows.is_empty() {
        return String::new();
    }
    let numbers = |f: fn(&RungRecord) -> Option<f64>| -> Vec<Option<f64>> {
        rows.iter().map(|r| f(r)).collect()
    };
    let cheapest = |r: &RungRecord| r.cheapest.and_then(|i| choice.tried.get(i));
    let chosen = |r: &RungRecord| r.cheapest.is_some() && r.cheapest == choice.chosen;
    let verdict = |r: &&RungRecord| {
        Some(match (&r.failure, chosen(r), r.cheapest) {
            (Some(f), ..) => f.clone(),
            (_, true, _) => "chosen".into(),
            (_, _, Some(_)) => "adequate".into(),
            _ if r.adequate && choice.chosen.is_some() => "adequate, dearer".into(),
            _ if r.adequate => "no step tried keeps it".into(),
            _ => "not adequate".into(),
        })
    };
    let columns = [
        Column::text("Rung", rows.iter().map(|r| Some(r.name.clone())).collect()),
        Column::percents("Distance to the top rung", 2, &numbers(|r| r.distance)),
        Column::percents("to the next rung", 2, &numbers(|r| r.step_up)),
        Column::percents("Estimated error", 2, &numbers(|r| r.error)),
        Column::text(
            "Cheapest adequate integrator",
            (rows.iter())
                .map(|r| cheapest(r).map(|t| t.method()))
                .collect(),
        ),
        Column::written(
            "Predicted cost",
            "",
            (rows.iter())
                .map(|r| Some(quantity(cheapest(r)?.cost_s?, "s", 3)))
                .collect(),
        ),
        Column::written(
            "Set-up",
            "",
            (rows.iter())
                .map(|r| Some(quantity(r.setup_s?, "s", 2)))
                .collect(),
        ),
        Column::text("Verdict", rows.iter().map(verdict).collect()),
    ];
    let groups: Vec<Rows> = (families.iter().enumerate())
        .map(|(style, f)| Rows {
            heading: Some(((*f).to_owned(), style)),
            count: of(f).len(),
            classes: (of(f).iter())
                .map(|r| match (&r.failure, r.cheapest) {
                    (Some(_), _) => "failed",
                    (None, None) if !r.adequate => "inaccurate",
                    _ => "",
                })
                .collect(),
        })
        .collect();
    format!(
        "<section class=\"glance\">\n<h2>The ladder</h2>\n{}<p class=\"note\">Distances are those of the rungs' own fine \
         solutions on the window ({}). The estimated error adds what the top rung is off and holds over the whole scene. Costs \
         are processor times on this machine.</p>\n</section>\n",
        table(&columns, &groups),
        escape(&choice.window)
    )
}
