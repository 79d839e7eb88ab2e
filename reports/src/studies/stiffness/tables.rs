//! Finding and table of static stiffness.

use super::csv::models;
use super::{ModelStiffness, PER_MM_UM};
use crate::markup::table::Table;
use crate::markup::{glance, note, prose};
use crate::numbers::{quantity, round_quantity, short, significant};
use maud::{Markup, html};

/// Returns the models with numbers, each with its place.
fn solved(stiffness: &[ModelStiffness]) -> Vec<(usize, &ModelStiffness)> {
    let all = stiffness.iter().enumerate();
    all.filter(|(_, m)| !m.positions.is_empty()).collect()
}

pub fn finding(stiffness: &[ModelStiffness]) -> Vec<Markup> {
    let solved = solved(stiffness);
    let Some((_, first)) = solved.first() else {
        return vec![html! { "No model has an equilibrium under the load." }];
    };
    let mut all = vec![html! {
        "Under " (round_quantity(first.force_n, "N", 4)) " along the line of action ("
        (short(1e-3 * first.line_load(), 4)) "\u{a0}N/mm) the mesh stiffness is "
        @for (i, (_, m)) in solved.iter().enumerate() {
            @if i > 0 { ", " }
            b { (m.label) } " " (significant(m.mesh_stiffness_n_per_m2 / PER_MM_UM, 3))
        }
        " N/(mm\u{a0}\u{b5}m); the static transmission error varies by "
        @for (i, (_, m)) in solved.iter().enumerate() {
            @if i > 0 { ", " }
            (m.label) " " (quantity(m.error_peak_to_peak_m, "m", 3))
        }
        " over a base pitch."
    }];
    let failed: Vec<&ModelStiffness> = (stiffness.iter())
        .filter(|m| m.positions.is_empty())
        .collect();
    if !failed.is_empty() {
        all.push(html! {
            "Without a result: "
            @for (i, m) in failed.iter().enumerate() { @if i > 0 { "; " } (m.label) " (" (prose(&m.message)) ")" }
            "."
        });
    }
    let limits: Vec<String> = (stiffness.iter())
        .flat_map(|m| m.limits.iter().map(move |l| format!("{}: {l}", m.label)))
        .collect();
    if !limits.is_empty() {
        all.push(html! { "Formulas out of their range: " (prose(&limits.join("; "))) "." });
    }
    all
}

pub fn tables(stiffness: &[ModelStiffness]) -> Markup {
    let rows = solved(stiffness);
    let table = Table::of(&rows)
        .grouped(|(i, m)| (m.label.clone(), *i))
        .columns_by_key(
            &models(),
            &[
                "single_stiffness_n_per_m2",
                "at_pitch_point_n_per_m2",
                "mesh_stiffness_n_per_m2",
                "mesh_tangent_n_per_m2",
                "transmission_error_mean_m",
                "transmission_error_peak_to_peak_m",
                "includes",
                "unknowns",
                "equilibria",
                "newton_iterations",
                "setup_s",
                "solve_s",
            ],
            |(_, m)| Some(*m),
        );
    html! {
        (glance("Stiffness of the mesh", html! {
            (table)
            (note("Both hubs are held. c': largest secant stiffness of one pair, its load over the approach of the gears. c\u{3b3}: mean secant \
                   stiffness of the mesh. Tangent: derivative of the force by the approach, mean over the cycle. TE: static transmission \
                   error. All stiffnesses are per width of the common face."))
        }))
    }
}
