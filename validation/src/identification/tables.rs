//! Tables of identified constants in Markdown.

use super::{BARS, N_PER_MM_UM, SceneFits, is_within_bars};
use gearbench_reports::identify::DataRecord;
use std::fmt::Write as _;

/// Writes the tables of all scenes in Markdown.
pub fn markdown(all: &[SceneFits], command: &str) -> String {
    let mut out = format!("<!-- {command} -->\n");
    let percent = |x: Option<f64>| x.map_or_else(|| "-".into(), |x| format!("{:+.2} %", 100.0 * x));
    for scene in all {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "\n## {}\n\n| model | data | force L2 | peak | impulse |\n|---|---|---|---|---|",
            scene.scene
        );
        for fit in &scene.fits {
            for d in &fit.found.record.data {
                let DataRecord { name, l2, .. } = d;
                let _ = writeln!(
                    out,
                    "| {} | {name}{} | {:.2} % | {} | {} |",
                    fit.name,
                    if d.validation { "" } else { ", fitted" },
                    100.0 * l2,
                    percent(d.peak_rel),
                    percent(d.impulse_rel)
                );
            }
        }
        let [force, peak, impulse, other] = BARS.map(|x| format!("{:.1} %", 100.0 * x));
        let kept: Vec<&str> = (scene.fits.iter())
            .filter(|f| is_within_bars(f))
            .map(|f| f.name)
            .collect();
        let _ = writeln!(
            out,
            "\nWithin {force} (force), {peak} (peak) and {impulse} (impulse) where fitted and {other} at the other speeds: {}.",
            if kept.is_empty() {
                "none".to_owned()
            } else {
                kept.join("; ")
            }
        );
        let _ = writeln!(
            out,
            "\n| stiffness | convention | as stated | of a pair on the line of action, N/(mm um) | of the mesh |\n|---|---|---|---|---|"
        );
        for s in &scene.stiffnesses {
            let number = |i: usize| {
                s.pair_and_mesh
                    .map_or_else(|| "-".into(), |x| format!("{:.2}", x[i] / N_PER_MM_UM))
            };
            let _ = writeln!(
                out,
                "| {} | {} | {} | {} | {} |",
                s.source,
                s.convention,
                s.stated,
                number(0),
                number(1)
            );
        }
        let _ = writeln!(out);
        for fit in &scene.fits {
            for p in &fit.found.record.parameters {
                let end = |x: Option<f64>| x.map_or_else(|| "open".into(), |x| format!("{x:.3e}"));
                let value = p
                    .value
                    .map_or_else(String::new, |x| format!(" {x:.4e} {}", p.unit));
                let _ = writeln!(
                    out,
                    "- {}: `{}`{value}, {} (95 %: {} to {})",
                    fit.name,
                    p.key,
                    p.outcome,
                    end(p.low),
                    end(p.high)
                );
            }
        }
    }
    out
}
