//! One line per model.

use super::finding::costs;
use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{quantity, significant};
use crate::record::{Metrics, Run};
use crate::view::{View, resolution};

/// One line per model.
pub fn glance(view: &View<'_>) -> String {
    if view.groups.is_empty() {
        return String::new();
    }
    let ratios = costs(view);
    let per = |f: &dyn Fn(&crate::view::Group<'_>) -> Option<String>| -> Vec<Option<String>> {
        view.groups.iter().map(f).collect()
    };
    let best = |g: &crate::view::Group<'_>| view.best(g).map(|(_, r)| (*r).clone());
    let metrics = |g: &crate::view::Group<'_>| -> Option<Metrics> {
        best(g)?.against(view.against.as_deref()?).cloned()
    };
    let signed = |x: Option<f64>| {
        x.filter(|x| x.is_finite()).map(|x| {
            let sign = if x > 0.0 { "+" } else { "" };
            format!("{sign}{}", significant(100.0 * x, 3))
        })
    };
    let cheapest = |g: &crate::view::Group<'_>| -> Option<Run> {
        (g.runs.iter())
            .filter(|(_, r)| view.adequate(r) && r.wall_s.is_finite())
            .min_by(|a, b| a.1.wall_s.total_cmp(&b.1.wall_s))
            .map(|(_, r)| (*r).clone())
    };
    let columns = [
        Column::text("Model", per(&|g| Some(g.label.clone()))),
        Column::text(
            "Calibration",
            per(&|g| g.runs.iter().find_map(|(_, r)| r.calibration.clone())),
        ),
        Column::written(
            "Least error",
            "",
            per(&|g| view.error(&best(g)?).map(|e| view.error_text(e))),
        ),
        Column::written(
            "Peak force",
            "%",
            per(&|g| signed(metrics(g)?.peak_force_rel)),
        ),
        Column::written("Impulse", "%", per(&|g| signed(metrics(g)?.impulse_rel))),
        Column::text(
            "Cheapest adequate run",
            per(&|g| cheapest(g).map(|r| format!("{}, {}", r.integrator, resolution(&r)))),
        ),
        Column::written(
            "Its wall time",
            "",
            per(&|g| cheapest(g).map(|r| quantity(r.wall_s, "s", 3))),
        ),
        Column::written(
            "Cost ratio",
            "",
            per(&|g| {
                if g.style == 0 && !ratios.is_empty() {
                    return Some("1".into());
                }
                let (_, ratio) = ratios.iter().find(|(label, _)| *label == g.label)?;
                Some(significant(*ratio, 3))
            }),
        ),
        Column::written(
            "Failed",
            "",
            per(&|g| {
                let failed = g.runs.iter().filter(|(_, r)| r.status.is_failure()).count();
                Some(format!("{failed} of {}", g.runs.len()))
            }),
        ),
    ];
    let all = [Rows {
        heading: None,
        count: view.groups.len(),
        classes: Vec::new(),
    }];
    let against = match &view.against {
        Some(id) => format!(
            "Errors are the {} against {}; peak force and impulse are deviations from it, of the \
             run with the least error. ",
            view.metric.words(),
            escape(&view.reference_name(id))
        ),
        None => String::new(),
    };
    format!(
        "<section class=\"glance\">\n<h2>At a glance</h2>\n{}<p class=\"note\">{against}The cost \
         ratio is the median over runs at the same method and step.</p>\n</section>\n",
        table(&columns, &all)
    )
}
