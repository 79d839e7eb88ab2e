//! CSV tables of stability maps and of their limits.

use super::{Cell, Columns as MapColumns, Limit, Map};
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;

/// A cell of a map: its row, and whether it closes in on the largest stable step.
type Row<'a> = (&'a Map, usize, &'a Cell, bool);
/// A map with its largest stable step.
pub type MapLimit<'a> = (&'a Map, Limit);

/// Returns the tables with a row per run of a map, and with a row per largest stable step.
pub fn tables(maps: &[Map]) -> Vec<CsvTable> {
    if maps.is_empty() {
        return Vec::new();
    }
    // The cells of each map are followed by its runs near the largest stable step.
    let rows = maps.iter().flat_map(|map| {
        let columns = map.at.len().max(1);
        let cells = map.cells.iter().enumerate();
        let cells = cells.map(move |(i, c)| (map, i / columns, c, false));
        let own = map.own_row();
        cells.chain(map.refined.iter().map(move |c| (map, own, c, true)))
    });
    let of_maps = maps.iter().filter_map(|map| Some((map, map.limit()?)));
    vec![cells().table(rows), limits().table(of_maps)]
}

/// Returns the table of wall times, which are no part of the record: a key and a time for each run.
pub fn timings(times: impl IntoIterator<Item = (String, f64)>) -> CsvTable {
    times_of_runs().table(times)
}

#[rustfmt::skip]
pub fn cells<'a>() -> Columns<'a, Row<'a>> {
    let axis = |i: usize| move |(map, ..): &Row<'_>| Some(map.axes.get(i)?.id.clone());
    let value = |i: usize| move |(map, row, ..): &Row<'_>| map.values(*row).get(i).copied();
    let at = |columns: MapColumns| move |(map, _, cell, _): &Row<'_>| (map.columns == columns).then_some(cell.at);
    Columns::<Row<'_>>::of("stability.csv", "`stability`: one row per run of a map.")
        .add("set", "set of maps in the scene, from 1", |r| r.0.set + 1)
        .add("model", "model", |r| r.0.model.clone())
        .add("variant", "distinguishing settings", |r| r.0.variant.clone())
        .integrator(|r| r.0.integrator.clone())
        .add("axis_1", "parameter of the rows of the map", axis(0))
        .add("value_1", "its value, in the unit of the axis", value(0))
        .add("axis_2", "second parameter of the map", axis(1))
        .add("value_2", "its value, in the unit of the axis", value(1))
        .step(at(MapColumns::Step))
        .rtol(at(MapColumns::Tolerance))
        .add("closing_in", "a run of the search for the largest stable step", |r| r.3)
        .status(|r| r.2.status)
        .add("error", "error in the metric of the study", |r| r.2.error)
        .add("energy_rel", "residual of the energy ledger", |r| r.2.energy_rel)
        .add("reached_s", "time reached", |r| r.2.reached_s)
        .add("steps", "accepted steps", |r| r.2.steps)
        .add("rejected", "rejected steps", |r| r.2.rejected)
        .add("force_evaluations", "evaluations of the contact forces", |r| r.2.force_evaluations)
        .add("newton_iterations", "iterations of Newton's method", |r| r.2.newton_iterations)
        .message(|r| r.2.message.clone())
}

/// Returns the columns of the largest stable steps at the parameters of the scene.
#[rustfmt::skip]
pub fn limits<'a>() -> Columns<'a, MapLimit<'a>> {
    Columns::<MapLimit<'_>>::of("stability_limits.csv", "`stability`: one row per map, at the parameters of the scene.")
        .add("set", "set of maps in the scene, from 1", |r| r.0.set + 1)
        .add("model", "model", |r| r.0.model.clone())
        .add("variant", "distinguishing settings", |r| r.0.variant.clone())
        .integrator(|r| r.0.integrator.clone())
        .add("largest_stable_s", "largest step found to be stable", |r| r.1.stable_s)
        .add("next_unstable_s", "next larger one that failed", |r| r.1.unstable_s)
        .add("failing_with", "status of that run", |r| r.1.status).shown("Fails with", Format::Text)
        .add("holds_again_beyond", "a still larger step is stable again", |r| r.1.holds_again)
        .add("largest_accurate_s", "largest step within the tolerance", |r| r.1.accurate_s).shown("Largest accurate step", Format::Quantities(3)).result()
        .add("contact_pulls_from_s", "smallest step with a tensile contact force", |r| r.1.pulls_from_s).shown("A contact pulls from", Format::Quantities(3))
        .add("theory_s", "limit of linear theory", |r| r.0.theory(r.0.own_row()).map(|t| t.0)).shown("Theory", Format::Quantities(3))
        .add("theory", "name of that limit", |r| r.0.theory(r.0.own_row()).map(|t| t.1))
        .add("ratio", "limit of the runs over that of theory", |r| r.0.ratio()).shown("Found over theory", Format::Short(3)).result()
}

#[rustfmt::skip]
pub fn times_of_runs<'a>() -> Columns<'a, (String, f64)> {
    Columns::<(String, f64)>::of("timings.csv", "`stability`: one row per run.")
        .add("run", "map and cell", |(key, _)| key.clone())
        .add("wall_s", "wall time", |(_, s)| format!("{s:.6e}"))
}
