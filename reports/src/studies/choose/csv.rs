//! CSV tables of a model choice: its candidates, and the levels of its hierarchy.

use super::{CandidateRecord, ChoiceRecord, LevelRecord};
use crate::csv_table::{CsvTable, number, text};

/// Returns the tables with a row per candidate, and with a row per level.
pub fn tables(choice: &ChoiceRecord) -> Vec<CsvTable> {
    vec![candidates(choice), levels(choice)]
}

fn candidates(choice: &ChoiceRecord) -> CsvTable {
    CsvTable::new::<(usize, &CandidateRecord)>(
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
    )
}

fn levels(choice: &ChoiceRecord) -> CsvTable {
    CsvTable::new::<&LevelRecord>(
        "choose_levels.csv",
        choice.levels.iter(),
        &[
            ("level", &|l| l.name.clone()),
            ("family", &|l| l.family.clone()),
            ("distance", &|l| number(l.distance)),
            ("step_up", &|l| number(l.step_up)),
            ("estimated_error", &|l| number(l.error)),
            ("yardstick_error", &|_| number(choice.yardstick_error)),
            ("tolerance", &|_| choice.tolerance.to_string()),
            ("adequate", &|l| l.adequate.to_string()),
            ("verdict", &|_| choice.answer().to_string()),
            ("setup_s", &|l| number(l.setup_s)),
            ("rms_n", &|l| number(l.statistics.map(|s| s.rms_n))),
            ("spells", &|l| {
                (l.statistics).map_or(String::new(), |s| s.spells.to_string())
            }),
            ("median_peak_n", &|l| {
                number(l.statistics.map(|s| s.median_peak_n))
            }),
            ("greatest_peak_n", &|l| {
                number(l.statistics.map(|s| s.greatest_peak_n))
            }),
            ("failure", &|l| text(&l.failure)),
        ],
    )
}
