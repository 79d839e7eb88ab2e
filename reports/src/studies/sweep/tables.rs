//! Finding and tables of a speed sweep under load.

use super::csv::steady_columns;
use super::{Bistable, Steady, SweptBranch, resonance};
use crate::markup::table::Table;
use crate::markup::{glance, note, section, short_of};
use crate::numbers::{quantity, short, significant};
use crate::view::View;
use maud::{Markup, html};

const UM: f64 = 1e6;

pub fn finding(view: &View<'_>, all: &[SweptBranch<'_>], two: &[Bistable]) -> Vec<Markup> {
    if all.iter().all(|s| s.runs.is_empty()) {
        return vec![html! { "No run reached steady running." }];
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
    let resonance = resonance(all).map_or(String::new(), |f| {
        format!("; the resonance of the mesh is {}", quantity(f, "Hz", 3))
    });
    let apart: Vec<String> = (all.iter())
        .filter_map(|s| {
            let apart = |r: &&Steady| r.separated > 0.0;
            let runs: Vec<&Steady> = s.runs.iter().map(|r| r.0).filter(apart).collect();
            let at = |r: &Steady| quantity(r.mesh_frequency_hz, "Hz", 3);
            let (first, last) = (at(runs.first()?), at(runs.last()?));
            Some(if first == last {
                format!("{} at {first}", s.label)
            } else {
                format!("{} between {first} and {last}", s.label)
            })
        })
        .collect();
    let mut sentences = vec![html! {
        "The greatest transmission error (rms) among the mesh frequencies that were run is: "
        @for (i, peak) in peaks.iter().enumerate() { @if i > 0 { ", " } (peak) }
        (resonance) "."
    }];
    sentences.push(if apart.is_empty() {
        html! { "The teeth stay in contact at all speeds; " (short_of(view.results)) "." }
    } else {
        html! { "The teeth lift off for " (apart.join(", ")) "; " (short_of(view.results)) "." }
    });
    let unsettled: usize = all.iter().map(|s| s.unsettled.len()).sum();
    if unsettled > 0 {
        sentences.push(html! {
            (unsettled) " of " (view.results.runs.len())
            " runs did not settle to a motion that repeats: they stand apart from the lines, no greatest value is taken from them, "
            "and the command ends with 1."
        });
    }
    if !two.is_empty() {
        let of = |t: &Bistable| {
            let range = |[a, b]: &[f64; 2]| match a == b {
                true => format!("at {}", quantity(*a, "Hz", 3)),
                false => format!(
                    "from {} to {}",
                    quantity(*a, "Hz", 3),
                    quantity(*b, "Hz", 3)
                ),
            };
            let ranges: Vec<String> = t.ranges.iter().map(range).collect();
            format!("{} {}", t.label, ranges.join(" and "))
        };
        let all: Vec<String> = two.iter().map(of).collect();
        sentences.push(html! {
            "Two ways of running exist at one speed, and which one depends on where the speed comes from: "
            (all.join("; ")) "."
        });
    }
    sentences
}

/// Returns the table of peaks and quasi-static values per model.
pub fn tables(all: &[SweptBranch<'_>]) -> Markup {
    if all.is_empty() {
        return Markup::default();
    }
    let um = |x: f64| Some(significant(UM * x, 3));
    let khz = |f: f64| Some(significant(1e-3 * f, 3));
    let table = Table::of(all)
        .text("Model", |s| s.label.clone())
        .written("TE at rest, peak to peak", "\u{b5}m", |s| {
            um(s.statics?.error_peak_to_peak_m)
        })
        .result()
        .written("TE at the lowest speed, peak to peak", "\u{b5}m", |s| {
            um(s.runs.first()?.0.error_peak_to_peak_m)
        })
        .result()
        .written("TE at rest, mean", "\u{b5}m", |s| {
            um(s.statics?.error_mean_m)
        })
        .written("Mesh stiffness", "N/\u{b5}m", |s| {
            Some(significant(1e-6 * s.statics?.tangent_n_per_m, 4))
        })
        .written("fn", "kHz", |s| khz(s.statics?.resonance_hz?))
        .written("Greatest TE, rms", "\u{b5}m", |s| um(s.peak()?.error_rms_m))
        .result()
        .written("at mesh frequency", "kHz", |s| {
            khz(s.peak()?.mesh_frequency_hz)
        })
        .result()
        .written("Greatest / mean force", "", |s| {
            let f = s.runs.iter().map(|(r, _)| r.force_peak_n / r.force_mean_n);
            significant(f.fold(0.0, f64::max), 3)
        })
        .result()
        .written("Most contact lost", "% of time", |s| {
            let lost = s.runs.iter().map(|(r, _)| 100.0 * r.separated);
            significant(lost.fold(0.0, f64::max), 2)
        })
        .result()
        .written("Speeds", "", |s| {
            (s.runs.len() + s.failed.len()).to_string()
        })
        .written("Failed", "", |s| s.failed.len().to_string())
        .result();
    let remark = note(
        "TE: transmission error on the line of action. fn: frequency of the gears against each other on the mean tangent \
         stiffness of the mesh. At rest: static equilibria over one base pitch under the same load.",
    );
    glance("At a glance", html! { (table) (remark) })
}

/// Returns the table of every speed of every model.
pub fn speeds(all: &[SweptBranch<'_>]) -> Markup {
    let rows: Vec<(&SweptBranch<'_>, &Steady)> = (all.iter())
        .flat_map(|s| s.runs.iter().map(move |(r, _)| (s, *r)))
        .collect();
    let mut table = Table::of(&rows)
        .grouped(|(s, _)| (s.label.clone(), s.style))
        .columns_by_key(
            &steady_columns(),
            &[
                "mesh_frequency_hz",
                "speed_rad_s",
                "transmission_error_mean_m",
                "transmission_error_rms_m",
                "transmission_error_peak_to_peak_m",
            ],
            |(_, r)| Some(*r),
        )
        .numbers("TE long-period", "m", 3, |(_, r)| {
            Some(r.error_long_peak_to_peak_m).filter(|_| !r.shaft_orders.is_empty())
        })
        .columns_by_key(
            &steady_columns(),
            &["force_mean_n", "force_peak_n", "separated", "irregular"],
            |(_, r)| Some(*r),
        );
    for bearing in rows.first().map_or(&[][..], |(_, r)| &r.bearings) {
        let heading = format!("Bearing {}, rms", bearing.gear);
        table = table.numbers(&heading, "N", 3, |(_, r)| {
            let b = r.bearings.iter().find(|b| b.gear == bearing.gear);
            b.map(|b| b.rms_n)
        });
    }
    let remark = note(
        "Over whole mesh cycles of steady running. Contact lost: time without contact force. TE long-period: peak to peak of its mean over a running mesh cycle, where whole turns were measured. Irregular: what does not repeat from \
         cycle to cycle over what does.",
    );
    section("Every speed", html! { (table) (remark) })
}
