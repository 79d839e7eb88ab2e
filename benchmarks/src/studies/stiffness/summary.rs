//! Terminal summary of a record of `stiffness`.

use super::command::STATIC_LOAD;
use crate::messages::Messages;
use gearbench_reports::numbers::short;
use gearbench_reports::record::Results;
use gearbench_reports::stiffness::PER_MM_UM;

/// Prints one line per model, and the computing time of finite elements.
pub fn summarise(messages: &Messages, results: &Results) {
    let all = results.stiffness();
    let solved = || all.iter().filter(|m| !m.positions.is_empty());
    let Some(first) = solved().next() else {
        return;
    };
    messages.print_line(&format!(
        "{}: {}, {} positions over one base pitch, common width {} mm",
        results.header.scene,
        load(results),
        first.positions.len(),
        short(1e3 * first.face_width_m, 4)
    ));
    messages.print_line("stiffness in N/(mm um), transmission error in um:");
    messages.print_line(
        "  c'      largest secant stiffness of one tooth pair, its load divided by the approach of the gears",
    );
    messages.print_line("  at C    the same at the pitch point");
    messages.print_line(
        "  c_g     mean secant stiffness of the mesh;  tangent: mean tangent stiffness at the load",
    );
    messages.print_line("  TE      mean static transmission error, and peak to peak");
    messages.print_line("");
    let wide = all.iter().map(|m| m.label.len()).max().unwrap_or(0).max(5);
    messages.print_line(&format!(
        "{:<wide$} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}  includes",
        "model", "c'", "at C", "c_g", "tangent", "TE", "p-p"
    ));
    for m in solved() {
        messages.print_line(&format!(
            "{:<wide$} {:>7.2} {:>7.2} {:>7.2} {:>8.2} {:>8.3} {:>8.3}  {}",
            m.label,
            m.single_stiffness_n_per_m2 / PER_MM_UM,
            m.at_pitch_point_n_per_m2 / PER_MM_UM,
            m.mesh_stiffness_n_per_m2 / PER_MM_UM,
            m.mesh_tangent_n_per_m2 / PER_MM_UM,
            1e6 * m.error_mean_m,
            1e6 * m.error_peak_to_peak_m,
            m.includes
        ));
    }
    for m in all.iter().filter(|m| m.positions.is_empty()) {
        messages.print_line(&format!("{:<wide$} failed: {}", m.label, m.message));
    }
    for m in all {
        for limit in &m.limits {
            messages.print_line(&format!("outside its range: {}: {limit}", m.label));
        }
    }
    for m in solved().filter(|m| m.unknowns > 0) {
        messages.print_line(&format!(
            "{}: {} unknowns, set up in {:.2} s, {} equilibria with {} Newton iterations in {:.2} s",
            m.label, m.unknowns, m.setup_s, m.equilibria, m.newton_iterations, m.solve_s
        ));
    }
}

/// The static load in words, as the record has it among its settings.
fn load(results: &Results) -> &str {
    let setting = results
        .settings
        .iter()
        .find(|(what, _)| what == STATIC_LOAD);
    setting.map_or("", |(_, load)| load)
}
