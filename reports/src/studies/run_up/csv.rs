//! CSV tables of run-ups: amplitudes of orders, spectra, maps of orders, with a column for each quantity.

use super::{ModelRunUp, RunUpChannel, RunUpMap};
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use std::f64::consts::TAU;

/// A run-up, the windows, and the places of window and line.
type MapPoint<'a> = (&'a ModelRunUp, &'a RunUpMap, usize, usize);
/// Amplitudes of a quantity, by line and window.
type Amplitude = fn(&RunUpChannel, usize, usize) -> Option<f64>;

/// Returns the tables that a record has data for.
pub fn tables(run_ups: &[ModelRunUp]) -> Vec<CsvTable> {
    let run_ups: Vec<&ModelRunUp> = run_ups.iter().filter(|r| r.message.is_empty()).collect();
    if run_ups.is_empty() {
        return Vec::new();
    }
    let names = |has: fn(&RunUpChannel) -> bool| {
        let mut names: Vec<&str> = Vec::new();
        for c in (run_ups.iter())
            .flat_map(|r| &r.channels)
            .filter(|c| has(c))
        {
            if !names.contains(&c.column.as_str()) {
                names.push(&c.column);
            }
        }
        names
    };
    let mut of_orders: Vec<MapPoint<'_>> = Vec::new();
    for run in &run_ups {
        let windows = run.by_turns.time_s.len();
        for order in 0..run.orders.len() {
            of_orders.extend((0..windows).map(|w| (*run, &run.by_turns, w, order)));
        }
    }
    let of_maps = |by: fn(&ModelRunUp) -> &RunUpMap| {
        let mut rows: Vec<MapPoint<'_>> = Vec::new();
        for run in &run_ups {
            let map = by(run);
            for w in 0..map.time_s.len() {
                rows.extend((0..map.lines.len()).map(|line| (*run, map, w, line)));
            }
        }
        rows
    };
    vec![
        orders(&names(|_| true)).table(of_orders),
        spectra(&names(|c| !c.spectra.is_empty())).table(of_maps(|r| &r.by_time)),
        order_spectra(&names(|c| !c.order_spectra.is_empty())).table(of_maps(|r| &r.by_turns)),
    ]
}

/// Names of quantities with placeholders.
pub const PLACEHOLDERS: [&str; 3] = [
    "transmission_error_MESH_m",
    "contact_force_MESH_n",
    "bearing_GEAR_n",
];

/// Adds a column of amplitudes for each of some quantities.
fn with_quantities<'a>(
    columns: Columns<'a, MapPoint<'a>>,
    names: &[&'a str],
    value: Amplitude,
) -> Columns<'a, MapPoint<'a>> {
    let of = |name: &'a str| {
        move |(run, _, w, line): &MapPoint<'_>| {
            let channel = run.channels.iter().find(|c| c.column == name)?;
            value(channel, *w, *line)
        }
    };
    let meaning = "amplitude of this quantity (half of peak to peak); of a bearing of its radial force, both components together";
    (names.iter()).fold(columns, |all, name| all.add(*name, meaning, of(name)))
}

#[rustfmt::skip]
pub fn orders<'a>(names: &[&'a str]) -> Columns<'a, MapPoint<'a>> {
    let columns = Columns::<MapPoint<'_>>::of("run_up_orders.csv", "`run-up`: one row per order and window.")
        .model(|(r, ..)| r.label.clone())
        .add("order_name", "frequency of which the order is a multiple", |(r, .., o)| r.orders[*o].name.clone())
        .add("order", "multiple of the rotational frequency of the reference gear", |(r, .., o)| r.orders[*o].order)
        .add("time_s", "middle of the window", |(_, m, w, _)| m.time_s[*w])
        .add("speed_rad_s", "speed of the reference gear there", |(_, m, w, _)| m.speed_rad_s[*w])
        .add("frequency_hz", "frequency of the order there", |(r, m, w, o)| r.orders[*o].order * m.speed_rad_s[*w] / TAU);
    with_quantities(columns, names, |c, w, order| c.orders.get(order)?.get(w).copied())
}

/// Returns the columns of the windows of a map.
#[rustfmt::skip]
fn windows<'a>(file: &str, rows: &str) -> Columns<'a, MapPoint<'a>> {
    Columns::<MapPoint<'_>>::of(file, rows)
        .model(|(r, ..)| r.label.clone())
        .add("time_s", "middle of the window", |(_, m, w, _)| m.time_s[*w])
        .add("speed_rad_s", "speed of the reference gear there", |(_, m, w, _)| m.speed_rad_s[*w])
}

#[rustfmt::skip]
pub fn spectra<'a>(names: &[&'a str]) -> Columns<'a, MapPoint<'a>> {
    let columns = windows("run_up_spectra.csv", "`run-up`: one row per window and frequency.")
        .add("frequency_hz", "frequency", |(_, m, _, line)| m.lines[*line]);
    with_quantities(columns, names, |c, w, line| c.spectra.get(w)?.get(line).copied())
}

#[rustfmt::skip]
pub fn order_spectra<'a>(names: &[&'a str]) -> Columns<'a, MapPoint<'a>> {
    let columns = windows("run_up_order_spectra.csv", "`run-up`: one row per window and order.")
        .add("order", "multiple of the rotational frequency of the reference gear", |(_, m, _, line)| m.lines[*line]);
    with_quantities(columns, names, |c, w, line| c.order_spectra.get(w)?.get(line).copied())
}
