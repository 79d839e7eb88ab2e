//! The table `runs.csv` of every study: a row per run with all its scalar quantities.
//!
//! Studies with runs in the record share the columns below. For the others (cells of a map, candidates, modes, fits)
//! the file repeats the first table of the study.

use super::sweep;
use crate::csv_table::{CsvColumn, CsvTable, number, text};
use crate::metrics::{Metric, orders::KEPT};
use crate::record::{Ledger, Results, Run};
use crate::studies::Study;

/// Name of the file.
pub const RUNS: &str = "runs.csv";

/// A column of runs that may depend on the record, such as on the ids of its references.
type Column<'c> = (String, Box<dyn Fn(&Run) -> String + 'c>);

/// Returns the columns that identify a run within its study, and its status.
pub fn identity() -> [CsvColumn<'static, Run>; 17] {
    [
        ("model", &|r| r.model_label()),
        ("modes", &|r| text(&r.modes)),
        ("highest_hz", &|r| number(r.highest_hz)),
        ("residual", &|r| text(&r.residual)),
        ("choose", &|r| text(&r.choose)),
        ("penalty_pa_per_m", &|r| number(r.penalty_pa_per_m)),
        ("hard", &|r| text(&r.hard)),
        ("integrator", &|r| r.integrator.clone()),
        ("implicit", &|r| r.implicit.to_string()),
        ("step_s", &|r| number(r.step)),
        ("rtol", &|r| number(r.rtol)),
        ("status", &|r| r.status.to_string()),
        ("message", &|r| text(&r.message)),
        ("fitted_to", &|r| text(&r.fitted_to)),
        ("calibration", &|r| text(&r.calibration)),
        ("reached_s", &|r| number(r.simulated_s)),
        ("static_transmission_error_m", &|r| number(r.static_error_m)),
    ]
}

/// Returns the columns with the cost of a run: times, steps, evaluations, factorisations.
pub fn work() -> [CsvColumn<'static, Run>; 12] {
    [
        ("cpu_s", &|r| number(r.cpu_s)),
        ("wall_s", &|r| number(r.wall_s)),
        ("wall_min_s", &|r| number(r.wall_spread_s.map(|s| s[0]))),
        ("wall_max_s", &|r| number(r.wall_spread_s.map(|s| s[1]))),
        ("repeats", &|r| r.repeats.to_string()),
        ("setup_s", &|r| number(r.setup_s)),
        ("steps", &|r| r.steps.to_string()),
        ("rejected", &|r| r.rejected.to_string()),
        ("force_evaluations", &|r| r.force_evaluations.to_string()),
        ("newton_iterations", &|r| r.newton_iterations.to_string()),
        ("factorisations", &|r| r.factorisations.to_string()),
        ("dofs", &|r| r.dofs.to_string()),
    ]
}

/// Returns the columns of the ledger of energy and impulse.
fn ledger() -> [CsvColumn<'static, Ledger>; 13] {
    [
        ("energy_start_j", &|l| number(l.energy_start_j)),
        ("energy_end_j", &|l| number(l.energy_end_j)),
        ("kinetic_energy_end_j", &|l| number(l.kinetic_j)),
        ("strain_energy_end_j", &|l| number(l.strain_j)),
        ("contact_energy_end_j", &|l| number(l.contact_j)),
        ("external_work_j", &|l| number(l.external_work_j)),
        ("dissipated_j", &|l| number(l.dissipated_j)),
        ("energy_jumps_j", &|l| number(l.jumps_j)),
        ("energy_residual_j", &|l| number(l.residual_j)),
        ("energy_rel", &|l| number(l.residual_rel)),
        ("energy_vibrating_j", &|l| number(l.vibrating_j)),
        ("ledger_impulse_ns", &|l| number(l.impulse_ns)),
        ("invariant_drift_rel", &|l| number(l.invariant_drift_rel)),
    ]
}

/// Returns columns of a part of the run; their cells are empty where the run lacks the part.
fn of_part<'c, T: 'static>(
    columns: impl IntoIterator<Item = CsvColumn<'static, T>>,
    part: impl Fn(&Run) -> Option<&T> + Copy + 'c,
) -> impl Iterator<Item = Column<'c>> {
    columns.into_iter().map(move |(name, cell)| {
        let cell = move |r: &Run| part(r).map_or(String::new(), cell);
        (
            name.to_owned(),
            Box::new(cell) as Box<dyn Fn(&Run) -> String>,
        )
    })
}

/// Metrics that do not depend on a reference, so that every comparison has them.
const RESULTS: [(&str, Metric); 8] = [
    ("peak_force_n", Metric::PeakForce),
    ("rms_force_n", Metric::RmsForce),
    ("impulse_ns", Metric::Impulse),
    ("transmission_error_pp_m", Metric::TransmissionErrorSpan),
    ("time_in_contact_s", Metric::Duration),
    ("omega1_end_rad_s", Metric::Omega1End),
    ("omega2_end_rad_s", Metric::Omega2End),
    ("energy_drift_rel", Metric::EnergyDrift),
];

/// Returns the table of all runs of a record with all their scalars; a column in which no run has a value is left out.
fn table(results: &Results) -> CsvTable {
    fn of_run(r: &Run) -> Option<&Run> {
        Some(r)
    }
    fn of_ledger(r: &Run) -> Option<&Ledger> {
        Some(&r.ledger)
    }
    fn of_steady(r: &Run) -> Option<&crate::record::Steady> {
        r.steady.as_ref()
    }
    let mut columns: Vec<Column<'_>> = of_part(identity(), of_run).collect();
    columns.extend(RESULTS.map(|(name, metric)| -> Column<'_> {
        let cell = move |r: &Run| number(r.metrics.first().and_then(|m| m.get(metric)));
        (name.to_owned(), Box::new(cell))
    }));
    columns.extend((1..=KEPT).map(|n| -> Column<'_> {
        let order =
            move |r: &Run| Some(*r.metrics.first()?.transmission_error_orders_m.get(n - 1)?);
        let cell = move |r: &Run| number(order(r));
        (format!("transmission_error_{n}_m"), Box::new(cell))
    }));
    let mut references: Vec<&str> = Vec::new();
    for m in results.runs.iter().flat_map(|r| &r.metrics) {
        if !references.contains(&m.against.as_str()) {
            references.push(&m.against);
        }
    }
    for id in references {
        let errors = Metric::ALL.into_iter().filter(|m| m.is_error());
        let errors = errors.filter(|m| *m != Metric::EnergyDrift);
        for metric in errors.chain([Metric::TimeShift]) {
            let name = match metric {
                Metric::TimeShift => format!("time_shift_against_{id}_s"),
                other => format!("{}_against_{id}", other.key()),
            };
            let cell = move |r: &Run| number(r.against(id).and_then(|m| m.get(metric)));
            columns.push((name, Box::new(cell)));
        }
    }
    columns.extend(of_part(sweep::steady_columns(), of_steady));
    columns.extend(of_part(ledger(), of_ledger));
    columns.extend(of_part(work(), of_run));
    let rows = || results.runs.iter();
    columns.retain(|(_, cell)| rows().any(|r| !cell(r).is_empty()));
    let header = std::iter::once("run".to_owned());
    let row = |(i, r): (usize, &Run)| {
        let cells = columns.iter().map(|(_, cell)| cell(r));
        std::iter::once((i + 1).to_string()).chain(cells).collect()
    };
    CsvTable {
        file: RUNS.into(),
        header: header.chain(columns.iter().map(|c| c.0.clone())).collect(),
        rows: rows().enumerate().map(row).collect(),
    }
}

/// Returns `runs.csv` of a record whose study has written `tables`; `None` where nothing was run.
pub fn of_study(results: &Results, tables: &[CsvTable]) -> Option<CsvTable> {
    match results.study() {
        Study::Compare
        | Study::Precision
        | Study::Truncation
        | Study::Penalty
        | Study::Sweep
        | Study::RunUp
            if !results.runs.is_empty() =>
        {
            Some(table(results))
        }
        _ => tables.first().map(|t| CsvTable {
            file: RUNS.into(),
            ..t.clone()
        }),
    }
}
