//! Charts of mesh stiffness, load sharing and transmission error over the path of contact.

use super::{ModelStiffness, PER_MM_UM, StiffnessPosition};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::model_stroke;
use crate::numbers::{round_quantity, short};

/// Margin beyond the path of contact on the abscissa [base pitches].
const MARGIN: f64 = 0.08;

/// Returns the values of the cycle, repeated with the base pitch at all positions within a range.
fn repeated(
    model: &ModelStiffness,
    value: impl Fn(&StiffnessPosition) -> f64,
    [low, high]: [f64; 2],
) -> Vec<(f64, f64)> {
    let first = (low - 1.0).floor() as i64;
    let last = high.ceil() as i64 + 1;
    let point = |turn: i64, p: &StiffnessPosition| {
        (model.relative(p.path_coordinate_m) + turn as f64, value(p))
    };
    (first..=last)
        .flat_map(|turn| model.positions.iter().map(move |p| (turn, p)))
        .map(|(turn, p)| point(turn, p))
        .filter(|(at, _)| (low..=high).contains(at))
        .collect()
}

/// Returns the part of the load that one tooth pair carries along its path [%].
fn shares(model: &ModelStiffness) -> Vec<(f64, f64)> {
    let positions = model.positions.iter();
    let mut all: Vec<(f64, f64)> = positions
        .flat_map(|p| {
            p.pairs.iter().map(move |pair| {
                let at = p.path_coordinate_m + pair.offset as f64 * model.base_pitch_m;
                (model.relative(at), 100.0 * pair.force_n / p.force_n)
            })
        })
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Draws the chart of all models under one load.
pub fn charts(stiffness: &[ModelStiffness]) -> Result<Vec<Chart>, DrawError> {
    let shown = || {
        let all = stiffness.iter().enumerate();
        all.filter(|(_, m)| !m.positions.is_empty())
    };
    let Some((_, first)) = shown().next() else {
        return Ok(Vec::new());
    };
    // A path of more base pitches than gears have teeth is none.
    let path = first.path_m.map(|s| first.relative(s).clamp(-100.0, 100.0));
    if !path.iter().all(|s| s.is_finite()) {
        return Ok(Vec::new());
    }
    let window = [path[0] - MARGIN, path[1] + MARGIN];
    let x = Axis::linear(window[0], window[1]);
    let entries: Vec<Entry> = shown()
        .map(|(k, m)| Entry::line(&m.label, model_stroke(k)))
        .collect();
    let panel = |y_name: &str, remark: &str, lines: Vec<Curve>, top: Option<f64>| {
        let mut panel = Panel::new(190.0, &x, y_name).remark(remark).curves(lines);
        let axis = Axis::from_zero(top.unwrap_or(1.18 * panel.ordinates().1));
        // Ends of the path, and pitch point, over the whole height.
        let marks = [path[0], 0.0, path[1]].map(|at| {
            let stroke = Stroke::dashed(Ink::PALE, 1.2, &[4.0, 3.0]);
            Curve::line(stroke, vec![(at, 0.0), (at, axis.max)])
        });
        panel.curves.splice(0..0, marks);
        panel.y = Some(axis);
        panel
    };
    let cyclic = |value: &dyn Fn(&ModelStiffness, &StiffnessPosition) -> f64| -> Vec<Curve> {
        shown()
            .map(|(k, m)| Curve::line(model_stroke(k), repeated(m, |p| value(m, p), window)))
            .collect()
    };
    let of_pairs = shown()
        .map(|(k, m)| Curve::line(model_stroke(k), shares(m)))
        .collect();
    let mut panels = vec![
        panel(
            "stiffness / N/(mm µm)",
            "mesh stiffness, secant",
            cyclic(&|m, p| p.secant() / (m.face_width_m * PER_MM_UM)),
            None,
        ),
        panel("share / %", "load of one tooth pair", of_pairs, Some(110.0)),
        panel(
            "error / µm",
            "static transmission error",
            cyclic(&|_, p| 1e6 * p.error_m),
            None,
        ),
    ];
    panels[2].x_name = Some("path coordinate from the pitch point / base pitch".into());
    let limits: String = (stiffness.iter())
        .flat_map(|m| {
            m.limits
                .iter()
                .map(move |l| format!(" Out of range: {}: {l}.", m.label))
        })
        .collect();
    let caption = format!(
        "Under {} along the line of action, {}\u{a0}N/mm.{limits} Pale lines: start of contact, pitch point, end of contact. \
         Stiffness and transmission error repeat with the base pitch.",
        round_quantity(first.force_n, "N", 4),
        short(1e-3 * first.line_load(), 4)
    );
    let title = "Mesh stiffness, load sharing, transmission error";
    chart("stiffness.svg", title, caption, &entries, &panels).map(|c| vec![c])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::stiffness::PairLoad;

    #[test]
    fn the_cycle_is_repeated_over_the_path() {
        let position = |i: i32| StiffnessPosition {
            path_coordinate_m: 0.012 * (0.25 * f64::from(i) - 0.5),
            error_m: 1e-6 / f64::from(i + 1),
            force_n: 100.0,
            pairs: vec![PairLoad {
                offset: 0,
                force_n: 30.0,
            }],
            ..StiffnessPosition::default()
        };
        let model = ModelStiffness {
            label: "a".into(),
            force_n: 100.0,
            face_width_m: 0.01,
            base_pitch_m: 0.012,
            path_m: [-0.8 * 0.012, 0.8 * 0.012],
            positions: (0..4).map(position).collect(),
            ..ModelStiffness::default()
        };
        let secant = |p: &StiffnessPosition| p.secant() / 1e8;
        let (x, y): (Vec<f64>, Vec<f64>) =
            repeated(&model, secant, [-0.8, 0.8]).into_iter().unzip();
        let near = |a: &[f64], b: &[f64]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        assert!(
            near(&x, &[-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75]),
            "{x:?}"
        );
        assert!(near(&y, &[4.0, 1.0, 2.0, 3.0, 4.0, 1.0, 2.0]), "{y:?}");
        assert!(shares(&model).iter().all(|s| (s.1 - 30.0).abs() < 1e-12));
        let chart = charts(&[model]).unwrap().remove(0);
        assert!(chart.svg.starts_with("<svg") && chart.caption.contains("10\u{a0}N/mm"));
        for word in ["share", "stiffness", "error", "base pitch"] {
            assert!(chart.svg.contains(word), "{word}");
        }
    }
}
