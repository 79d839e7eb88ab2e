//! Mesh stiffness, load sharing and transmission error over the path of contact.

use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke, draw};
use crate::drawing::lines::{Entry, Line, Panel, WIDTH, height, paint};
use crate::drawing::style::model_stroke;

/// What one model says of a mesh. Positions are path coordinates of a pair from the pitch point over the base
/// pitch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StiffnessCurve {
    /// Name in the legend.
    pub label: String,
    /// Positions of the reference pair over one mesh cycle, ascending.
    pub position: Vec<f64>,
    /// Secant stiffness of the mesh over the face width there \[N/m^2\].
    pub mesh: Vec<f64>,
    /// Static transmission error there \[m\].
    pub error: Vec<f64>,
    /// Positions of one pair along its path, ascending.
    pub pair_position: Vec<f64>,
    /// Its part of the load there, 0 to 1.
    pub pair_share: Vec<f64>,
}

/// Curves of several models under one load.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StiffnessCurves {
    /// What was loaded and how, for the caption.
    pub remark: String,
    /// Start and end of the path of contact, from the pitch point over the base pitch.
    pub path: [f64; 2],
    /// The models.
    pub curves: Vec<StiffnessCurve>,
}

/// N/(mm um) in \[N/m^2\].
const PER_MM_UM: f64 = 1e9;
/// Room beside the path on the abscissa.
const MARGIN: f64 = 0.08;

impl StiffnessCurve {
    /// Repeats values of the cycle at all positions within a range.
    fn repeated(&self, values: &[f64], [low, high]: [f64; 2], scale: f64) -> (Vec<f64>, Vec<f64>) {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        let first = (low - 1.0).floor() as i64;
        for turn in first..=(high.ceil() as i64 + 1) {
            for (p, v) in self.position.iter().zip(values) {
                let at = p + turn as f64;
                if (low..=high).contains(&at) {
                    x.push(at);
                    y.push(v * scale);
                }
            }
        }
        (x, y)
    }
}

/// The chart.
///
/// # Errors
/// [`DrawError`] when the backend refuses.
pub fn stiffness(all: &StiffnessCurves) -> Result<Chart, DrawError> {
    let window = [all.path[0] - MARGIN, all.path[1] + MARGIN];
    let x = Axis::linear(window[0], window[1]);
    let strokes: Vec<Stroke> = (0..all.curves.len()).map(model_stroke).collect();
    let entries: Vec<Entry> = all
        .curves
        .iter()
        .zip(&strokes)
        .map(|(c, &stroke)| Entry {
            text: c.label.clone(),
            stroke,
        })
        .collect();
    // Ends of the path, and pitch point, over the whole height of a panel.
    let marks = |top: f64| -> Vec<Line> {
        [all.path[0], 0.0, all.path[1]]
            .into_iter()
            .map(|at| Line {
                x: vec![at, at],
                y: vec![0.0, top],
                stroke: Stroke::dashed(Ink::PALE, 1.2, &[4.0, 3.0]),
            })
            .collect()
    };
    let panel = |y_name: &str, remark: &str, lines: Vec<Line>, top: Option<f64>| {
        let greatest = lines
            .iter()
            .flat_map(|l| &l.y)
            .filter(|y| y.is_finite())
            .fold(0.0_f64, |m, y| m.max(*y));
        let axis = Axis::from_zero(top.unwrap_or(1.18 * greatest));
        let mut shown = marks(axis.max);
        shown.extend(lines);
        Panel {
            height: 190.0,
            y_name: y_name.into(),
            y: Some(axis),
            x: x.clone(),
            remark: remark.into(),
            lines: shown,
            x_name: None,
        }
    };
    let cyclic = |values: fn(&StiffnessCurve) -> &[f64], scale: f64| -> Vec<Line> {
        all.curves
            .iter()
            .zip(&strokes)
            .map(|(c, &stroke)| {
                let (x, y) = c.repeated(values(c), window, scale);
                Line { x, y, stroke }
            })
            .collect()
    };
    let shares = all
        .curves
        .iter()
        .zip(&strokes)
        .map(|(c, &stroke)| Line {
            x: c.pair_position.clone(),
            y: c.pair_share.iter().map(|y| 100.0 * y).collect(),
            stroke,
        })
        .collect();
    let mut panels = vec![
        panel(
            "stiffness / N/(mm µm)",
            "mesh stiffness, secant",
            cyclic(|c| &c.mesh, 1.0 / PER_MM_UM),
            None,
        ),
        panel("share / %", "load of one tooth pair", shares, Some(110.0)),
        panel(
            "error / µm",
            "static transmission error",
            cyclic(|c| &c.error, 1e6),
            None,
        ),
    ];
    if let Some(last) = panels.last_mut() {
        last.x_name = Some("path coordinate from the pitch point / base pitch".into());
    }
    let title = "Mesh stiffness, load sharing, transmission error";
    let svg = draw(WIDTH, height(&panels, &entries), title, |c| {
        paint(c, &panels, &entries);
    })?;
    Ok(Chart {
        file: "stiffness.svg".into(),
        title,
        caption: format!(
            "{} Pale lines: start of contact, pitch point, end of contact. Stiffness and transmission error \
             repeat with the base pitch.",
            all.remark
        ),
        svg,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cycle_is_repeated_over_the_path() {
        let curve = StiffnessCurve {
            label: "a".into(),
            position: vec![-0.5, -0.25, 0.0, 0.25],
            mesh: vec![1e10, 2e10, 3e10, 4e10],
            error: vec![1e-6; 4],
            pair_position: vec![-0.8, 0.8],
            pair_share: vec![0.3, 1.0],
        };
        let (x, y) = curve.repeated(&curve.mesh, [-0.8, 0.8], 1e-9);
        assert_eq!(x, [-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75]);
        let expected = [40.0, 10.0, 20.0, 30.0, 40.0, 10.0, 20.0];
        assert!(y.iter().zip(expected).all(|(y, e)| (y - e).abs() < 1e-12));
        let chart = stiffness(&StiffnessCurves {
            remark: "At 300 N/mm.".into(),
            path: [-0.8, 0.8],
            curves: vec![curve],
        })
        .unwrap();
        assert!(chart.svg.starts_with("<svg") && chart.caption.contains("300 N/mm"));
        for word in ["share", "stiffness", "error", "base pitch"] {
            assert!(chart.svg.contains(word), "{word}");
        }
    }
}
