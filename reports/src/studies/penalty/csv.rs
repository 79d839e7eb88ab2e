//! CSV table of runs by penalty.

use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;
use crate::metrics::Metric;
use crate::record::{Results, Run};
use crate::studies::runs::{STATIC_ERROR, identity, work};

/// Returns the table with a row per run.
pub fn tables(results: &Results) -> Vec<CsvTable> {
    vec![columns().table(&results.runs)]
}

/// Returns the columns of runs.
#[rustfmt::skip]
pub fn columns<'a>() -> Columns<'a, &'a Run> {
    let first = |m: Metric| move |r: &&Run| r.metrics.first()?.get(m);
    let to_hard = |m: Metric| move |r: &&Run| r.against("hard")?.get(m);
    Columns::<&Run>::of("penalty.csv", "`penalty`: one row per run.")
        .join(identity().only(&["model", "penalty_pa_per_m"]), |r| Some(*r))
        .add("hard", "hard contact", |r| r.hard.unwrap_or(false))
        .status(|r| r.status).shown("Status", Format::Text)
        .add("peak_force_n", Metric::PeakForce.meaning(), first(Metric::PeakForce)).shown("Peak force", Format::Numbers(5))
        .add("impulse_ns", Metric::Impulse.meaning(), first(Metric::Impulse)).shown("Impulse", Format::Numbers(5))
        .add("static_transmission_error_m", STATIC_ERROR, |r| r.static_error_m).shown("Static TE, mean", Format::Numbers(5))
        .add("force_l2_to_hard", "relative L2 error of the force history against hard contact", to_hard(Metric::ForceL2))
        .add("peak_force_rel_to_hard", "deviation of the peak force from hard contact", to_hard(Metric::PeakForceRel))
        .add("impulse_rel_to_hard", "deviation of the impulse from hard contact", to_hard(Metric::ImpulseRel))
        .join(identity().only(&["integrator", "step_s"]), |r| Some(*r))
        .join(work().only(&["wall_s"]), |r| Some(*r))
}
