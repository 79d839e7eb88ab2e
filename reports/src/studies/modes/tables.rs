//! Finding and tables of natural frequencies.

use super::csv::{Mode, frequencies};
use super::{LinearisedState, ModeRecord, ModelModes};
use crate::markup::table::Table;
use crate::markup::{glance, note, prose, section};
use crate::numbers::{per_cent, quantity};
use maud::{Markup, html};

/// Share of an energy from which on its holder is named.
const NAMED: f64 = 0.01;

/// Returns the modes with a frequency above zero.
fn swinging(v: &ModelModes) -> impl Iterator<Item = &ModeRecord> {
    v.modes.iter().filter(|m| m.frequency_hz > 0.0)
}

pub fn finding(vibrations: &[ModelModes]) -> Vec<Markup> {
    let of = |v: &ModelModes| {
        let lowest: Vec<String> = swinging(v)
            .take(3)
            .map(|m| format!("{} ({})", quantity(m.frequency_hz, "Hz", 5), m.name))
            .collect();
        let state = match v.about {
            LinearisedState::Loaded => "about its equilibrium under load",
            LinearisedState::Preloaded => "pressed together as it starts",
            LinearisedState::Apart => "with its gears apart, for nothing presses them together,",
            LinearisedState::NotFound => "",
        };
        html! {
            b { (v.label) }
            @if v.about == LinearisedState::NotFound { " has no natural frequencies: " (prose(&v.message)) "." }
            @else if lowest.is_empty() { " " (state) " has nothing that swings." }
            @else { " " (state) " swings at " (lowest.join(", ")) @if swinging(v).count() > 3 { " and above" } "." }
        }
    };
    vibrations.iter().map(of).collect()
}

/// Returns the largest shares with the names of their members or springs.
fn largest<'a>(names: impl Iterator<Item = &'a String>, shares: &[f64]) -> String {
    let mut all: Vec<(&String, f64)> = names.zip(shares.iter().copied()).collect();
    all.retain(|(_, share)| share.abs() >= NAMED);
    all.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let all: Vec<String> = (all.iter().take(4))
        .map(|(name, share)| format!("{name} {}", per_cent(*share, 3)))
        .collect();
    all.join(", ")
}

pub fn tables(vibrations: &[ModelModes]) -> Markup {
    type Row<'a> = (usize, &'a ModelModes, usize, &'a ModeRecord);
    let rows: Vec<Row<'_>> = (vibrations.iter().enumerate())
        .flat_map(|(k, v)| (v.modes.iter().enumerate()).map(move |(i, m)| (k, v, i + 1, m)))
        .collect();
    fn of<'a>((_, v, i, m): &Row<'a>) -> Option<Mode<'a>> {
        Some((v, *i, m))
    }
    let modes = Table::of(&rows)
        .grouped(|(k, v, ..)| (v.label.clone(), *k))
        .columns_by_key(
            &frequencies(),
            &[
                "mode",
                "frequency_hz",
                "multiplicity",
                "damping_ratio",
                "mode_name",
            ],
            of,
        )
        .text("Strain energy", |(_, v, _, m)| {
            largest(v.springs.iter(), &m.strain)
        })
        .text("Kinetic energy", |(_, v, _, m)| {
            largest(v.members.iter().map(|p| &p.name), &m.kinetic)
        })
        .columns_by_key(&frequencies(), &["damped_frequency_hz"], of);
    let states: Vec<(usize, &ModelModes)> = vibrations.iter().enumerate().collect();
    let state = Table::of(&states)
        .text("Model", |(_, v)| v.label.clone())
        .text("State", |(_, v)| v.about.to_string())
        .result()
        .text("Meshes", |(_, v)| {
            let all = v
                .meshes
                .iter()
                .map(|m| format!("{} {}", m.name, quantity(m.force_n, "N", 5)));
            all.collect::<Vec<_>>().join(", ")
        })
        .result()
        .written("Newton steps", "", |(_, v)| v.steps.to_string())
        .written("Coordinates", "", |(_, v)| v.coordinates.to_string())
        .written("Constraints", "", |(_, v)| v.constraints.to_string())
        .written("Frequencies in all", "", |(_, v)| v.frequencies.to_string())
        .numbers("Highest", "Hz", 5, |(_, v)| v.highest_hz)
        .powers("Residual of modes", "", |(_, v)| v.residual_rel);
    let remarks: Vec<&ModelModes> = vibrations
        .iter()
        .filter(|v| !v.message.is_empty())
        .collect();
    html! {
        (glance("Natural frequencies", html! {
            (modes)
            (note("Without damping; the ratio is that of the mode. Of several modes of one frequency shares of energy are \
                   those of all together, and rigid motions (of a train that turns as a whole) have none of strain. A mesh holds \
                   what bends at its contacts without coordinates of its own."))
        }))
        (section("The state", html! {
            (state)
            @for v in remarks { (note(html! { b { (v.label) } ": " (prose(&v.message)) "." })) }
        }))
    }
}
