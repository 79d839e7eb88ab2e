//! What the terminal says of a study of stiffness.

use super::run::Row;
use crate::cli::terminal::say;

/// N/(mm um) in N/m^2.
const PER_MM_UM: f64 = 1e9;

/// One line per model, and what finite elements took.
pub fn summarise(scene: &str, load: &str, rows: &[Row]) {
    let c = &rows[0].cycle;
    say(&format!(
        "{scene}: {load}, {} positions over one base pitch, common width {:.4} mm",
        c.positions.len(),
        1e3 * c.face_width
    ));
    say("stiffness in N/(mm um), transmission error in um:");
    say("  c'      largest secant stiffness of one pair, its load over the approach of the gears");
    say("  at C    the same at the pitch point");
    say("  c_g     mean secant stiffness of the mesh;  tangent: its slope at the load, mean");
    say("  TE      mean static transmission error, and peak to peak");
    say("");
    let wide = rows.iter().map(|r| r.label.len()).max().unwrap_or(0).max(5);
    say(&format!(
        "{:<wide$} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}  includes",
        "model", "c'", "at C", "c_g", "tangent", "TE", "p-p"
    ));
    for r in rows {
        let c = &r.cycle;
        say(&format!(
            "{:<wide$} {:>7.2} {:>7.2} {:>7.2} {:>8.2} {:>8.3} {:>8.3}  {}",
            r.label,
            r.single_stiffness() / PER_MM_UM,
            c.at_pitch_point() / PER_MM_UM,
            r.mesh_stiffness() / PER_MM_UM,
            c.mesh_tangent() / PER_MM_UM,
            1e6 * c.mean_error(),
            1e6 * c.peak_to_peak(),
            r.includes
        ));
    }
    for r in rows {
        for limit in &r.limits {
            say(&format!("out of range: {}: {limit}", r.label));
        }
    }
    for r in rows.iter().filter(|r| r.unknowns > 0) {
        say(&format!(
            "{}: {} unknowns, set up in {:.2} s, {} equilibria with {} Newton iterations in {:.2} s",
            r.label, r.unknowns, r.wall[0], r.work[0], r.work[1], r.wall[1]
        ));
    }
}
