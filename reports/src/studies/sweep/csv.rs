//! CSV tables of a sweep: speeds, mesh cycles, quasi-static limits.

use super::{ShaftOrders, StaticCycle, Steady};
use crate::csv_table::{CsvColumn, CsvTable, number};
use crate::record::{Results, Run};

type SteadyRun<'a> = (&'a Run, &'a Steady);

/// Returns the tables that a record has data for.
pub fn tables(results: &Results, still: &[StaticCycle]) -> Vec<CsvTable> {
    let steady: Vec<SteadyRun<'_>> = (results.runs.iter())
        .filter_map(|r| Some((r, r.steady.as_ref()?)))
        .collect();
    let mut all = Vec::new();
    if !steady.is_empty() {
        all.extend([speeds(&steady), cycles(&steady)]);
        if steady.iter().any(|(_, s)| !s.shaft_orders.is_empty()) {
            all.push(orders(&steady));
        }
    }
    if !still.is_empty() {
        all.push(statics(still));
    }
    all
}

/// Returns the columns with the scalars of steady running at a speed.
pub fn steady_columns() -> [CsvColumn<'static, Steady>; 12] {
    [
        ("branch", &|s| s.branch.to_string()),
        ("mesh_frequency_hz", &|s| number(s.mesh_frequency_hz)),
        ("speed_rad_s", &|s| number(s.speed_rad_s)),
        ("cycles", &|s| number(s.cycles as f64)),
        ("transmission_error_mean_m", &|s| number(s.error_mean_m)),
        ("transmission_error_rms_m", &|s| number(s.error_rms_m)),
        ("transmission_error_peak_to_peak_m", &|s| {
            number(s.error_peak_to_peak_m)
        }),
        ("transmission_error_long_peak_to_peak_m", &|s| {
            number(s.error_long_peak_to_peak_m)
        }),
        ("force_mean_n", &|s| number(s.force_mean_n)),
        ("force_peak_n", &|s| number(s.force_peak_n)),
        ("separated", &|s| number(s.separated)),
        ("irregular", &|s| number(s.irregular)),
    ]
}

fn speeds(runs: &[SteadyRun<'_>]) -> CsvTable {
    let steady = steady_columns();
    let cells: Vec<_> = (steady.iter())
        .map(|(_, cell)| move |(_, s): &&SteadyRun<'_>| cell(s))
        .collect();
    let mut columns: Vec<CsvColumn<'_, &SteadyRun<'_>>> = vec![
        ("model", &|(r, _)| r.model_label()),
        ("status", &|(r, _)| r.status.to_string()),
    ];
    for ((name, _), cell) in steady.iter().zip(&cells) {
        columns.push((name, cell));
    }
    let mut table = CsvTable::new("sweep.csv", runs, &columns);
    // As many columns as there are harmonics, and those of each bearing.
    let harmonics = (runs.iter())
        .map(|(_, s)| s.error_harmonics_m.len())
        .max()
        .unwrap_or(0);
    let gears: Vec<&str> = (runs[0].1.bearings.iter())
        .map(|b| b.gear.as_str())
        .collect();
    let header = &mut table.header;
    header.extend((1..=harmonics).map(|k| format!("transmission_error_{k}_m")));
    for g in &gears {
        header.push(format!("bearing_{g}_mean_n"));
        header.push(format!("bearing_{g}_rms_n"));
        header.extend((1..=harmonics).map(|k| format!("bearing_{g}_{k}_n")));
    }
    for (row, (_, s)) in table.rows.iter_mut().zip(runs) {
        row.extend((0..harmonics).map(|k| number(s.error_harmonics_m.get(k).copied())));
        for g in &gears {
            let b = s.bearings.iter().find(|b| b.gear == *g);
            row.push(number(b.map(|b| b.mean_n)));
            row.push(number(b.map(|b| b.rms_n)));
            row.extend(
                (0..harmonics).map(|k| number(b.and_then(|b| b.harmonics_n.get(k).copied()))),
            );
        }
    }
    table
}

fn orders(runs: &[SteadyRun<'_>]) -> CsvTable {
    let mut lines = Vec::new();
    for (r, s) in runs {
        for o in &s.shaft_orders {
            lines.extend((0..o.error_m.len()).map(|i| (*r, *s, o, i)));
        }
    }
    CsvTable::new::<(&Run, &Steady, &ShaftOrders, usize)>(
        "sweep_orders.csv",
        lines,
        &[
            ("model", &|(r, ..)| r.model_label()),
            ("branch", &|(_, s, ..)| s.branch.to_string()),
            ("mesh_frequency_hz", &|(_, s, ..)| {
                number(s.mesh_frequency_hz)
            }),
            ("gear", &|(_, _, o, _)| o.gear.clone()),
            ("order", &|(.., i)| number((i + 1) as f64)),
            ("frequency_hz", &|(_, s, o, i)| {
                number(s.mesh_frequency_hz * (i + 1) as f64 / o.teeth as f64)
            }),
            ("transmission_error_m", &|(_, _, o, i)| {
                number(o.error_m.get(*i).copied())
            }),
        ],
    )
}

fn cycles(runs: &[SteadyRun<'_>]) -> CsvTable {
    let rows = (runs.iter()).flat_map(|(r, s)| (0..s.position.len()).map(move |i| (*r, *s, i)));
    CsvTable::new::<(&Run, &Steady, usize)>(
        "sweep_cycles.csv",
        rows,
        &[
            ("model", &|(r, ..)| r.model_label()),
            ("branch", &|(_, s, _)| s.branch.to_string()),
            ("mesh_frequency_hz", &|(_, s, _)| {
                number(s.mesh_frequency_hz)
            }),
            ("position_base_pitches", &|(_, s, i)| number(s.position[*i])),
            ("transmission_error_m", &|(_, s, i)| {
                number(s.error_cycle_m.get(*i).copied())
            }),
            ("contact_force_n", &|(_, s, i)| {
                number(s.force_cycle_n.get(*i).copied())
            }),
        ],
    )
}

fn statics(all: &[StaticCycle]) -> CsvTable {
    let rows = (all.iter()).flat_map(|s| {
        let places = s.position.iter().zip(&s.error_m);
        places.map(move |(p, e)| (s, *p, *e))
    });
    CsvTable::new::<(&StaticCycle, f64, f64)>(
        "statics.csv",
        rows,
        &[
            ("model", &|(s, ..)| s.label.clone()),
            ("force_n", &|(s, ..)| number(s.force_n)),
            ("position_base_pitches", &|(_, p, _)| number(*p)),
            ("transmission_error_m", &|(.., e)| number(*e)),
        ],
    )
}
