//! One line per model.

use super::finding::costs;
use crate::markup::table::Table;
use crate::markup::{glance as section, note};
use crate::numbers::{quantity, significant};
use crate::record::{Metrics, Run};
use crate::view::{Group, View, resolution};
use maud::{Markup, html};

/// One line per model.
pub fn glance(view: &View<'_>) -> Markup {
    if view.groups.is_empty() {
        return Markup::default();
    }
    let ratios = costs(view);
    let best = |g: &Group<'_>| view.best(g).map(|(_, r)| (*r).clone());
    let metrics =
        |g: &Group<'_>| -> Option<Metrics> { best(g)?.against(view.against.as_deref()?).cloned() };
    let cheapest = |g: &Group<'_>| -> Option<Run> {
        (g.runs.iter())
            .filter(|(_, r)| view.adequate(r) && r.wall_s.is_finite())
            .min_by(|a, b| a.1.wall_s.total_cmp(&b.1.wall_s))
            .map(|(_, r)| (*r).clone())
    };
    let table = Table::of(&view.groups)
        .text("Model", |g| g.label.clone())
        .text("Calibration", |g| {
            g.runs.iter().find_map(|(_, r)| r.calibration.clone())
        })
        .text("Error is", |g| {
            let fitted = view.is_fitted(&best(g)?);
            view.error(&best(g)?)?;
            Some(
                if fitted {
                    "rest of a fit"
                } else {
                    view.kind_of_error()
                }
                .to_string(),
            )
        })
        .written("Least error", "", |g| {
            view.error(&best(g)?).map(|e| view.error_text(e))
        })
        .result()
        .deviations("Peak force", |g| metrics(g)?.peak_force_rel)
        .deviations("Impulse", |g| metrics(g)?.impulse_rel)
        .text("Cheapest adequate run", |g| {
            cheapest(g).map(|r| format!("{}, {}", r.integrator, resolution(&r)))
        })
        .result()
        .written("Its wall time", "", |g| {
            cheapest(g).map(|r| quantity(r.wall_s, "s", 3))
        })
        .result()
        .written("Cost ratio", "", |g| {
            if g.style == 0 && !ratios.is_empty() {
                return Some("1".into());
            }
            let (_, ratio) = ratios.iter().find(|(label, _)| *label == g.label)?;
            Some(significant(*ratio, 3))
        })
        .written("Failed", "", |g| {
            let failed = g.runs.iter().filter(|(_, r)| r.status.is_failure()).count();
            format!("{failed} of {}", g.runs.len())
        })
        .result();
    let against = match &view.against {
        Some(id) => format!(
            "Errors are the {} against {}; peak force and impulse are deviations from it, of the \
             run with the least error. {}",
            view.metric.words(),
            view.reference_name(id),
            if view.results.runs.iter().any(|r| view.is_fitted(r)) {
                "A model whose constants were fitted to this very history is not predicted by it: its error is what the \
                 fit leaves. "
            } else {
                ""
            }
        ),
        None => String::new(),
    };
    let remark =
        format!("{against}The cost ratio is the median over runs at the same method and step.");
    section("At a glance", html! { (table) (note(remark)) })
}
