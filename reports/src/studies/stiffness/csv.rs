//! CSV tables of static stiffness: a row per model, and a table per model over the positions.

use super::{ModelStiffness, PER_MM_UM, StiffnessPosition};
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;
use crate::record::slug;
use std::borrow::Cow;

/// Returns the table of models, and the table of the mesh cycle of each.
pub fn tables(stiffness: &[ModelStiffness]) -> Vec<CsvTable> {
    let mut all = vec![models().table(stiffness)];
    for model in stiffness.iter().filter(|m| !m.positions.is_empty()) {
        let [low, high] = model.offsets();
        let offsets: Vec<String> = (low..=high).map(|k| k.to_string()).collect();
        let pressure = model.positions.iter().any(|p| p.pressure.is_some());
        let rows = model.positions.iter().map(|p| (model, p));
        let mut table = cycle(&offsets, low, pressure).table(rows);
        let stem = format!("cycle_{}", slug(&model.label));
        // Labels that differ in signs alone have files of their own.
        let taken = all.iter().filter(|t| {
            let name = t.file.strip_suffix(".csv").unwrap_or(&t.file);
            name == stem || name.starts_with(&format!("{stem}-again"))
        });
        table.file = match taken.count() {
            0 => format!("{stem}.csv"),
            n => format!("{stem}-again{}.csv", n + 1),
        };
        all.push(table);
    }
    all
}

/// Format of a stiffness per width.
const PER_WIDTH: Format = Format::Scaled(PER_MM_UM, Cow::Borrowed("N/(mm\u{a0}\u{b5}m)"), 4);

/// Returns the columns of models.
#[rustfmt::skip]
pub fn models<'a>() -> Columns<'a, &'a ModelStiffness> {
    let made = |value: fn(&ModelStiffness) -> f64| move |m: &&ModelStiffness| (!m.positions.is_empty()).then_some(value(m));
    Columns::<&ModelStiffness>::of("stiffness.csv", "`stiffness`: one row per model.")
        .model(|m| m.label.clone())
        .add("single_stiffness_n_per_m2", "greatest stiffness of one pair, per width", made(|m| m.single_stiffness_n_per_m2)).shown("c'", PER_WIDTH).result()
        .add("at_pitch_point_n_per_m2", "stiffness at the pitch point, per width", made(|m| m.at_pitch_point_n_per_m2)).shown("at the pitch point", PER_WIDTH)
        .add("mesh_stiffness_n_per_m2", "mean mesh stiffness, per width", made(|m| m.mesh_stiffness_n_per_m2)).shown("c\u{3b3}", PER_WIDTH).result()
        .add("mesh_tangent_n_per_m2", "mean tangent stiffness, per width", made(|m| m.mesh_tangent_n_per_m2)).shown("Tangent, mean", PER_WIDTH).result()
        .add("transmission_error_mean_m", "mean transmission error", made(|m| m.error_mean_m)).shown("TE, mean", Format::Numbers(4)).result()
        .add("transmission_error_peak_to_peak_m", "greatest minus least transmission error", made(|m| m.error_peak_to_peak_m)).shown("TE, peak to peak", Format::Numbers(3)).result()
        .add("unknowns", "unknowns of the model", |m| m.unknowns).shown("Unknowns", Format::Counts)
        .add("equilibria", "static equilibria solved", |m| m.equilibria).shown("Equilibria", Format::Counts)
        .add("newton_iterations", "iterations of Newton's method", |m| m.newton_iterations).shown("Newton iterations", Format::Counts)
        .add("setup_s", "wall time of the set-up", made(|m| m.setup_s)).shown("Set-up", Format::Numbers(3))
        .add("solve_s", "wall time of the static solves", made(|m| m.solve_s)).shown("Solved in", Format::Numbers(3))
        .add("force_n", FORCE, made(|m| m.force_n))
        .add("includes", "components of the stiffness", |m| m.includes.clone()).shown("Includes", Format::Text)
        .add("limits", "ranges of the formulas that the pair leaves", |m| m.limits.join("; "))
        .message(|m| m.message.clone())
}

const FORCE: &str = "static force in the transverse plane, torque over transverse base radius; the normal force is 1 / cos(beta_b) times as large";

/// Returns the columns of a mesh cycle, with those of pairs by their offsets from the lowest one.
#[rustfmt::skip]
pub fn cycle<'a>(offsets: &[String], low: i64, pressure: bool) -> Columns<'a, (&'a ModelStiffness, &'a StiffnessPosition)> {
    let columns = Columns::<(&ModelStiffness, &StiffnessPosition)>::of("cycle_MODEL.csv", "`stiffness`: one file per model, one row per position of a mesh cycle.")
        .add("path_coordinate_m", "position along the path of contact", |(_, p)| p.path_coordinate_m)
        .add("position_base_pitches", "position along the path of contact from the pitch point, in base pitches", |(m, p)| m.relative(p.path_coordinate_m))
        .add("transmission_error_m", "transmission error", |(_, p)| p.error_m)
        .add("force_n", FORCE, |(_, p)| p.force_n)
        .add("secant_n_per_m", "that force over the transmission error", |(_, p)| p.secant())
        .add("tangent_n_per_m", "derivative of that force by the transmission error", |(_, p)| p.tangent_n_per_m)
        .numbered(offsets, "force_pair_N_n", "force of the pair N base pitches ahead", move |(_, p), k| p.pair(low + k as i64));
    if !pressure {
        return columns;
    }
    columns
        .add("contact_half_width_m", "half-width of the contact line with the greatest pressure, on half-spaces", |(_, p)| p.pressure.map(|p| p.half_width_m))
        .add("contact_pressure_pa", "greatest pressure", |(_, p)| p.pressure.map(|p| p.peak_pa))
}
