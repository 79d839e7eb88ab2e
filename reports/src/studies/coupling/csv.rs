//! CSV table of runs coupled to a host, a row per model and communication step.

use super::{Coupling, CouplingCell};
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;

/// A run with its coupling.
pub type Row<'a> = (&'a Coupling, &'a CouplingCell);

/// Returns the table with a row per run.
pub fn tables(couplings: &[Coupling]) -> Vec<CsvTable> {
    let rows = (couplings.iter()).flat_map(|c| c.all().into_iter().map(move |cell| (c, cell)));
    vec![columns().table(rows)]
}

/// Returns the columns of runs.
#[rustfmt::skip]
pub fn columns<'a>() -> Columns<'a, Row<'a>> {
    Columns::<Row<'_>>::of("coupling.csv", "`coupling`: one row per run.")
        .model(|(c, _)| c.model_label())
        .add("extrapolation", "extrapolation of the forces on hubs of a host: `constant`, `linear`, `quadratic`", |(c, _)| c.extrapolation)
        .add("motion", "interpolation of the motion of hubs between communication points: `linear`, `cubic`", |(c, _)| c.motion)
        .add("communication_step_s", "communication step of host and gears", |(_, x)| x.step_s).shown("Communication step", Format::Quantities(3))
        .status(|(_, x)| x.status).shown("Status", Format::Text)
        .add("force_l2", "relative L2 error of the force history", |(_, x)| x.force_l2).shown("Force, L2", Format::Percents(3)).result()
        .add("rebound_rel", "greatest error of a final speed over the range of that speed", |(_, x)| x.rebound_rel).shown("Speeds at the end", Format::Percents(3)).result()
        .add("energy_error_j", "work of the extrapolated forces on the host minus work of the gears along their motion, over the run", |(_, x)| x.energy_error_j)
        .add("energy_error_rel", "`energy_error_j` over the energy of vibration and the work through contacts of the uncoupled run", |(_, x)| x.energy_error_rel).shown("Energy error", Format::Percents(3)).result()
        .add("energy_error_step_rel", "its greatest magnitude in one communication step, over the same energy", |(_, x)| x.energy_error_step_rel).shown("Largest in a step", Format::Percents(3))
        .add("exchanges", "communication steps", |(_, x)| x.exchanges)
        .add("theory_step_s", "communication step above which, by linear theory, the coupling generates more energy than allowed", |(c, _)| c.theory_s)
        .integrator(|(c, _)| c.integrator.clone())
        .step(|(c, _)| c.step_s)
        .message(|(_, x)| x.message.clone()).shown("Why", Format::Text)
}
