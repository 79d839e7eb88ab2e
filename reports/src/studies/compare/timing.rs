//! Processor times of the models compared with each other, with full finite elements and with published times.

use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::numbers::{quantity, short, significant};
use crate::record::{Part, Run};
use crate::view::{View, capital, resolution};
use maud::{Markup, html};

/// Coordinates from which on a model that keeps no modes is one of full finite elements.
const FULL: usize = 100;

/// Processor time of a model, or of a stored reference.
struct Row<'a> {
    label: String,
    /// Integrator and step; of a reference that its time is its own.
    how: String,
    seconds: f64,
    /// True if the model is one of full finite elements.
    full: bool,
    run: Option<&'a Run>,
}

fn rows<'a>(view: &View<'a>) -> Vec<Row<'a>> {
    let models = (view.groups.iter()).filter_map(|g| {
        let (_, run) = view.costed(g)?;
        run.cost_s().is_finite().then(|| Row {
            label: g.label.clone(),
            how: format!("{}, {}", run.integrator, resolution(run)),
            seconds: run.cost_s(),
            full: run.modes.is_none() && run.dofs >= FULL,
            run: Some(run),
        })
    });
    // What another program took for the same scene, on the machine where its data were made.
    let stored = (view.results.references.iter()).filter_map(|r| {
        Some(Row {
            label: view.reference_name(&r.id),
            how: "stored with the reference".into(),
            seconds: r.cpu_s.filter(|_| r.command.is_some())?,
            full: true,
            run: None,
        })
    });
    models.chain(stored).collect()
}

/// Returns the table of processor times by model; empty without full finite elements or without another model.
pub fn timing(view: &View<'_>) -> Markup {
    let rows = rows(view);
    let full = |r: &&Row<'_>| r.full;
    let dearest = (rows.iter().filter(full)).min_by(|a, b| {
        // A run of this record before a time from elsewhere.
        (a.run.is_none(), a.seconds)
            .partial_cmp(&(b.run.is_none(), b.seconds))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let (Some(dearest), Some(base), true) = (dearest, rows.first(), rows.len() > 1) else {
        return Markup::default();
    };
    let ratio = |a: f64, b: f64| Some(significant(a / b, 3)).filter(|_| a > 0.0 && b > 0.0);
    let published = |r: &Row<'_>| r.run.and_then(|r| r.published_s);
    let first_published = published(base);
    let full_published = rows.iter().filter(full).find_map(published);
    let over = format!("Over {}", base.label);
    let full_over = format!("{} over it", capital(&dearest.label));
    let table = Table::of(&rows)
        .text("Model", |r| r.label.clone())
        .text("Integrator", |r| r.how.clone())
        .key()
        .written("Processor time", "", |r| quantity(r.seconds, "s", 3))
        .result()
        .written(&over, "", |r| ratio(r.seconds, base.seconds))
        .result()
        .written(&full_over, "", |r| ratio(dearest.seconds, r.seconds))
        .result()
        .written("Setup", "", |r| r.run.map(|r| quantity(r.setup_s, "s", 3)))
        .written("Published", "", |r| {
            let derived = r.run.is_some_and(|r| r.published_derived);
            let mark = if derived { " (derived)" } else { "" };
            published(r).map(|t| format!("{} s{mark}", short(t, 4)))
        })
        .result()
        .written(&format!("{over}, published"), "", |r| {
            ratio(published(r)?, first_published?)
        })
        .written(&format!("{full_over}, published"), "", |r| {
            ratio(full_published?, published(r)?)
        });
    let published = match &view.results.part {
        Part::Compare(part) => part.published.as_ref(),
        _ => None,
    };
    let source = match published {
        Some(text) => format!(" Published: {text}."),
        None => String::new(),
    };
    let stored = match rows.iter().any(|r| r.run.is_none()) {
        true => " Times stored with references were measured on other machines.",
        false => "",
    };
    let lasts = base.run.map_or(f64::NAN, |r| r.simulated_s);
    let remark = format!(
        "Processor time of one run of {} simulated, setup apart, by the cheapest adequate run of each model, where none is \
         adequate by the most accurate one; ratios within this record.{stored}{source}",
        quantity(lasts, "s", 3)
    );
    section("Processor time", html! { (table) (note(remark)) })
}
