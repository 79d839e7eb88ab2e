//! CSV tables of static stiffness: a row per model, and a table per model over the positions.

use super::{ModelStiffness, StiffnessPosition};
use crate::csv_table::{CsvTable, number};
use crate::record::slug;

/// Returns the table of models, and the table of the mesh cycle of each.
pub fn tables(stiffness: &[ModelStiffness]) -> Vec<CsvTable> {
    let mut all = vec![models(stiffness)];
    for model in stiffness.iter().filter(|m| !m.positions.is_empty()) {
        let mut table = cycle(model);
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

fn models(stiffness: &[ModelStiffness]) -> CsvTable {
    let made = |m: &ModelStiffness, x: f64| number((!m.positions.is_empty()).then_some(x));
    CsvTable::new::<&ModelStiffness>(
        "stiffness.csv",
        stiffness,
        &[
            ("model", &|m| m.label.clone()),
            ("single_stiffness_n_per_m2", &|m| {
                made(m, m.single_stiffness_n_per_m2)
            }),
            ("at_pitch_point_n_per_m2", &|m| {
                made(m, m.at_pitch_point_n_per_m2)
            }),
            ("mesh_stiffness_n_per_m2", &|m| {
                made(m, m.mesh_stiffness_n_per_m2)
            }),
            ("mesh_tangent_n_per_m2", &|m| {
                made(m, m.mesh_tangent_n_per_m2)
            }),
            ("transmission_error_mean_m", &|m| made(m, m.error_mean_m)),
            ("transmission_error_peak_to_peak_m", &|m| {
                made(m, m.error_peak_to_peak_m)
            }),
            ("unknowns", &|m| m.unknowns.to_string()),
            ("equilibria", &|m| m.equilibria.to_string()),
            ("newton_iterations", &|m| m.newton_iterations.to_string()),
            ("setup_s", &|m| made(m, m.setup_s)),
            ("solve_s", &|m| made(m, m.solve_s)),
            ("force_n", &|m| made(m, m.force_n)),
            ("includes", &|m| m.includes.clone()),
            ("limits", &|m| m.limits.join("; ")),
            ("message", &|m| m.message.clone()),
        ],
    )
}

fn cycle(model: &ModelStiffness) -> CsvTable {
    let mut table = CsvTable::new::<&StiffnessPosition>(
        "",
        &model.positions,
        &[
            ("path_coordinate_m", &|p| number(p.path_coordinate_m)),
            ("position_base_pitches", &|p| {
                number(model.relative(p.path_coordinate_m))
            }),
            ("transmission_error_m", &|p| number(p.error_m)),
            ("force_n", &|p| number(p.force_n)),
            ("secant_n_per_m", &|p| number(p.secant())),
            ("tangent_n_per_m", &|p| number(p.tangent_n_per_m)),
        ],
    );
    let [low, high] = model.offsets();
    for offset in low..=high {
        table.header.push(format!("force_pair_{offset}_n"));
        for (row, p) in table.rows.iter_mut().zip(&model.positions) {
            row.push(number(p.pair(offset)));
        }
    }
    if model.positions.iter().any(|p| p.pressure.is_some()) {
        let names = ["contact_half_width_m", "contact_pressure_pa"];
        table.header.extend(names.map(String::from));
        for (row, p) in table.rows.iter_mut().zip(&model.positions) {
            row.push(number(p.pressure.map(|p| p.half_width_m)));
            row.push(number(p.pressure.map(|p| p.peak_pa)));
        }
    }
    table
}
