//! Tables at a glance: results of each model compared with those of the yardstick, and, in a table of its own, the
//! error of the integration of each model.

use super::finding::costs;
use crate::markup::table::Table;
use crate::markup::{glance as section, note, section as plain};
use crate::metrics::{FinishedRun, Metric, compare_all};
use crate::numbers::{quantity, significant};
use crate::record::{Ledger, Metrics, Run, SELF};
use crate::view::{Group, View, resolution};
use maud::{Markup, html};

/// A row: a model by its most accurate run, or the yardstick.
struct Row<'v, 'a> {
    view: &'v View<'a>,
    label: String,
    results: Metrics,
    of: Option<(&'v Group<'a>, &'a Run)>,
}

impl Row<'_, '_> {
    /// True if the scene of the row has errors of models.
    fn is_of_models(&self) -> bool {
        self.view.is_of_models()
    }
}

/// Returns the metrics of a reference itself.
fn of_reference<'v, 'a>(view: &'v View<'a>) -> Option<Row<'v, 'a>> {
    let reference = view.reference()?;
    let end = *reference.series.time_s.last()?;
    let ledger = Ledger::default();
    let own = FinishedRun::reached(&reference.series, &ledger, [end, end]).ok()?;
    Some(Row {
        view,
        label: view.with_scene(&view.reference_name(&reference.id)),
        results: compare_all(own, &reference.all_series(), &reference.id),
        of: None,
    })
}

/// Returns the rows of a scene, the yardstick first.
fn rows<'v, 'a>(view: &'v View<'a>) -> Vec<Row<'v, 'a>> {
    let mut rows: Vec<Row<'v, 'a>> = Vec::new();
    let is_run = |r: &Run| view.is_yardstick(r);
    // A yardstick that is a model of the study has a row of its own anyway.
    if !view.groups.is_empty() && !view.results.runs.iter().any(is_run) {
        rows.extend(of_reference(view));
    }
    for group in &view.groups {
        let run = match view.best(group) {
            Some((_, run)) => *run,
            None => match group.runs.first() {
                Some((_, run)) => run,
                None => continue,
            },
        };
        let against = view.against.as_deref().and_then(|id| run.against(id));
        rows.push(Row {
            view,
            label: group.label.clone(),
            results: against.or(run.metrics.first()).cloned().unwrap_or_default(),
            of: Some((group, run)),
        });
    }
    rows
}

/// Returns the table with a row per scene and model, the yardstick of each scene first.
pub fn glance(views: &[View<'_>]) -> Markup {
    let rows: Vec<Row<'_, '_>> = views.iter().flat_map(rows).collect();
    if rows.is_empty() {
        return Markup::default();
    }
    let ratios: Vec<(String, f64)> = views.iter().flat_map(costs).collect();
    let result = |m: Metric| move |row: &Row<'_, '_>| row.results.get(m);
    let table = Table::of(&rows)
        .text("Model", |row| row.label.clone())
        .text("Calibration", |row| {
            let (g, _) = row.of?;
            g.runs.iter().find_map(|(_, r)| r.calibration.clone())
        })
        .numbers("Peak force", "N", 4, result(Metric::PeakForce))
        .text("Its mesh", |row| {
            row.results.mesh(Metric::PeakForce).map(str::to_owned)
        })
        .numbers("Rms force", "N", 4, result(Metric::RmsForce))
        .numbers("Impulse", "N s", 4, result(Metric::Impulse))
        .numbers(
            "Transmission error, peak to peak",
            "m",
            4,
            result(Metric::TransmissionErrorSpan),
        )
        .written("Error", "", |row| {
            let (_, run) = row.of.filter(|_| row.is_of_models())?;
            match row.view.is_yardstick(run) {
                true => Some("the yardstick".into()),
                false => row.view.error(run).map(|e| row.view.error_text(e)),
            }
        })
        .result()
        .text("Mesh of the error", |row| {
            row.of.filter(|_| row.is_of_models())?;
            row.results.mesh(row.view.metric).map(str::to_owned)
        })
        .text("Error is", |row| {
            let (_, run) = row.of.filter(|_| row.is_of_models())?;
            if row.view.is_yardstick(run) {
                return None;
            }
            row.view.error(run)?;
            let fitted = row.view.is_fitted(run);
            Some(
                if fitted {
                    "rest of a fit"
                } else {
                    row.view.kind_of_error()
                }
                .to_string(),
            )
        })
        .text("Verdict", |row| {
            let (_, run) = row.of.filter(|(_, r)| !row.view.is_yardstick(r))?;
            row.view.verdict(run).map(|v| v.to_string())
        })
        .result()
        .text("Most accurate run", |row| {
            let (_, run) = row.of.filter(|(_, r)| !row.view.is_yardstick(r))?;
            row.view.error(run).filter(|_| row.is_of_models())?;
            Some(named(run))
        })
        .result()
        .written("Its processor time", "", |row| {
            let (_, run) = row.of.filter(|(_, r)| !row.view.is_yardstick(r))?;
            row.view.error(run).filter(|_| row.is_of_models())?;
            Some(quantity(run.cost_s(), "s", 3))
        })
        .result()
        .text("Cheapest adequate run", |row| {
            row.view.cheapest(row.of?.0).map(|(_, r)| named(r))
        })
        .result()
        .written("Its processor time", "", |row| {
            row.view
                .cheapest(row.of?.0)
                .map(|(_, r)| quantity(r.cost_s(), "s", 3))
        })
        .result()
        .written("Cost ratio", "", |row| {
            let (g, _) = row.of?;
            if row.view.is_first(g) && !ratios.is_empty() {
                return Some("1".into());
            }
            let (_, ratio) = ratios.iter().find(|(label, _)| *label == g.label)?;
            Some(significant(*ratio, 3))
        })
        .written("Failed", "", |row| {
            let (g, _) = row.of?;
            let failed = g.runs.iter().filter(|(_, r)| r.status.is_failure()).count();
            Some(format!("{failed} of {}", g.runs.len()))
        });
    let against: Vec<String> = views.iter().map(against).collect();
    let mut against = against;
    against.dedup();
    let remark = format!(
        "{}The cost ratio is the median over runs at the same method and step{}.",
        against.concat(),
        match views.len() {
            1 => "",
            _ => ", to the first model of the scene",
        }
    );
    section("At a glance", html! { (table) (note(remark)) })
}

/// Returns the sentences on the errors of a scene.
fn against(view: &View<'_>) -> String {
    match &view.against {
        Some(id) if view.is_of_models() => format!(
            "{} the {} against {}, of the most accurate run of each model. {}",
            match view.scene {
                Some(scene) => format!("Errors of {scene} are"),
                None => "Errors are".into(),
            },
            view.metric.words(),
            view.reference_name(id),
            if view.results.runs.iter().any(|r| view.is_fitted(r)) {
                "A model whose constants were fitted to this very history is not predicted by it: its error is what the \
                 fit leaves. "
            } else {
                ""
            }
        ),
        _ => "Nothing more detailed than the models is in the record, so that they have no error here. ".to_owned(),
    }
}

/// Returns the table with the least error of each model against every reference that is not the yardstick.
pub fn others(view: &View<'_>) -> Markup {
    let compared = |id: &str| view.results.runs.iter().any(|r| r.against(id).is_some());
    let further = (view.results.references.iter())
        .filter(|r| Some(&r.id) != view.against.as_ref() && compared(&r.id));
    let further: Vec<_> = further.collect();
    if further.is_empty() || view.groups.is_empty() {
        return Markup::default();
    }
    let mut table = Table::of(&view.groups).text("Model", |g| g.label.clone());
    for r in &further {
        let metric = view.metric;
        let least = |g: &Group<'_>| {
            let ended = g.runs.iter().filter(|(_, run)| !run.status.is_failure());
            let errors = ended.filter_map(|(_, run)| run.against(&r.id)?.get(metric));
            errors.map(f64::abs).min_by(f64::total_cmp)
        };
        let heading = view.reference_name(&r.id);
        table = match metric.unit() {
            "" => table.percents(&heading, 3, least),
            unit => table.numbers(&heading, unit, 3, least),
        };
    }
    let notes: Vec<String> = (further.iter())
        .filter(|r| !r.note.is_empty())
        .map(|r| format!("{}: {}.", view.reference_name(&r.id), r.note))
        .collect();
    let remark = format!(
        "Errors as at a glance, of the run with the least error. {} A model on the mesh of a reference is compared like \
         with like: its error is how well programs agree on one mesh, not how far either is off.",
        notes.join(" ")
    );
    plain("Other references", html! { (table) (note(remark)) })
}

/// Returns method and step of a run.
fn named(run: &Run) -> String {
    format!("{}, {}", run.integrator, resolution(run))
}

/// Returns the table of integration errors: the most accurate and the cheapest converged run of each model against its
/// own converged solution.
pub fn integration<'a>(view: &View<'a>) -> Markup {
    let metric = Metric::ForceL1;
    let own = |r: &Run| r.against(SELF)?.get(metric).map(f64::abs);
    let usable = |g: &Group<'a>| {
        let runs = g.runs.iter().map(|(_, r)| *r);
        let error = |r: &'a Run| Some((r, own(r).filter(|_| !r.status.is_failure())?));
        runs.filter_map(error).collect::<Vec<(&Run, f64)>>()
    };
    if view.groups.iter().all(|g| usable(g).is_empty()) {
        return Markup::default();
    }
    let least = |g: &Group<'a>| {
        let runs = usable(g).into_iter();
        runs.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let fast = |g: &Group<'a>| {
        let close = usable(g).into_iter().filter(|(_, e)| *e <= CLOSE);
        close.min_by(|a, b| a.0.cost_s().total_cmp(&b.0.cost_s()))
    };
    let table = Table::of(&view.groups)
        .text("Model", |g| g.label.clone())
        .percents("Least error", 3, |g| Some(least(g)?.1))
        .result()
        .text("Under", |g| least(g).map(|(r, _)| named(r)))
        .text("Cheapest run within 1 %", |g| {
            fast(g).map(|(r, _)| named(r))
        })
        .result()
        .percents("Its error", 3, |g| Some(fast(g)?.1))
        .written("Its processor time", "", |g| {
            fast(g).map(|(r, _)| quantity(r.cost_s(), "s", 3))
        })
        .result();
    let remark = "The relative L1 error of the contact force of a run against the converged solution of its own model: what \
                  method and step add, whatever the model itself is off.";
    plain("Integration", html! { (table) (note(remark)) })
}

/// Error of integration up to which a run counts as integrated closely [-].
const CLOSE: f64 = 0.01;
