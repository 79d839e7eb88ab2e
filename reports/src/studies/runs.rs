//! The table `runs.csv` of every study: a row per run with all its scalar quantities.
//!
//! Studies with runs in the record share the columns below. For the others (cells of a map, candidates, modes, fits)
//! the file repeats the first table of the study.

use super::sweep;
use crate::columns::{Columns, up_to};
use crate::csv_table::CsvTable;
use crate::markup::column::Format;
use crate::metrics::{Metric, orders::KEPT};
use crate::record::{Ledger, Results, Run, speed_end};
use crate::studies::Study;

/// Name of the file.
pub const RUNS: &str = "runs.csv";

/// A run with its place in the record.
type Row<'a> = (usize, &'a Run);

/// Returns the columns that identify a run within its study, and its status.
#[rustfmt::skip]
pub fn identity<'a>() -> Columns<'a, &'a Run> {
    Columns::<&Run>::of("", "")
        .model(|r| r.model_label())
        .modes(|r| r.modes)
        .add("highest_hz", "highest frequency among the modes", |r| r.highest_hz).shown("Highest mode", Format::Numbers(3))
        .add("residual", "whether the truncated modes are represented by residual compliance", |r| r.residual)
        .add("choose", "choice of the modes", |r| r.choose.clone())
        .integrator(|r| r.integrator.clone())
        .add("implicit", "the method is implicit", |r| r.implicit)
        .step(|r| r.step)
        .rtol(|r| r.rtol)
        .status(|r| r.status).shown("Status", Format::Text)
        .message(|r| r.message.clone())
        .add("fitted_to", "reference to which the model's constants were fitted", |r| r.fitted_to.clone())
        .add("calibration", "calibration of its stiffness", |r| r.calibration.clone())
        .add("reached_s", "time reached", |r| r.simulated_s).shown("Simulated", Format::Numbers(4))
}

/// Returns the columns with the cost of a run: times, steps, evaluations, factorisations.
#[rustfmt::skip]
pub fn work<'a>() -> Columns<'a, &'a Run> {
    Columns::<&Run>::of("", "")
        .add("cpu_s", "processor time of the integration, median of the repeats; other work on the machine does not change it", |r| r.cpu_s)
        .add("wall_s", "wall time, median of the repeats", |r| r.wall_s).shown("Wall time", Format::Numbers(3)).result()
        .add("wall_min_s", "shortest wall time", |r| r.wall_spread_s.map(|s| s[0]))
        .add("wall_max_s", "longest wall time", |r| r.wall_spread_s.map(|s| s[1]))
        .add("repeats", "timed repeats; 0 where the recorded run itself was timed", |r| r.repeats)
        .add("setup_s", "wall time before the first step", |r| r.setup_s).shown("Setup", Format::Numbers(3))
        .add("steps", "accepted steps", |r| r.steps).shown("Steps", Format::Counts).result()
        .add("rejected", "rejected steps", |r| r.rejected).shown("Rejected steps", Format::Counts)
        .add("force_evaluations", "evaluations of the contact forces", |r| r.force_evaluations).shown("Force evaluations", Format::Counts).result()
        .add("newton_iterations", "iterations of Newton's method", |r| r.newton_iterations).shown("Newton iterations", Format::Counts)
        .add("factorisations", "factorisations of the Newton matrix", |r| r.factorisations).shown("Factorisations", Format::Counts)
        .add("dofs", "coordinates", |r| r.dofs).shown("Degrees of freedom", Format::Counts)
}

/// Returns the columns of the ledger of energy and impulse.
#[rustfmt::skip]
pub fn ledger<'a>() -> Columns<'a, &'a Ledger> {
    Columns::<&Ledger>::of("", "")
        .add("energy_start_j", "total energy at the start", |l| l.energy_start_j).shown("Start", Format::Numbers(5))
        .add("energy_end_j", "total energy at the end", |l| l.energy_end_j).shown("End", Format::Numbers(5))
        .add("kinetic_energy_end_j", "kinetic energy at the end", |l| l.kinetic_j).shown("of it kinetic", Format::Numbers(4))
        .add("strain_energy_end_j", "strain energy of bodies and tooth springs at the end", |l| l.strain_j).shown("of it strain", Format::Numbers(3))
        .add("contact_energy_end_j", "energy stored by the contact laws at the end", |l| l.contact_j).shown("of it in contact", Format::Numbers(3))
        .add("external_work_j", "work of loads and drives", |l| l.external_work_j).shown("Loads", Format::Numbers(4))
        .add("dissipated_j", "energy dissipated by damping and friction", |l| l.dissipated_j).shown("Dissipated", Format::Numbers(3))
        .add("energy_jumps_j", "jumps of energy where a branch changes, such as a pair that enters contact with its whole force", |l| l.jumps_j)
        .add("energy_residual_j", "unexplained energy: error of the integration", |l| l.residual_j).shown("Residual", Format::Powers)
        .add("energy_rel", "unexplained energy over the largest entry of the ledger", |l| l.residual_rel).shown("Residual, relative", Format::Powers).result()
        .add("energy_vibrating_j", "greatest energy of strain, contact and relative motion, plus the work through contacts: the scale for energy growth", |l| l.vibrating_j).shown("Vibrating", Format::Numbers(3))
        .add("ledger_impulse_ns", "impulse of the contact force along the line of action", |l| l.impulse_ns).shown("Impulse", Format::Numbers(4))
        .add("invariant_drift_rel", "drift of the momentum invariant L1/r_b1 - L2/r_b2 over the impulse", |l| l.invariant_drift_rel).shown("Invariant drift", Format::Powers).result()
}

/// Metrics that do not depend on a reference, so that every comparison has them.
const RESULTS: [(&str, Metric); 6] = [
    ("peak_force_n", Metric::PeakForce),
    ("rms_force_n", Metric::RmsForce),
    ("impulse_ns", Metric::Impulse),
    ("transmission_error_pp_m", Metric::TransmissionErrorSpan),
    ("time_in_contact_s", Metric::Duration),
    ("energy_drift_rel", Metric::EnergyDrift),
];

/// Returns the columns of runs with all their scalars, for some gears, orders and references.
pub fn columns<'a>(
    gears: &[String],
    orders: &[String],
    references: &[String],
) -> Columns<'a, Row<'a>> {
    let mut columns = Columns::<Row<'_>>::of(
        RUNS,
        "Every study: one row per run with every scalar quantity of the record; columns without any value are left out.",
    )
    .add("run", "position of the run in the record, from 1", |(i, _)| i + 1)
    .join(identity(), |(_, r)| Some(*r));
    for (key, metric) in RESULTS {
        let value = move |(_, r): &Row<'_>| r.metrics.first()?.get(metric);
        columns = columns.add(key, metric.meaning(), value);
    }
    for gear in gears {
        let of = gear.clone();
        columns = columns.add(
            speed_end(gear),
            "final angular velocity of the gear",
            move |(_, r)| r.metrics.first()?.speed_end(&of),
        );
    }
    columns = columns.numbered(
        orders,
        "transmission_error_N_m",
        "amplitude of the N-th harmonic of the mesh frequency in the transmission error",
        |(_, r), k| {
            let orders = &r.metrics.first()?.transmission_error_orders_m;
            orders.get(k).copied()
        },
    );
    for id in references {
        let errors = Metric::ALL.into_iter().filter(|m| m.is_error());
        let errors = errors.filter(|m| *m != Metric::EnergyDrift);
        for metric in errors.chain([Metric::TimeShift]) {
            let key = match metric {
                Metric::TimeShift => format!("time_shift_against_{id}_s"),
                other => format!("{}_against_{id}", other.key()),
            };
            let meaning = format!("against the reference {id}: {}", metric.meaning());
            let id = id.clone();
            let value = move |(_, r): &Row<'_>| r.against(&id)?.get(metric);
            columns = columns.add(key, meaning, value);
        }
    }
    columns
        .join(sweep::steady_columns(), |(_, r)| r.steady.as_ref())
        .join(ledger(), |(_, r)| Some(&r.ledger))
        .join(work(), |(_, r)| Some(*r))
}

/// Returns the names of the gears whose last speeds runs have.
pub(crate) fn gears_of<'r>(runs: impl IntoIterator<Item = &'r Run>) -> Vec<String> {
    let mut gears: Vec<String> = Vec::new();
    for (gear, _) in (runs.into_iter())
        .flat_map(|r| &r.metrics)
        .flat_map(|m| &m.speeds_end)
    {
        if !gears.contains(gear) {
            gears.push(gear.clone());
        }
    }
    gears
}

/// Returns the table of all runs of a record with all their scalars; a column in which no run has a value is left out.
fn table(results: &Results) -> CsvTable {
    let mut references: Vec<String> = Vec::new();
    for m in results.runs.iter().flat_map(|r| &r.metrics) {
        if !references.contains(&m.against) {
            references.push(m.against.clone());
        }
    }
    let columns = columns(&gears_of(&results.runs), &up_to(KEPT), &references);
    columns
        .table(results.runs.iter().enumerate())
        .without_empty_columns()
}

/// Returns `runs.csv` of a record whose study has written `tables`; `None` where nothing was run.
pub fn of_study(results: &Results, tables: &[CsvTable]) -> Option<CsvTable> {
    match results.study() {
        Study::Compare | Study::Sweep | Study::RunUp if !results.runs.is_empty() => {
            Some(table(results))
        }
        // A table with several rows for a run, as one for each reference, is no table of runs.
        Study::Tabular
            if !results.runs.is_empty()
                && tables
                    .first()
                    .is_some_and(|t| t.rows.len() > results.runs.len()) =>
        {
            Some(table(results))
        }
        _ => tables.first().map(|t| CsvTable {
            file: RUNS.into(),
            ..t.clone()
        }),
    }
}
