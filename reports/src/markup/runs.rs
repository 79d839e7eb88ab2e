//! Tables over all runs of a record: metrics, work, ledger, failures.

use super::escape;
use super::table::{Column, Rows, table};
use crate::numbers::{count, quantity, significant};
use crate::record::{Ledger, Metrics, Run, Status};
use crate::view::{View, resolution};

/// All runs in the order of the groups.
fn rows<'a>(view: &View<'a>) -> Vec<&'a Run> {
    (view.groups.iter())
        .flat_map(|g| g.runs.iter().map(|(_, r)| *r))
        .collect()
}

fn groups(view: &View<'_>) -> Vec<Rows> {
    view.groups
        .iter()
        .map(|g| Rows {
            heading: Some((g.label.clone(), g.style)),
            count: g.runs.len(),
            classes: g.runs.iter().map(|(_, r)| class(r)).collect(),
        })
        .collect()
}

fn class(run: &Run) -> &'static str {
    match run.status {
        Status::Converged => "",
        Status::Inaccurate => "inaccurate",
        _ => "failed",
    }
}

fn text(rows: &[&Run], f: impl Fn(&Run) -> String) -> Vec<Option<String>> {
    rows.iter()
        .map(|r| Some(f(r)).filter(|s| !s.is_empty()))
        .collect()
}

/// Highest frequency of the modes of elastic gears.
fn highest(rows: &[&Run]) -> Vec<Option<f64>> {
    rows.iter().map(|r| r.highest_hz).collect()
}

fn identity(rows: &[&Run]) -> Vec<Column> {
    vec![
        Column::written(
            "Modes",
            "",
            text(rows, |r| r.modes.map_or(String::new(), |n| n.to_string())),
        ),
        Column::numbers("up to", "Hz", 3, &highest(rows)),
        Column::text("Integrator", text(rows, |r| r.integrator.clone())),
        Column::text("Step", text(rows, resolution)),
        Column::text("Status", text(rows, |r| r.status.to_string())),
    ]
}

/// Metrics, work, ledger and failures.
pub fn all(view: &View<'_>) -> String {
    metrics(view) + &work(view) + &ledger(view) + &failures(view)
}

/// Metrics against every reference.
pub fn metrics(view: &View<'_>) -> String {
    let rows = rows(view);
    let mut ids: Vec<&str> = Vec::new();
    for m in rows.iter().flat_map(|r| &r.metrics) {
        if !ids.contains(&m.against.as_str()) {
            ids.push(&m.against);
        }
    }
    let mut out = String::new();
    for id in ids {
        type Get = fn(&Metrics) -> Option<f64>;
        let get = |f: Get| -> Vec<Option<f64>> {
            rows.iter().map(|r| r.against(id).and_then(f)).collect()
        };
        let mut columns = identity(&rows);
        columns.extend([
            Column::percents("Force L2", 3, &get(|m| m.force_l2)),
            Column::percents("aligned", 3, &get(|m| m.force_l2_aligned)),
            Column::numbers("Shift", "s", 3, &get(|m| m.time_shift_s)),
            Column::numbers("Peak force", "N", 4, &get(|m| m.peak_force_n)),
            Column::deviations("deviation", &get(|m| m.peak_force_rel)),
            Column::numbers("Impulse", "N s", 4, &get(|m| m.impulse_ns)),
            Column::deviations("deviation", &get(|m| m.impulse_rel)),
            Column::numbers("Contact", "s", 4, &get(|m| m.duration_s)),
            Column::written("\u{3c9}1 end", "rad/s", written(&get(|m| m.omega1_end), 4)),
            Column::written("\u{3c9}2 end", "rad/s", written(&get(|m| m.omega2_end), 4)),
            Column::powers("Energy drift", "", &get(|m| m.energy_drift_rel)),
        ]);
        out.push_str(&format!(
            "<section>\n<h2>Metrics against {}</h2>\n{}<p class=\"note\">Force L2: relative L2 \
             error of the contact-force history on the time grid of the reference, as it is and \
             after the best shift in time (the shift is added to the run's time). Contact: time \
             with more than 1e\u{2212}6 of the peak force. Energy drift: residual of the ledger \
             over its largest entry.</p>\n</section>\n",
            escape(&view.reference_name(id)),
            table(&columns, &groups(view))
        ));
    }
    out
}

fn written(values: &[Option<f64>], digits: usize) -> Vec<Option<String>> {
    values
        .iter()
        .map(|x| x.filter(|x| x.is_finite()).map(|x| significant(x, digits)))
        .collect()
}

/// What the runs cost.
pub fn work(view: &View<'_>) -> String {
    let rows = rows(view);
    if rows.is_empty() {
        return String::new();
    }
    let get =
        |f: fn(&Run) -> Option<f64>| -> Vec<Option<f64>> { rows.iter().map(|r| f(r)).collect() };
    let counts = |f: fn(&Run) -> u64| -> Vec<Option<String>> {
        let any = rows.iter().any(|r| f(r) > 0);
        rows.iter().map(|r| any.then(|| count(f(r)))).collect()
    };
    let spread: Vec<Option<[f64; 2]>> = rows.iter().map(|r| r.wall_spread_s).collect();
    let mut repeats: Vec<u32> = (rows.iter().map(|r| r.repeats))
        .filter(|n| *n > 0)
        .collect();
    repeats.sort_unstable();
    repeats.dedup();
    let repeats = match repeats.as_slice() {
        [] => String::new(),
        [1] => "one timing".into(),
        [n] => format!("median of {n} repeats"),
        [least, .., most] => format!("median of {least} to {most} repeats"),
    };
    let mut columns = identity(&rows);
    columns.extend([
        Column::numbers("Wall time", "s", 3, &get(|r| Some(r.wall_s))),
        Column::ranges("min \u{2013} max", "s", 3, &spread),
        Column::numbers("Setup", "s", 3, &get(|r| Some(r.setup_s))),
        Column::numbers("Simulated", "s", 4, &get(|r| Some(r.simulated_s))),
        Column::written("Steps", "", counts(|r| r.steps)),
        Column::written("Rejected", "", counts(|r| r.rejected)),
        Column::written("Force evals", "", counts(|r| r.force_evaluations)),
        Column::written("Newton it.", "", counts(|r| r.newton_iterations)),
        Column::written("Factoris.", "", counts(|r| r.factorisations)),
        Column::written("Events", "", counts(|r| r.events)),
        Column::written("dof", "", counts(|r| r.dofs as u64)),
    ]);
    format!(
        "<section>\n<h2>Work</h2>\n{}<p class=\"note\">Wall time: {repeats}, without the fixed \
         costs under Setup. The time of a failed run ends where it failed.</p>\n</section>\n",
        table(&columns, &groups(view))
    )
}

/// Energy and impulse ledger.
pub fn ledger(view: &View<'_>) -> String {
    let rows = rows(view);
    if rows.iter().all(|r| r.ledger == Ledger::default()) {
        return String::new();
    }
    let get = |f: fn(&Ledger) -> Option<f64>| -> Vec<Option<f64>> {
        rows.iter().map(|r| f(&r.ledger)).collect()
    };
    let mut columns = identity(&rows);
    columns.extend([
        Column::numbers("Start", "J", 5, &get(|l| l.energy_start_j)),
        Column::numbers("Loads", "J", 4, &get(|l| l.external_work_j)),
        Column::numbers("Parametric", "J", 3, &get(|l| l.parametric_work_j)),
        Column::numbers("Dissipated", "J", 3, &get(|l| l.dissipated_j)),
        Column::numbers("End", "J", 5, &get(|l| l.energy_end_j)),
        Column::numbers("kinetic", "J", 4, &get(|l| l.kinetic_j)),
        Column::numbers("strain", "J", 3, &get(|l| l.strain_j)),
        Column::numbers("contact", "J", 3, &get(|l| l.contact_j)),
        Column::powers("Residual", "J", &get(|l| l.residual_j)),
        Column::powers("relative", "", &get(|l| l.residual_rel)),
        Column::numbers("Impulse", "N s", 4, &get(|l| l.impulse_ns)),
        Column::powers("Invariant drift", "", &get(|l| l.invariant_drift_rel)),
    ]);
    format!(
        "<section>\n<h2>Energy and impulse ledger</h2>\n{}<p class=\"note\">End = start + work of \
         loads + parametric work \u{2212} dissipated + residual; the residual is the integrator's \
         own. Parametric work is done by stiffness that varies along the path of contact. \
         Invariant drift: change of L1/rb1 \u{2212} L2/rb2 over the impulse.</p>\n</section>\n",
        table(&columns, &groups(view))
    )
}

/// Every run that fell short, with the reason.
pub fn failures(view: &View<'_>) -> String {
    let short: Vec<&Run> = (rows(view).into_iter())
        .filter(|r| r.status != Status::Converged)
        .collect();
    if short.is_empty() {
        return "<section>\n<h2>Failures</h2>\n<p>Every run converged.</p>\n</section>\n".into();
    }
    let reason = |r: &Run| match (&r.message, r.status) {
        (Some(message), _) => message.clone(),
        (None, Status::Inaccurate) => match (view.error(r), &view.results.tolerance) {
            (Some(e), Some(t)) => format!(
                "{} {}, tolerance {}",
                view.metric.words(),
                view.error_text(e),
                view.error_text(t.limit)
            ),
            _ => "no reason recorded".into(),
        },
        _ => "no reason recorded".into(),
    };
    let columns = [
        Column::text("Model", text(&short, Run::model_label)),
        Column::text("Integrator", text(&short, |r| r.integrator.clone())),
        Column::text("Step", text(&short, resolution)),
        Column::text("Status", text(&short, |r| r.status.to_string())),
        Column::written(
            "Reached",
            "",
            text(&short, |r| quantity(r.simulated_s, "s", 3)),
        ),
        Column::text("Reason", text(&short, reason)),
    ];
    let all = [Rows {
        heading: None,
        count: short.len(),
        classes: short.iter().map(|r| class(r)).collect(),
    }];
    format!(
        "<section>\n<h2>Failures and shortfalls</h2>\n{}</section>\n",
        table(&columns, &all)
    )
}
