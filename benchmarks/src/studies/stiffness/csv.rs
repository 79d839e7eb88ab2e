//! Tables of a study of stiffness, SI units in the header, and the same rows for programs.

use super::run::Row;
use serde::Serialize;

/// What is told of a model: a line of `stiffness.csv`.
#[derive(Clone, Debug, Serialize)]
pub struct Told {
    model: String,
    single_stiffness_n_per_m2: f64,
    at_pitch_point_n_per_m2: f64,
    mesh_stiffness_n_per_m2: f64,
    mesh_tangent_n_per_m2: f64,
    transmission_error_mean_m: f64,
    transmission_error_peak_to_peak_m: f64,
    unknowns: usize,
    equilibria: u64,
    newton_iterations: u64,
    setup_s: f64,
    solve_s: f64,
    includes: String,
    limits: Vec<String>,
}

impl Row {
    /// The row for programs.
    pub fn told(&self) -> Told {
        let c = &self.cycle;
        Told {
            model: self.label.clone(),
            single_stiffness_n_per_m2: self.single_stiffness(),
            at_pitch_point_n_per_m2: c.at_pitch_point(),
            mesh_stiffness_n_per_m2: self.mesh_stiffness(),
            mesh_tangent_n_per_m2: c.mesh_tangent(),
            transmission_error_mean_m: c.mean_error(),
            transmission_error_peak_to_peak_m: c.peak_to_peak(),
            unknowns: self.unknowns,
            equilibria: self.work[0],
            newton_iterations: self.work[1],
            setup_s: self.wall[0],
            solve_s: self.wall[1],
            includes: self.includes.clone(),
            limits: self.limits.clone(),
        }
    }

    /// The cycle as a table, SI units in the header.
    pub fn csv(&self) -> String {
        let c = &self.cycle;
        let offsets = c.positions.iter().flat_map(|p| &p.pairs).map(|p| p.offset);
        let (low, high) = offsets.fold((0, 0), |(a, b), j| (a.min(j), b.max(j)));
        let mut text = String::from(
            "path_coordinate_m,position_base_pitches,transmission_error_m,force_n,secant_n_per_m,tangent_n_per_m",
        );
        for j in low..=high {
            text.push_str(&format!(",force_pair_{j}_n"));
        }
        let pressed = c.positions.iter().any(|p| p.pressure.is_some());
        if pressed {
            text.push_str(",contact_half_width_m,contact_pressure_pa");
        }
        text.push('\n');
        for (p, tangent) in c.positions.iter().zip(&c.tangent) {
            text.push_str(&format!(
                "{:.9e},{:.6},{:.9e},{:.9e},{:.9e},{:.9e}",
                p.s,
                self.relative(p.s),
                p.approach,
                p.force,
                p.force / p.approach,
                tangent
            ));
            for j in low..=high {
                text.push_str(&format!(",{:.9e}", p.pair(j)));
            }
            match p.pressure {
                Some(p) => text.push_str(&format!(",{:.9e},{:.9e}", p.half_width, p.peak)),
                None if pressed => text.push_str(",,"),
                None => {}
            }
            text.push('\n');
        }
        text
    }
}

/// One line per row, SI units in the header.
pub fn summary_csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "model,single_stiffness_n_per_m2,at_pitch_point_n_per_m2,mesh_stiffness_n_per_m2,mesh_tangent_n_per_m2,transmission_error_mean_m,transmission_error_peak_to_peak_m,unknowns,equilibria,newton_iterations,setup_s,solve_s,includes,limits\n",
    );
    for r in rows {
        let c = &r.cycle;
        text.push_str(&format!(
            "{},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e},{},{},{},{:.3},{:.3},\"{}\",\"{}\"\n",
            r.label,
            r.single_stiffness(),
            c.at_pitch_point(),
            r.mesh_stiffness(),
            c.mesh_tangent(),
            c.mean_error(),
            c.peak_to_peak(),
            r.unknowns,
            r.work[0],
            r.work[1],
            r.wall[0],
            r.wall[1],
            r.includes.replace('"', "'"),
            r.limits.join("; ").replace('"', "'")
        ));
    }
    text
}
