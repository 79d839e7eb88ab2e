//! What the models cost beside each other and beside full finite elements, with times that others publish.

use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{quantity, significant};
use crate::record::Run;
use crate::view::{View, resolution};

/// Id of full finite elements.
const FULL: &str = "fe";

/// Simulation time by model; nothing without a full model and another one.
pub fn timing(view: &View<'_>) -> String {
    let best: Vec<(&str, &Run)> = (view.groups.iter())
        .filter_map(|g| {
            let (_, run) = view.best(g)?;
            run.wall_s.is_finite().then_some((g.label.as_str(), *run))
        })
        .collect();
    let full = (best.iter())
        .filter(|(_, r)| r.model == FULL)
        .map(|(_, r)| r.wall_s)
        .min_by(f64::total_cmp);
    let (Some(full), Some((first, base)), true) = (full, best.first(), best.len() > 1) else {
        return String::new();
    };
    let per = |f: &dyn Fn(&Run) -> Option<String>| -> Vec<Option<String>> {
        best.iter().map(|(_, r)| f(r)).collect()
    };
    let ratio = |a: f64, b: f64| Some(significant(a / b, 3)).filter(|_| a > 0.0 && b > 0.0);
    let of = |model: &dyn Fn(&Run) -> bool| {
        (best.iter())
            .find(|(_, r)| model(r) && r.published_s.is_some())
            .and_then(|(_, r)| r.published_s)
    };
    let (first_published, full_published) = (base.published_s, of(&|r| r.model == FULL));
    let columns = [
        Column::text(
            "Model",
            best.iter().map(|(l, _)| Some((*l).to_string())).collect(),
        ),
        Column::text(
            "Integrator",
            per(&|r| Some(format!("{}, {}", r.integrator, resolution(r)))),
        ),
        Column::written(
            "Simulation time",
            "",
            per(&|r| Some(quantity(r.wall_s, "s", 3))),
        ),
        Column::written(
            &format!("over {first}"),
            "",
            per(&|r| ratio(r.wall_s, base.wall_s)),
        ),
        Column::written("fe over it", "", per(&|r| ratio(full, r.wall_s))),
        Column::written("Setup", "", per(&|r| Some(quantity(r.setup_s, "s", 3)))),
        Column::written(
            "Published",
            "",
            per(&|r| r.published_s.map(|t| quantity(t, "s", 4))),
        ),
        Column::written(
            &format!("over {first}"),
            "",
            per(&|r| ratio(r.published_s?, first_published?)),
        ),
        Column::written(
            "fe over it",
            "",
            per(&|r| ratio(full_published?, r.published_s?)),
        ),
    ];
    let source = match &view.results.published {
        Some(text) => format!(" Published: {}.", escape(text)),
        None => String::new(),
    };
    let rows = [Rows {
        heading: None,
        count: best.len(),
        classes: Vec::new(),
    }];
    format!(
        "<section>\n<h2>Simulation time</h2>\n{}<p class=\"note\">Wall time of one run of {} simulated, setup apart, by \
         the run of each model with the least error; ratios on one machine within this record.{source}</p>\n</section>\n",
        table(&columns, &rows),
        quantity(base.simulated_s, "s", 3)
    )
}
