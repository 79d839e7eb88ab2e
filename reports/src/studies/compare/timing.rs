//! What the models cost beside each other and beside full finite elements, with times that others publish.

use super::CompareRecord;
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::numbers::{quantity, significant};
use crate::record::Run;
use crate::view::{View, capital, resolution};
use maud::{Markup, html};

/// Coordinates from which on a model that keeps no modes is one of full finite elements.
const FULL: usize = 100;

/// Whether a run is one of full finite elements.
fn is_full(run: &Run) -> bool {
    run.modes.is_none() && run.dofs >= FULL
}

/// Processor time by model; nothing without a full model and another one.
pub fn timing(view: &View<'_>, part: &CompareRecord) -> Markup {
    let best: Vec<(&str, &Run)> = (view.groups.iter())
        .filter_map(|g| {
            let (_, run) = view.best(g)?;
            run.cost_s().is_finite().then_some((g.label.as_str(), *run))
        })
        .collect();
    let full = (best.iter())
        .filter(|(_, r)| is_full(r))
        .min_by(|a, b| a.1.cost_s().total_cmp(&b.1.cost_s()));
    let (Some((label, full)), Some((first, base)), true) = (full, best.first(), best.len() > 1)
    else {
        return Markup::default();
    };
    let ratio = |a: f64, b: f64| Some(significant(a / b, 3)).filter(|_| a > 0.0 && b > 0.0);
    let first_published = base.published_s;
    let full_published = (best.iter())
        .filter(|(_, r)| is_full(r))
        .find_map(|(_, r)| r.published_s);
    let over = format!("Over {first}");
    let full_over = format!("{} over it", capital(label));
    let table = Table::of(&best)
        .text("Model", |(label, _)| (*label).to_string())
        .text("Integrator", |(_, r)| {
            format!("{}, {}", r.integrator, resolution(r))
        })
        .key()
        .written("Processor time", "", |(_, r)| quantity(r.cost_s(), "s", 3))
        .result()
        .written(&over, "", |(_, r)| ratio(r.cost_s(), base.cost_s()))
        .result()
        .written(&full_over, "", |(_, r)| ratio(full.cost_s(), r.cost_s()))
        .result()
        .written("Setup", "", |(_, r)| quantity(r.setup_s, "s", 3))
        .written("Published", "", |(_, r)| {
            r.published_s.map(|t| quantity(t, "s", 4))
        })
        .result()
        .written(&format!("{over}, published"), "", |(_, r)| {
            ratio(r.published_s?, first_published?)
        })
        .written(&format!("{full_over}, published"), "", |(_, r)| {
            ratio(full_published?, r.published_s?)
        });
    let source = match &part.published {
        Some(text) => format!(" Published: {text}."),
        None => String::new(),
    };
    let remark = format!(
        "Processor time of one run of {} simulated, setup apart, by the run of each model with the least error; ratios on one \
         machine within this record.{source}",
        quantity(base.simulated_s, "s", 3)
    );
    section("Processor time", html! { (table) (note(remark)) })
}
