//! CSV tables of run-ups: amplitudes of orders, spectra, maps of orders, with a column for each quantity.

use super::{ModelRunUp, RunUpChannel, RunUpMap};
use crate::csv_table::{CsvTable, number};
use std::f64::consts::TAU;

/// Returns the tables that a record has data for.
pub fn tables(run_ups: &[ModelRunUp]) -> Vec<CsvTable> {
    let run_ups: Vec<&ModelRunUp> = run_ups.iter().filter(|r| r.message.is_empty()).collect();
    if run_ups.is_empty() {
        return Vec::new();
    }
    let mapped = |name: &str, file: &str, rows: fn(&RunUpChannel) -> &[Vec<f64>], by: MapOfRun| {
        let mut lines = Vec::new();
        for run in &run_ups {
            let map = by(run);
            for w in 0..map.time_s.len() {
                lines.extend((0..map.lines.len()).map(|line| (*run, map, w, line)));
            }
        }
        let fixed = table(file, &lines, name);
        with_quantities(
            fixed,
            &run_ups,
            |c| !rows(c).is_empty(),
            &lines,
            |c, w, line| rows(c).get(w).and_then(|r| r.get(line)).copied(),
        )
    };
    vec![
        orders(&run_ups),
        mapped(
            "frequency_hz",
            "run_up_spectra.csv",
            |c| &c.spectra,
            |r| &r.by_time,
        ),
        mapped(
            "order",
            "run_up_order_spectra.csv",
            |c| &c.order_spectra,
            |r| &r.by_turns,
        ),
    ]
}

type MapOfRun = fn(&ModelRunUp) -> &RunUpMap;
/// A run-up, the windows, and the places of window and line.
type MapPoint<'a> = (&'a ModelRunUp, &'a RunUpMap, usize, usize);

fn table(file: &str, lines: &[MapPoint<'_>], name: &str) -> CsvTable {
    CsvTable::new(
        file,
        lines,
        &[
            ("model", &|(r, ..)| r.label.clone()),
            ("time_s", &|(_, m, w, _)| number(m.time_s[*w])),
            ("speed_rad_s", &|(_, m, w, _)| number(m.speed_rad_s[*w])),
            (name, &|(_, m, _, line)| number(m.lines[*line])),
        ],
    )
}

/// Returns a table with a column for every quantity that any model has.
fn with_quantities(
    mut table: CsvTable,
    run_ups: &[&ModelRunUp],
    has: impl Fn(&RunUpChannel) -> bool,
    lines: &[MapPoint<'_>],
    value: impl Fn(&RunUpChannel, usize, usize) -> Option<f64>,
) -> CsvTable {
    let mut columns: Vec<&str> = Vec::new();
    for c in run_ups.iter().flat_map(|r| &r.channels).filter(|c| has(c)) {
        if !columns.contains(&c.column.as_str()) {
            columns.push(&c.column);
        }
    }
    table.header.extend(columns.iter().map(|c| (*c).to_owned()));
    for (row, (run, _, w, line)) in table.rows.iter_mut().zip(lines) {
        row.extend(columns.iter().map(|column| {
            let channel = run.channels.iter().find(|c| c.column == *column);
            number(channel.and_then(|c| value(c, *w, *line)))
        }));
    }
    table
}

fn orders(run_ups: &[&ModelRunUp]) -> CsvTable {
    let mut lines: Vec<MapPoint<'_>> = Vec::new();
    for run in run_ups {
        for order in 0..run.orders.len() {
            let windows = 0..run.by_turns.time_s.len();
            lines.extend(windows.map(|w| (*run, &run.by_turns, w, order)));
        }
    }
    let fixed = CsvTable::new(
        "run_up_orders.csv",
        &lines,
        &[
            ("model", &|(r, ..)| r.label.clone()),
            ("order_name", &|(r, .., o)| r.orders[*o].name.clone()),
            ("order", &|(r, .., o)| number(r.orders[*o].order)),
            ("time_s", &|(_, m, w, _)| number(m.time_s[*w])),
            ("speed_rad_s", &|(_, m, w, _)| number(m.speed_rad_s[*w])),
            ("frequency_hz", &|(r, m, w, o)| {
                number(r.orders[*o].order * m.speed_rad_s[*w] / TAU)
            }),
        ],
    );
    with_quantities(
        fixed,
        run_ups,
        |_| true,
        &lines,
        |c, w, order| c.orders.get(order).and_then(|o| o.get(w)).copied(),
    )
}
