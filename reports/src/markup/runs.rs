//! Tables over all runs of a record: metrics, work, ledger, failures.

use super::table::Table;
use super::{note, section};
use crate::metrics::Metric;
use crate::numbers::{count, quantity, significant};
use crate::record::{Ledger, Run, SELF, Status};
use crate::studies::runs::{self, identity};
use crate::view::{View, capital, resolution};
use maud::{Markup, html};

/// A run with the label and the place of its model.
type Row<'a> = (&'a Run, &'a str, usize);

/// Renders the tables of metrics, work, ledger and failures.
pub fn all(view: &View<'_>) -> Markup {
    html! { (metrics(view)) (work(view)) (ledger(view)) (failures(view)) }
}

/// Returns all runs in the order of the groups.
pub fn rows<'v>(view: &'v View<'_>) -> Vec<Row<'v>> {
    let groups = view.groups.iter();
    groups
        .flat_map(|g| (g.runs.iter()).map(|(_, r)| (*r, g.label.as_str(), g.style)))
        .collect()
}

/// Returns the CSS class of a run's row.
pub fn class(run: &Run) -> &'static str {
    match run.status {
        Status::Converged | Status::Unchecked => "",
        Status::Inaccurate => "inaccurate",
        _ => "failed",
    }
}

/// Returns the run of a row.
fn run<'a>((run, ..): &Row<'a>) -> Option<&'a Run> {
    Some(run)
}

/// Returns the number of modes of a run as a text.
pub fn modes(run: &Run) -> Option<String> {
    run.modes.map(|n| n.to_string())
}

/// Returns a table of runs by model whose first columns identify the run.
fn identified<'r>(view: &View<'_>, rows: &'r [Row<'r>]) -> Table<'r, Row<'r>> {
    Table::of(rows)
        .of_runs(|(r, ..)| view.index_of(r))
        .grouped(|(_, label, style)| ((*label).into(), *style))
        .classed(|(r, ..)| class(r))
        .text("Integrator", |(r, ..)| r.integrator.clone())
        .text("Step", |(r, ..)| resolution(r))
        .key()
        .written("Modes", "", |(r, ..)| modes(r))
        .columns_by_key(&identity(), &["highest_hz", "status"], run)
}

/// Renders the table of metrics against every reference.
fn metrics(view: &View<'_>) -> Markup {
    let rows = rows(view);
    let mut ids: Vec<&str> = Vec::new();
    for m in rows.iter().flat_map(|(r, ..)| &r.metrics) {
        if !ids.contains(&m.against.as_str()) {
            ids.push(&m.against);
        }
    }
    let of = |id: &str| {
        let get = |m: Metric| move |(r, ..): &Row<'_>| r.against(id)?.get(m);
        let mut table = identified(view, &rows);
        // The errors of whole histories, then those of single numbers.
        for m in Metric::ALL.into_iter().filter(|m| m.is_error()) {
            let heading = capital(&m.short());
            table = match m {
                Metric::PeakForceRel
                | Metric::RmsForceRel
                | Metric::ImpulseRel
                | Metric::TransmissionErrorSpanRel
                | Metric::TorquePeakRel => table.deviations(&heading, get(m)),
                Metric::EnergyDrift => table.powers(&heading, "", get(m)),
                _ => table.percents(&heading, 3, |row| get(m)(row).map(f64::abs)),
            };
            table = table.result();
        }
        if id == SELF {
            table = table.text("Converged by", |(r, ..)| {
                r.own_solution
                    .as_ref()
                    .map_or_else(String::new, ToString::to_string)
            });
        }
        let table = table
            .numbers("Shift in time", "s", 3, get(Metric::TimeShift))
            .numbers("Peak force", "N", 4, get(Metric::PeakForce))
            .numbers("Rms force", "N", 4, get(Metric::RmsForce))
            .numbers("Impulse", "N s", 4, get(Metric::Impulse))
            .numbers(
                "Peak-to-peak transmission error",
                "m",
                4,
                get(Metric::TransmissionErrorSpan),
            )
            .numbers("Time in contact", "s", 4, get(Metric::Duration));
        // As in the chart of the speeds, gears have their numbers in the scene.
        let gears = runs::gears_of(rows.iter().map(|(r, ..)| *r)).into_iter();
        gears.enumerate().fold(table, |table, (i, gear)| {
            let speed = move |(r, ..): &Row<'_>| {
                let x = r.against(id)?.speed_end(&gear).filter(|x| x.is_finite())?;
                Some(significant(x, 4))
            };
            table.written(&format!("Last \u{3c9}{}", i + 1), "rad/s", speed)
        })
    };
    html! {
        @for id in &ids {
            section {
                h2 { @if *id == SELF { "Integration errors: metrics against " } @else { "Metrics against " } (view.reference_name(id)) }
                (of(id))
                (note(
                    "Force history: relative error of the contact force over time, as it is and after the best shift in time \
                     (the shift is added to the run's time). Peak force and impulse: deviations. Rebound: largest deviation of \
                     a last speed. Angles and torques: root mean square over the span of the reference's, the largest of all \
                     gears. Transmission error orders: amplitudes at multiples of the mesh frequency over the last whole mesh cycles; \
                     aligned transmission error: what repeats with the mesh cycle, without its mean and after the best \
                     shift. Time in contact: with more than 1e\u{2212}6 of the peak force. Energy drift: residual of \
                     the ledger over its largest entry."
                ))
            }
        }
    }
}

/// Returns the table with the cost of the runs: times, steps, evaluations.
fn work(view: &View<'_>) -> Markup {
    let rows = rows(view);
    if rows.is_empty() {
        return Markup::default();
    }
    let mut repeats: Vec<u32> = (rows.iter().map(|(r, ..)| r.repeats))
        .filter(|n| *n > 0)
        .collect();
    repeats.sort_unstable();
    repeats.dedup();
    let repeats = match repeats.as_slice() {
        [] => String::new(),
        [1] => "one timing, ".into(),
        [n] => format!("median of {n} repeats, "),
        [least, .., most] => format!("median of {least} to {most} repeats, "),
    };
    let work = runs::work();
    let events = rows.iter().any(|(r, ..)| r.events > 0);
    let table = identified(view, &rows)
        .columns_by_key(
            &work,
            &["wall_s", "steps", "force_evaluations", "setup_s"],
            run,
        )
        .ranges("Wall time, least \u{2013} greatest", "s", 3, |(r, ..)| {
            r.wall_spread_s
        })
        .columns_by_key(&identity(), &["reached_s"], run)
        .columns_by_key(
            &work,
            &["rejected", "newton_iterations", "factorisations"],
            run,
        )
        .written("Events", "", |(r, ..)| events.then(|| count(r.events)))
        .columns_by_key(&work, &["dofs"], run);
    let remark = format!(
        "Wall time: {repeats}without the fixed costs under Setup. The time of a failed run ends where it failed."
    );
    section("Work", html! { (table) (note(remark)) })
}

/// Renders the table of the energy and impulse ledger.
fn ledger(view: &View<'_>) -> Markup {
    let rows = rows(view);
    if rows.iter().all(|(r, ..)| r.ledger == Ledger::default()) {
        return Markup::default();
    }
    let columns = runs::ledger();
    fn of<'a>((r, ..): &Row<'a>) -> Option<&'a Ledger> {
        Some(&r.ledger)
    }
    let table = identified(view, &rows)
        .columns_by_key(
            &columns,
            &["energy_start_j", "external_work_j", "dissipated_j"],
            of,
        )
        .numbers("Jumps", "J", 3, |(r, ..)| {
            r.ledger.jumps_j.filter(|j| *j != 0.0)
        })
        .result()
        .columns_by_key(
            &columns,
            &[
                "energy_end_j",
                "kinetic_energy_end_j",
                "strain_energy_end_j",
                "contact_energy_end_j",
                "energy_residual_j",
                "energy_rel",
                "energy_vibrating_j",
                "ledger_impulse_ns",
                "invariant_drift_rel",
            ],
            of,
        );
    let remark = note(
        "End = start + work of loads \u{2212} dissipated + jumps + residual; the residual is the integrator's own. Jumps: what switches brought in, such as a pair of teeth that comes into contact with its whole force. \
         Vibrating: what growth of the energy is judged by. \
         Invariant drift: change of L1/rb1 \u{2212} L2/rb2 over the impulse.",
    );
    section("Energy and impulse ledger", html! { (table) (remark) })
}

/// Renders the table of failed and inaccurate runs with their reasons.
pub fn failures(view: &View<'_>) -> Markup {
    let mut short = rows(view);
    // A run that was not judged by the tolerance of the scene has not passed it.
    let gated = view.results.tolerance.is_some();
    short.retain(|(r, ..)| !r.status.holds() || (gated && r.status == Status::Unchecked));
    if short.is_empty() {
        let unchecked = view
            .results
            .runs
            .iter()
            .any(|r| r.status == Status::Unchecked);
        let said = match unchecked {
            true => {
                "No run failed. Runs called unchecked have a sound energy balance, but were not judged, or are not decided: nothing shows that their error is small enough."
            }
            false => "Every run converged.",
        };
        return section("Failures", html! { p { (said) } });
    }
    let reason = |(r, ..): &Row<'_>| match (&r.message, r.status) {
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
    let table = Table::of(&short)
        .classed(|(r, ..)| class(r))
        .text("Model", |(r, ..)| r.model_label())
        .text("Integrator", |(r, ..)| r.integrator.clone())
        .key()
        .text("Step", |(r, ..)| resolution(r))
        .text("Status", |(r, ..)| r.status.to_string())
        .result()
        .written("Reached", "", |(r, ..)| quantity(r.simulated_s, "s", 3))
        .text("Reason", reason)
        .result();
    section("Failures and shortfalls", table)
}
