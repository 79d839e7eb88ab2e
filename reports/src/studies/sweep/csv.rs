//! CSV tables of a sweep: speeds, mesh cycles, quasi-static limits.

use super::{Bearing, ShaftOrders, StaticCycle, Steady};
use crate::columns::{Columns, up_to};
use crate::csv_table::CsvTable;
use crate::markup::column::Format;
use crate::record::{Results, Run};

/// A run that reached steady running.
type SteadyRun<'a> = (&'a Run, &'a Steady);
/// An order of a shaft.
type Order<'a> = (&'a Run, &'a Steady, &'a ShaftOrders, usize);
/// A position in the mesh cycle of a run, and at rest.
type Position<'a> = (&'a Run, &'a Steady, usize);
type Rest<'a> = (&'a StaticCycle, f64, f64);

/// Returns the tables that a record has data for.
pub fn tables(results: &Results, still: &[StaticCycle]) -> Vec<CsvTable> {
    let steady: Vec<SteadyRun<'_>> = (results.runs.iter())
        .filter_map(|r| Some((r, r.steady.as_ref()?)))
        .collect();
    let mut all = Vec::new();
    if let Some((_, first)) = steady.first() {
        // As many columns as there are harmonics, and those of each bearing.
        let harmonics = steady.iter().map(|(_, s)| s.error_harmonics_m.len()).max();
        let gears: Vec<String> = first.bearings.iter().map(|b| b.gear.clone()).collect();
        let positions = steady
            .iter()
            .flat_map(|(r, s)| (0..s.position.len()).map(move |i| (*r, *s, i)));
        all.extend([
            speeds(&up_to(harmonics.unwrap_or(0)), &gears).table(steady.iter().copied()),
            cycles().table(positions),
        ]);
        if steady.iter().any(|(_, s)| !s.shaft_orders.is_empty()) {
            let mut lines: Vec<Order<'_>> = Vec::new();
            for (r, s) in steady {
                for o in &s.shaft_orders {
                    lines.extend((0..o.error_m.len()).map(|i| (r, s, o, i)));
                }
            }
            all.push(orders().table(lines));
        }
    }
    if !still.is_empty() {
        let rows = (still.iter()).flat_map(|s| {
            let places = s.position.iter().zip(&s.error_m);
            places.map(move |(p, e)| (s, *p, *e))
        });
        all.push(statics().table(rows));
    }
    all
}

/// Returns the columns with the scalars of steady running at a speed.
#[rustfmt::skip]
pub fn steady_columns<'a>() -> Columns<'a, &'a Steady> {
    Columns::<&Steady>::of("", "")
        .add("branch", "start of the run: `up` or `down` from the speed before, or `fresh`", |s| s.branch)
        .mesh_frequency(|s| s.mesh_frequency_hz).shown("Mesh frequency", Format::Numbers(4))
        .add("speed_rad_s", "speed of gear 1", |s| s.speed_rad_s).shown("Speed", Format::Numbers(4))
        .add("cycles", "mesh cycles measured", |s| s.cycles as f64)
        .add("transmission_error_mean_m", "mean transmission error", |s| s.error_mean_m).shown("TE mean", Format::Numbers(4))
        .add("transmission_error_rms_m", "root mean square of its deviation", |s| s.error_rms_m).shown("TE rms", Format::Numbers(3)).result()
        .add("transmission_error_peak_to_peak_m", "greatest minus least value", |s| s.error_peak_to_peak_m).shown("TE peak to peak", Format::Numbers(3)).result()
        .add("transmission_error_long_peak_to_peak_m", "peak to peak of the mean of the transmission error over a running mesh cycle: differences from tooth to tooth", |s| s.error_long_peak_to_peak_m)
        .add("force_mean_n", "mean contact force", |s| s.force_mean_n).shown("Contact force, mean", Format::Numbers(4))
        .add("force_peak_n", "greatest contact force", |s| s.force_peak_n).shown("Contact force, greatest", Format::Numbers(4)).result()
        .add("separated", "share of the time without contact", |s| s.separated).shown("Contact lost", Format::Percents(2)).result()
        .add("irregular", "share of the transmission error that is not periodic", |s| s.irregular).shown("Irregular", Format::Percents(2))
}

#[rustfmt::skip]
pub fn speeds<'a>(harmonics: &[String], gears: &[String]) -> Columns<'a, SteadyRun<'a>> {
    let columns = Columns::<SteadyRun<'_>>::of("sweep.csv", "`sweep`: one row per run that reached steady running.")
        .model(|(r, _)| r.model_label())
        .status(|(r, _)| r.status)
        .join(steady_columns(), |(_, s)| Some(*s))
        .numbered(harmonics, "transmission_error_N_m", "amplitude of the N-th harmonic of the mesh frequency", |(_, s), k| s.error_harmonics_m.get(k).copied());
    gears.iter().fold(columns, |all, gear| {
        let own = gear.clone();
        let bearing = move |(_, s): &SteadyRun<'a>| s.bearings.iter().find(|b| b.gear == own);
        all.join(bearings(gear, harmonics), bearing)
    })
}

/// Returns the columns of a bearing.
#[rustfmt::skip]
pub fn bearings<'a>(gear: &str, harmonics: &[String]) -> Columns<'a, &'a Bearing> {
    Columns::<&Bearing>::of("", "")
        .add(format!("bearing_{gear}_mean_n"), "mean bearing force", |b| b.mean_n)
        .add(format!("bearing_{gear}_rms_n"), "root mean square of its deviation", |b| b.rms_n)
        .numbered(harmonics, &format!("bearing_{gear}_N_n"), "amplitude of its N-th harmonic", |b, k| b.harmonics_n.get(k).copied())
}

#[rustfmt::skip]
pub fn orders<'a>() -> Columns<'a, Order<'a>> {
    Columns::<Order<'_>>::of("sweep_orders.csv", "`sweep`: one row per run, shaft and order.")
        .model(|(r, ..)| r.model_label())
        .add("branch", "start of the run", |(_, s, ..)| s.branch)
        .mesh_frequency(|(_, s, ..)| s.mesh_frequency_hz)
        .add("gear", "gear whose rotational frequency is the unit of orders", |(_, _, o, _)| o.gear.clone())
        .add("order", "multiple of that frequency", |(.., i)| (i + 1) as f64)
        .add("frequency_hz", "its frequency", |(_, s, o, i)| s.mesh_frequency_hz * (i + 1) as f64 / o.teeth as f64)
        .add("transmission_error_m", "amplitude of the transmission error at this order", |(_, _, o, i)| o.error_m.get(*i).copied())
}

const POSITION: &str = "position along the path of contact from the pitch point, in base pitches";

#[rustfmt::skip]
pub fn cycles<'a>() -> Columns<'a, Position<'a>> {
    Columns::<Position<'_>>::of("sweep_cycles.csv", "`sweep`: one row per run and position of the mean mesh cycle.")
        .model(|(r, ..)| r.model_label())
        .add("branch", "start of the run", |(_, s, _)| s.branch)
        .mesh_frequency(|(_, s, _)| s.mesh_frequency_hz)
        .add("position_base_pitches", POSITION, |(_, s, i)| s.position[*i])
        .add("transmission_error_m", "transmission error", |(_, s, i)| s.error_cycle_m.get(*i).copied())
        .add("contact_force_n", "contact force", |(_, s, i)| s.force_cycle_n.get(*i).copied())
}

#[rustfmt::skip]
pub fn statics<'a>() -> Columns<'a, Rest<'a>> {
    Columns::<Rest<'_>>::of("statics.csv", "`sweep`: one row per model and position at rest.")
        .model(|(s, ..)| s.label.clone())
        .add("force_n", "static force in the transverse plane, torque over transverse base radius", |(s, ..)| s.force_n)
        .add("position_base_pitches", POSITION, |(_, p, _)| *p)
        .add("transmission_error_m", "transmission error", |(.., e)| *e)
}
