//! Finding and tables of a speed sweep under load.

use super::{Steady, Swept, resonance};
use crate::markup::table::Table;
use crate::markup::{failed_of, glance, note, section, sentences};
use crate::numbers::{quantity, short, significant};
use crate::view::View;
use maud::{Markup, html};

const UM: f64 = 1e6;

pub fn finding(view: &View<'_>, all: &[Swept<'_>]) -> Markup {
    if all.iter().all(|s| s.runs.is_empty()) {
        return html! { "No run reached steady running." };
    }
    let peaks: Vec<Markup> = (all.iter())
        .filter_map(|s| {
            let p = s.peak()?;
            Some(html! {
                b { (s.label) } " " (short(UM * p.error_rms_m, 3)) "\u{a0}\u{b5}m at "
                (quantity(p.mesh_frequency_hz, "Hz", 3))
            })
        })
        .collect();
    let mut parts = vec![html! {
        "The transmission error vibrates most (rms) where the mesh frequency meets the resonance of the gears on their mesh \
         stiffness: "
        @for (i, peak) in peaks.iter().enumerate() { @if i > 0 { ", " } (peak) }
        "."
    }];
    if let Some(f) = resonance(all) {
        let f = quantity(f, "Hz", 3);
        parts.push(
            html! { "The mean tangent stiffness of the mesh puts that resonance at " (f) "." },
        );
    }
    let slow: Vec<String> = (all.iter())
        .filter_map(|s| {
            let (still, (slow, _)) = (s.statics?, s.runs.first()?);
            Some(format!(
                "{} {} against {}\u{a0}\u{b5}m",
                s.label,
                short(UM * slow.error_peak_to_peak_m, 3),
                short(UM * still.error_peak_to_peak_m, 3)
            ))
        })
        .collect();
    if !slow.is_empty() {
        parts.push(html! {
            "At the lowest speed the peak to peak stands against that at rest: " (slow.join(", ")) "."
        });
    }
    let apart: Vec<String> = (all.iter())
        .filter_map(|s| {
            let apart = |r: &&Steady| r.separated > 0.0;
            let runs: Vec<&Steady> = s.runs.iter().map(|r| r.0).filter(apart).collect();
            let at = |r: &Steady| quantity(r.mesh_frequency_hz, "Hz", 3);
            let (first, last) = (at(runs.first()?), at(runs.last()?));
            Some(format!("{} between {first} and {last}", s.label))
        })
        .collect();
    parts.push(if apart.is_empty() {
        html! { "The teeth stay in contact at all speeds." }
    } else {
        html! { "The teeth lift off for " (apart.join(", ")) "." }
    });
    parts.extend(failed_of(view.results).map(|text| html! { (text) }));
    sentences(parts)
}

/// Peaks and static values per model.
pub fn tables(all: &[Swept<'_>]) -> Markup {
    if all.is_empty() {
        return Markup::default();
    }
    let um = |x: f64| Some(significant(UM * x, 3));
    let khz = |f: f64| Some(significant(1e-3 * f, 3));
    let table = Table::of(all)
        .text("Model", |s| s.label.clone())
        .written("TE at rest, p-p", "\u{b5}m", |s| {
            um(s.statics?.error_peak_to_peak_m)
        })
        .written("mean", "\u{b5}m", |s| um(s.statics?.error_mean_m))
        .written("Mesh stiffness", "N/\u{b5}m", |s| {
            Some(significant(1e-6 * s.statics?.tangent_n_per_m, 4))
        })
        .written("fn", "kHz", |s| khz(s.statics?.resonance_hz?))
        .written("Greatest TE, rms", "\u{b5}m", |s| um(s.peak()?.error_rms_m))
        .written("at mesh frequency", "kHz", |s| {
            khz(s.peak()?.mesh_frequency_hz)
        })
        .written("Greatest / mean force", "", |s| {
            let f = s.runs.iter().map(|(r, _)| r.force_peak_n / r.force_mean_n);
            significant(f.fold(0.0, f64::max), 3)
        })
        .written("Speeds", "", |s| {
            (s.runs.len() + s.failed.len()).to_string()
        })
        .written("Failed", "", |s| s.failed.len().to_string());
    let remark = note(
        "TE: transmission error on the line of action. fn: frequency of the gears against each other on the mean tangent \
         stiffness of the mesh. At rest: static equilibria over one base pitch under the same load.",
    );
    glance("At a glance", html! { (table) (remark) })
}

/// Every speed of every model.
pub fn speeds(all: &[Swept<'_>]) -> Markup {
    let rows: Vec<(&Swept<'_>, &Steady)> = (all.iter())
        .flat_map(|s| s.runs.iter().map(move |(r, _)| (s, *r)))
        .collect();
    let mut table = Table::of(&rows)
        .grouped(|(s, _)| (s.label.clone(), s.style))
        .numbers("Mesh frequency", "Hz", 4, |(_, r)| r.mesh_frequency_hz)
        .numbers("Speed", "rad/s", 4, |(_, r)| r.speed_rad_s)
        .numbers("TE mean", "m", 4, |(_, r)| r.error_mean_m)
        .numbers("rms", "m", 3, |(_, r)| r.error_rms_m)
        .numbers("p-p", "m", 3, |(_, r)| r.error_peak_to_peak_m)
        .numbers("Contact force", "N", 4, |(_, r)| r.force_mean_n)
        .numbers("greatest", "N", 4, |(_, r)| r.force_peak_n)
        .percents("apart", 2, |(_, r)| r.separated)
        .percents("irregular", 2, |(_, r)| r.irregular);
    for bearing in rows.first().map_or(&[][..], |(_, r)| &r.bearings) {
        let heading = format!("Bearing {}, rms", bearing.gear);
        table = table.numbers(&heading, "N", 3, |(_, r)| {
            let b = r.bearings.iter().find(|b| b.gear == bearing.gear);
            b.map(|b| b.rms_n)
        });
    }
    let remark = note(
        "Over whole mesh cycles of steady running. apart: time without contact force. irregular: what does not repeat from \
         cycle to cycle over what does.",
    );
    section("Every speed", html! { (table) (remark) })
}
