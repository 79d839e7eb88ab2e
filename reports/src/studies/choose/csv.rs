//! CSV tables of a model choice: its candidates, and the levels of its hierarchy.

use super::{CandidateRecord, ChoiceRecord, ForceStatistics, LevelRecord};
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;

/// Returns the tables with a row per candidate, and with a row per level.
pub fn tables(choice: &ChoiceRecord) -> Vec<CsvTable> {
    let tried = choice.tried.iter().enumerate();
    vec![
        candidates().table(tried.map(|(i, t)| (choice, i, t))),
        levels().table(choice.levels.iter().map(|l| (choice, l))),
    ]
}

/// A candidate with its choice and its place there.
type Candidate<'a> = (&'a ChoiceRecord, usize, &'a CandidateRecord);
/// A level with its choice.
pub type Level<'a> = (&'a ChoiceRecord, &'a LevelRecord);

#[rustfmt::skip]
pub fn candidates<'a>() -> Columns<'a, Candidate<'a>> {
    Columns::<Candidate<'_>>::of("choose.csv", "`choose`: one row per candidate.")
        .add("level", "model of the hierarchy", |(.., t)| t.level.clone())
        .add("family", "model and method", |(.., t)| t.family.clone())
        .integrator(|(.., t)| t.integrator.clone())
        .step(|(.., t)| t.step_s)
        .rtol(|(.., t)| t.rtol)
        .add("estimated_error", "estimated error against the yardstick in the requested metric, over the whole scene", |(.., t)| t.error)
        .add("predicted_cost_s", "predicted processor time of one run of the whole scene", |(.., t)| t.cost_s)
        .add("steps_on_window", "steps on the window of the search", |(.., t)| t.steps)
        .add("force_evaluations_on_window", "force evaluations on that window", |(.., t)| t.force_evaluations)
        .add("adequate", ADEQUATE, |(.., t)| t.adequate.to_string())
        .add("chosen", "it was chosen", |(choice, i, _)| choice.chosen == Some(*i))
        .add("failure", "reason why it is not usable", |(.., t)| t.failure.clone())
}

const ADEQUATE: &str = "`adequate` (error and yardstick's own error together are within the tolerance), `not adequate` (the error \
    is beyond it by more than the yardstick's own) or `not decided`";

/// Returns the columns of levels.
#[rustfmt::skip]
pub fn levels<'a>() -> Columns<'a, Level<'a>> {
    Columns::<Level<'_>>::of("choose_levels.csv", "`choose`: one row per level of the hierarchy.")
        .add("level", "model of the hierarchy", |(_, l)| l.name.clone()).shown("Level", Format::Text)
        .add("family", "model and method", |(_, l)| l.family.clone())
        .add("distance", "distance to the yardstick on the window", |(_, l)| l.distance).shown("Distance to the yardstick", Format::Percents(2))
        .add("step_up", "distance to the next level on the window", |(_, l)| l.step_up).shown("Distance to the next level", Format::Percents(2))
        .add("estimated_error", "estimated error against the yardstick in the requested metric, over the whole scene", |(_, l)| l.error).shown("Estimated error", Format::Percents(2)).result()
        .add("yardstick_error", "estimated error of the yardstick itself, over the whole scene; empty where it is unknown", |(choice, _)| choice.yardstick_error)
        .add("tolerance", "requested tolerance", |(choice, _)| choice.tolerance.to_string())
        .add("adequate", ADEQUATE, |(_, l)| l.adequate.to_string())
        .add("verdict", "of the choice: `adequate`, `not decided` or `none adequate`", |(choice, _)| choice.answer().to_string())
        .add("setup_s", "processor time of the set-up, with the caches as they were", |(_, l)| l.setup_s)
        .join(statistics(), |(_, l)| l.statistics)
        .add("failure", "reason why it is not usable", |(_, l)| l.failure.clone())
}

/// Returns the columns with the force of a level whose history is not reproducible.
#[rustfmt::skip]
pub fn statistics<'a>() -> Columns<'a, ForceStatistics> {
    Columns::<ForceStatistics>::of("", "")
        .add("rms_n", "root mean square of the contact force on the window, where its history is not reproducible", |s| s.rms_n).shown("Force, rms", Format::Quantities(3)).result()
        .add("spells", "intervals of contact there", |s| s.spells).shown("Spells of contact", Format::Plain)
        .add("median_peak_n", "median of the peaks of these intervals", |s| s.median_peak_n).shown("Peak of a spell, median", Format::Quantities(3)).result()
        .add("greatest_peak_n", "greatest of these peaks", |s| s.greatest_peak_n).shown("Greatest peak", Format::Quantities(3))
}
