//! Finding and tables of a speed sweep under load.

use super::charts::{Swept, resonance, swept};
use crate::markup::escape;
use crate::markup::table::{Column, Rows, table};
use crate::numbers::{quantity, short, significant};
use crate::record::Steady;
use crate::view::View;

const UM: f64 = 1e6;

/// The finding, as HTML.
pub fn finding(view: &View<'_>) -> String {
    let all = swept(view);
    if all.iter().all(|s| s.runs.is_empty()) {
        return "No run reached steady running.".into();
    }
    let mut sentences = Vec::new();
    let peaks: Vec<String> = (all.iter())
        .filter_map(|s| {
            let p = s.peak()?;
            Some(format!(
                "<b>{}</b> {}\u{a0}\u{b5}m at {}",
                escape(&s.label),
                short(UM * p.error_rms_m, 3),
                quantity(p.mesh_frequency_hz, "Hz", 3)
            ))
        })
        .collect();
    sentences.push(format!(
        "The transmission error vibrates most (rms) where the mesh frequency meets the resonance of the gears on their \
         mesh stiffness: {}.",
        peaks.join(", ")
    ));
    if let Some(f) = resonance(&all) {
        sentences.push(format!(
            "The mean tangent stiffness of the mesh puts that resonance at {}.",
            quantity(f, "Hz", 3)
        ));
    }
    let slow: Vec<String> = (all.iter())
        .filter_map(|s| {
            let (still, (slow, _)) = (s.statics?, s.runs.first()?);
            Some(format!(
                "{} {} against {}\u{a0}\u{b5}m",
                escape(&s.label),
                short(UM * slow.error_peak_to_peak_m, 3),
                short(UM * still.error_peak_to_peak_m, 3)
            ))
        })
        .collect();
    if !slow.is_empty() {
        sentences.push(format!(
            "At the lowest speed the peak to peak stands against that at rest: {}.",
            slow.join(", ")
        ));
    }
    let apart: Vec<String> = (all.iter())
        .filter_map(|s| {
            let apart = |r: &&Steady| r.separated > 0.0;
            let runs: Vec<&Steady> = s.runs.iter().map(|r| r.0).filter(apart).collect();
            let (first, last) = (runs.first()?, runs.last()?);
            Some(format!(
                "{} between {} and {}",
                escape(&s.label),
                quantity(first.mesh_frequency_hz, "Hz", 3),
                quantity(last.mesh_frequency_hz, "Hz", 3)
            ))
        })
        .collect();
    sentences.push(if apart.is_empty() {
        "The teeth stay in contact at all speeds.".into()
    } else {
        format!("The teeth lift off for {}.", apart.join(", "))
    });
    let failed = (view.results.runs.iter())
        .filter(|r| r.status.is_failure())
        .count();
    if failed > 0 {
        sentences.push(format!(
            "{failed} of {} runs failed and are shown as failures.",
            view.results.runs.len()
        ));
    }
    sentences.join(" ")
}

/// Peaks and static values per model.
pub fn tables(view: &View<'_>) -> String {
    let all = swept(view);
    if all.is_empty() {
        return String::new();
    }
    let plain = |n: usize| {
        [Rows {
            heading: None,
            count: n,
            classes: Vec::new(),
        }]
    };
    let per = |f: &dyn Fn(&Swept<'_>) -> Option<String>| -> Vec<Option<String>> {
        all.iter().map(f).collect()
    };
    let um = |x: f64| Some(significant(UM * x, 3));
    let columns = [
        Column::text("Model", per(&|s| Some(s.label.clone()))),
        Column::written(
            "TE at rest, p-p",
            "\u{b5}m",
            per(&|s| um(s.statics?.error_peak_to_peak_m)),
        ),
        Column::written("mean", "\u{b5}m", per(&|s| um(s.statics?.error_mean_m))),
        Column::written(
            "Mesh stiffness",
            "N/\u{b5}m",
            per(&|s| Some(significant(1e-6 * s.statics?.tangent_n_per_m, 4))),
        ),
        Column::written(
            "fn",
            "kHz",
            per(&|s| Some(significant(1e-3 * s.statics?.resonance_hz?, 3))),
        ),
        Column::written(
            "Greatest TE, rms",
            "\u{b5}m",
            per(&|s| um(s.peak()?.error_rms_m)),
        ),
        Column::written(
            "at mesh frequency",
            "kHz",
            per(&|s| Some(significant(1e-3 * s.peak()?.mesh_frequency_hz, 3))),
        ),
        Column::written(
            "Greatest / mean force",
            "",
            per(&|s| {
                let f = s.runs.iter().map(|(r, _)| r.force_peak_n / r.force_mean_n);
                Some(significant(f.fold(0.0, f64::max), 3))
            }),
        ),
        Column::written(
            "Speeds",
            "",
            per(&|s| Some(format!("{}", s.runs.len() + s.failed.len()))),
        ),
        Column::written("Failed", "", per(&|s| Some(s.failed.len().to_string()))),
    ];
    format!(
        "<section class=\"glance\">\n<h2>At a glance</h2>\n{}<p class=\"note\">TE: transmission error on the line of \
         action. fn: frequency of the gears against each other on the mean tangent stiffness of the mesh. At rest: \
         static equilibria over one base pitch under the same load.</p>\n</section>\n",
        table(&columns, &plain(all.len()))
    )
}

/// Every speed of every model.
pub fn speeds(view: &View<'_>) -> String {
    let all = swept(view);
    let rows: Vec<(usize, &Steady)> = (all.iter().enumerate())
        .flat_map(|(i, s)| s.runs.iter().map(move |(r, _)| (i, *r)))
        .collect();
    let get = |f: &dyn Fn(&Steady) -> f64| -> Vec<Option<f64>> {
        rows.iter().map(|(_, r)| Some(f(r))).collect()
    };
    let mut columns = vec![
        Column::numbers("Mesh frequency", "Hz", 4, &get(&|r| r.mesh_frequency_hz)),
        Column::numbers("Speed", "rad/s", 4, &get(&|r| r.speed_rad_s)),
        Column::numbers("TE mean", "m", 4, &get(&|r| r.error_mean_m)),
        Column::numbers("rms", "m", 3, &get(&|r| r.error_rms_m)),
        Column::numbers("p-p", "m", 3, &get(&|r| r.error_peak_to_peak_m)),
        Column::numbers("Contact force", "N", 4, &get(&|r| r.force_mean_n)),
        Column::numbers("greatest", "N", 4, &get(&|r| r.force_peak_n)),
        Column::percents("apart", 2, &get(&|r| r.separated)),
        Column::percents("irregular", 2, &get(&|r| r.irregular)),
    ];
    let gears: Vec<String> = (rows.first())
        .map(|(_, r)| r.bearings.iter().map(|b| b.gear.clone()).collect())
        .unwrap_or_default();
    for gear in &gears {
        let rms = |r: &Steady| {
            let b = r.bearings.iter().find(|b| b.gear == *gear);
            b.map_or(f64::NAN, |b| b.rms_n)
        };
        columns.push(Column::numbers(
            &format!("Bearing {gear}, rms"),
            "N",
            3,
            &get(&rms),
        ));
    }
    let groups: Vec<Rows> = (all.iter())
        .map(|s| Rows {
            heading: Some((s.label.clone(), s.style)),
            count: s.runs.len(),
            classes: Vec::new(),
        })
        .collect();
    format!(
        "<section>\n<h2>Every speed</h2>\n{}<p class=\"note\">Over whole mesh cycles of steady running. apart: time \
         without contact force. irregular: what does not repeat from cycle to cycle over what does.</p>\n</section>\n",
        table(&columns, &groups)
    )
}
