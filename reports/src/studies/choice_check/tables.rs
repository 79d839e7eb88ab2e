//! Finding and tables of choices judged on random scenes.

use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{percent, significant};
use crate::studies::choice_check::{JudgedChoice, Outcome, share, shares};
use crate::view::View;

fn sure(x: Option<f64>) -> String {
    x.map_or_else(|| "-".into(), |x| significant(x, 3))
}

/// The finding, as HTML.
pub fn finding(view: &View<'_>) -> String {
    let scenes = &view.results.choices;
    let all: Vec<&JudgedChoice> = scenes.iter().collect();
    let total = share("all", &all);
    let count = |o: Outcome| scenes.iter().filter(|s| s.outcome == o).count();
    let mut out = format!(
        "On <b>{} of {}</b> random scenes ({}\u{a0}%) the choice does what was asked: {} times it keeps the tolerance, \
         {} times it rightly says that nothing tried does. {} choices are beyond the tolerance, {} times an adequate \
         candidate was overlooked, {} scenes could not be judged.",
        total.met,
        total.scenes,
        percent(total.met as f64 / total.scenes.max(1) as f64, 3),
        count(Outcome::Adequate),
        count(Outcome::RightlyNone),
        count(Outcome::Inadequate),
        count(Outcome::WronglyNone),
        count(Outcome::NotJudged),
    );
    if let [Some(low), Some(middle), Some(high), Some(most)] = total.cost_ratio {
        out.push_str(&format!(
            " An adequate choice costs <b>{} times</b> the cheapest adequate candidate in the median (quartiles {} and {}, \
             nine tenths below {}).",
            significant(middle, 3),
            significant(low, 3),
            significant(high, 3),
            significant(most, 3)
        ));
    }
    if let [Some(low), Some(middle), Some(high), _] = total.prediction {
        out.push_str(&format!(
            " Predicted errors are {} times those found in the median (quartiles {} and {}).",
            significant(middle, 2),
            significant(low, 2),
            significant(high, 2)
        ));
    }
    out
}

/// Tables: figures by group, and the scenes that were missed.
pub fn tables(view: &View<'_>) -> String {
    let scenes = &view.results.choices;
    let groups = shares(scenes);
    let plain = |n: usize| {
        [Rows {
            heading: None,
            count: n,
            classes: Vec::new(),
        }]
    };
    let each = |f: &dyn Fn(&crate::studies::choice_check::Share) -> String| -> Vec<Option<String>> {
        groups.iter().map(|g| Some(f(g))).collect()
    };
    let columns = [
        Column::text("Scenes", each(&|g| g.name.clone())),
        Column::written("number", "", each(&|g| g.scenes.to_string())),
        Column::written("met", "", each(&|g| g.met.to_string())),
        Column::written(
            "met",
            "%",
            each(&|g| percent(g.met as f64 / g.scenes.max(1) as f64, 3)),
        ),
        Column::written("rightly none", "", each(&|g| g.rightly_none.to_string())),
        Column::written("cost ratio, median", "", each(&|g| sure(g.cost_ratio[1]))),
        Column::written("90 % below", "", each(&|g| sure(g.cost_ratio[3]))),
        Column::written(
            "predicted / true error, median",
            "",
            each(&|g| sure(g.prediction[1])),
        ),
    ];
    let mut out = format!(
        "<section class=\"glance\">\n<h2>How choices came out</h2>\n{}<p class=\"note\">met: the tolerance is kept against \
         the reference over the whole scene, or nothing that was tried keeps it and the choice said so. Cost ratio: \
         processor time over that of the cheapest adequate candidate.</p>\n</section>\n",
        table(&columns, &plain(groups.len()))
    );
    let missed: Vec<&JudgedChoice> = (scenes.iter()).filter(|s| !s.outcome.is_met()).collect();
    if !missed.is_empty() {
        let text = |f: &dyn Fn(&JudgedChoice) -> String| -> Vec<Option<String>> {
            missed.iter().map(|s| Some(f(s))).collect()
        };
        let columns = [
            Column::text("Scene", text(&|s| s.scene.clone())),
            Column::text("Kind", text(&|s| s.kind.clone())),
            Column::text("Gears", text(&|s| s.gears.clone())),
            Column::text("Metric", text(&|s| s.metric.to_string())),
            Column::written("Tolerance", "%", text(&|s| percent(s.tolerance, 2))),
            Column::text("Outcome", text(&|s| s.outcome.to_string())),
            Column::text(
                "Chosen",
                text(&|s| s.chosen.clone().unwrap_or_else(|| "none".into())),
            ),
            Column::text("Why", text(&JudgedChoice::why_missed)),
        ];
        out.push_str(&format!(
            "<section>\n<h2>Misses</h2>\n{}</section>\n",
            table(&columns, &plain(missed.len()))
        ));
    }
    out
}

/// All scenes, one line each.
pub fn scenes(view: &View<'_>) -> String {
    let all = &view.results.choices;
    let text = |f: &dyn Fn(&JudgedChoice) -> String| -> Vec<Option<String>> {
        all.iter().map(|s| Some(f(s))).collect()
    };
    let some = |f: &dyn Fn(&JudgedChoice) -> Option<f64>| -> Vec<Option<f64>> {
        all.iter().map(f).collect()
    };
    let columns = [
        Column::text("Scene", text(&|s| s.scene.clone())),
        Column::text("Kind", text(&|s| s.kind.clone())),
        Column::text("Metric", text(&|s| s.metric.to_string())),
        Column::percents("Tolerance", 2, &some(&|s| Some(s.tolerance))),
        Column::text("Against", text(&|s| s.reference.clone())),
        Column::percents("its own error", 2, &some(&|s| s.reference_error)),
        Column::text(
            "Chosen",
            text(&|s| s.chosen.clone().unwrap_or_else(|| "none".into())),
        ),
        Column::percents("Predicted", 2, &some(&|s| s.predicted_error)),
        Column::percents("Error", 2, &some(&|s| s.error)),
        Column::written(
            "Cost ratio",
            "",
            all.iter()
                .map(|s| s.cost_ratio().map(|r| significant(r, 3)))
                .collect(),
        ),
        Column::text("Outcome", text(&|s| s.outcome.to_string())),
    ];
    let rows = [Rows {
        heading: None,
        count: all.len(),
        classes: (all.iter())
            .map(|s| if s.outcome.is_met() { "" } else { "failed" })
            .collect(),
    }];
    format!(
        "<section>\n<h2>Scenes</h2>\n{}<p class=\"note\">{}</p>\n</section>\n",
        table(&columns, &rows),
        escape(
            "Its own error: what twice the step or fewer modes change in the densest elastic model; against full finite \
             elements nothing is stated."
        )
    )
}
