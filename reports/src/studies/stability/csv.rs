//! CSV tables of stability maps and of their limits.

use super::{Cell, Columns, Limit, Map};
use crate::csv_table::{CsvTable, number, text};

/// A cell of a map: its row, and whether it closes in on the largest stable step.
type Row<'a> = (&'a Map, usize, &'a Cell, bool);

/// Returns the tables with a row per run of a map, and with a row per largest stable step.
pub fn tables(maps: &[Map]) -> Vec<CsvTable> {
    if maps.is_empty() {
        return Vec::new();
    }
    vec![cells(maps), limits(maps)]
}

/// Returns the table of the cells of all maps, each followed by its runs near the largest stable step.
fn cells(maps: &[Map]) -> CsvTable {
    let axis = |map: &Map, i: usize| map.axes.get(i).map_or(String::new(), |a| a.id.clone());
    let value = |(map, row, ..): &Row<'_>, i: usize| number(map.values(*row).get(i).copied());
    let at = |(map, _, cell, _): &Row<'_>, columns: Columns| {
        number((map.columns == columns).then_some(cell.at))
    };
    let rows = maps.iter().flat_map(|map| {
        let columns = map.at.len().max(1);
        let cells = map.cells.iter().enumerate();
        let cells = cells.map(move |(i, c)| (map, i / columns, c, false));
        let own = map.own_row();
        cells.chain(map.refined.iter().map(move |c| (map, own, c, true)))
    });
    CsvTable::new::<Row<'_>>(
        "stability.csv",
        rows,
        &[
            ("set", &|r| (r.0.set + 1).to_string()),
            ("model", &|r| r.0.model.clone()),
            ("variant", &|r| text(&r.0.variant)),
            ("integrator", &|r| r.0.integrator.clone()),
            ("axis_1", &|r| axis(r.0, 0)),
            ("value_1", &|r| value(r, 0)),
            ("axis_2", &|r| axis(r.0, 1)),
            ("value_2", &|r| value(r, 1)),
            ("step_s", &|r| at(r, Columns::Step)),
            ("rtol", &|r| at(r, Columns::Tolerance)),
            ("closing_in", &|r| r.3.to_string()),
            ("status", &|r| r.2.status.to_string()),
            ("error", &|r| number(r.2.error)),
            ("energy_rel", &|r| number(r.2.energy_rel)),
            ("reached_s", &|r| number(r.2.reached_s)),
            ("steps", &|r| r.2.steps.to_string()),
            ("rejected", &|r| r.2.rejected.to_string()),
            ("force_evaluations", &|r| r.2.force_evaluations.to_string()),
            ("newton_iterations", &|r| r.2.newton_iterations.to_string()),
            ("message", &|r| text(&r.2.message)),
        ],
    )
}

/// Returns the table with the largest stable step of every map at the scene's own parameters.
fn limits(maps: &[Map]) -> CsvTable {
    let theory = |map: &Map| map.theory(map.own_row()).map(|t| (t.0, t.1.to_owned()));
    CsvTable::new::<(&Map, Limit)>(
        "stability_limits.csv",
        maps.iter().filter_map(|map| Some((map, map.limit()?))),
        &[
            ("set", &|r| (r.0.set + 1).to_string()),
            ("model", &|r| r.0.model.clone()),
            ("variant", &|r| text(&r.0.variant)),
            ("integrator", &|r| r.0.integrator.clone()),
            ("largest_stable_s", &|r| number(r.1.stable_s)),
            ("next_unstable_s", &|r| number(r.1.unstable_s)),
            ("failing_with", &|r| text(&r.1.status)),
            ("holds_again_beyond", &|r| r.1.holds_again.to_string()),
            ("largest_accurate_s", &|r| number(r.1.accurate_s)),
            ("contact_pulls_from_s", &|r| number(r.1.pulls_from_s)),
            ("theory_s", &|r| number(theory(r.0).map(|t| t.0))),
            ("theory", &|r| text(&theory(r.0).map(|t| t.1))),
            ("ratio", &|r| number(r.0.ratio())),
        ],
    )
}
