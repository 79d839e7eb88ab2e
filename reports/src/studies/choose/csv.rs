//! The table of what a choice has tried.

use super::{ChoiceRecord, TriedRecord};
use crate::csv_table::{CsvTable, number, text};

/// One line per candidate.
pub fn tables(choice: &ChoiceRecord) -> Vec<CsvTable> {
    vec![CsvTable::new::<(usize, &TriedRecord)>(
        "choose.csv",
        choice.tried.iter().enumerate(),
        &[
            ("level", &|(_, t)| t.level.clone()),
            ("family", &|(_, t)| t.family.clone()),
            ("integrator", &|(_, t)| t.integrator.clone()),
            ("step_s", &|(_, t)| number(t.step_s)),
            ("rtol", &|(_, t)| number(t.rtol)),
            ("estimated_error", &|(_, t)| number(t.error)),
            ("predicted_cost_s", &|(_, t)| number(t.cost_s)),
            ("steps_on_window", &|(_, t)| t.steps.to_string()),
            ("force_evaluations_on_window", &|(_, t)| {
                t.force_evaluations.to_string()
            }),
            ("adequate", &|(_, t)| t.adequate.to_string()),
            ("chosen", &|(i, _)| (choice.chosen == Some(*i)).to_string()),
            ("failure", &|(_, t)| text(&t.failure)),
        ],
    )]
}
