//! CSV table of runs coupled to a host, a row per model and communication step.

use super::{Coupling, CouplingCell};
use crate::csv_table::{CsvTable, number};

/// Returns the table with a row per run.
pub fn tables(couplings: &[Coupling]) -> Vec<CsvTable> {
    type Row<'a> = (&'a Coupling, &'a CouplingCell);
    let rows = (couplings.iter()).flat_map(|c| c.all().into_iter().map(move |cell| (c, cell)));
    vec![CsvTable::new::<Row<'_>>(
        "coupling.csv",
        rows,
        &[
            ("model", &|(c, _)| c.model_label()),
            ("extrapolation", &|(c, _)| c.extrapolation.to_string()),
            ("motion", &|(c, _)| c.motion.to_string()),
            ("communication_step_s", &|(_, x)| number(x.step_s)),
            ("status", &|(_, x)| x.status.to_string()),
            ("force_l2", &|(_, x)| number(x.force_l2)),
            ("rebound_rel", &|(_, x)| number(x.rebound_rel)),
            ("energy_error_j", &|(_, x)| number(x.energy_error_j)),
            ("energy_error_rel", &|(_, x)| number(x.energy_error_rel)),
            ("energy_error_step_rel", &|(_, x)| {
                number(x.energy_error_step_rel)
            }),
            ("exchanges", &|(_, x)| x.exchanges.to_string()),
            ("theory_step_s", &|(c, _)| number(c.theory_s)),
            ("integrator", &|(c, _)| c.integrator.clone()),
            ("step_s", &|(c, _)| number(c.step_s)),
            ("message", &|(_, x)| x.message.clone().unwrap_or_default()),
        ],
    )]
}
