//! Tables of a study of stiffness, SI units in the header.

use super::run::Row;

impl Row {
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
            text.push('\n');
        }
        text
    }
}

/// One line per row, SI units in the header.
pub fn summary_csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "model,single_stiffness_n_per_m2,at_pitch_point_n_per_m2,mesh_stiffness_n_per_m2,mesh_tangent_n_per_m2,transmission_error_mean_m,transmission_error_peak_to_peak_m,unknowns,equilibria,newton_iterations,setup_s,solve_s,includes\n",
    );
    for r in rows {
        let c = &r.cycle;
        text.push_str(&format!(
            "{},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e},{},{},{},{:.3},{:.3},\"{}\"\n",
            r.label,
            c.single_stiffness(),
            c.at_pitch_point(),
            c.mesh_stiffness(),
            c.mesh_tangent(),
            c.mean_error(),
            c.peak_to_peak(),
            r.unknowns,
            r.work[0],
            r.work[1],
            r.wall[0],
            r.wall[1],
            r.includes.replace('"', "'")
        ));
    }
    text
}
