//! Mesh stiffness, load sharing and transmission error over the path of contact.

use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
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
    fn repeated(&self, values: &[f64], [low, high]: [f64; 2], scale: f64) -> Vec<(f64, f64)> {
        let first = (low - 1.0).floor() as i64;
        (first..=(high.ceil() as i64 + 1))
            .flat_map(|turn| {
                let points = self.position.iter().zip(values);
                points.map(move |(p, v)| (p + turn as f64, v * scale))
            })
            .filter(|(at, _)| (low..=high).contains(at))
            .collect()
    }
}

/// The chart.
///
/// # Errors
/// [`DrawError`] when the backend refuses.
pub fn stiffness(all: &StiffnessCurves) -> Result<Chart, DrawError> {
    let window = [all.path[0] - MARGIN, all.path[1] + MARGIN];
    let x = Axis::linear(window[0], window[1]);
    let curves = || all.curves.iter().enumerate();
    let entries: Vec<Entry> = curves()
        .map(|(k, c)| Entry::line(&c.label, model_stroke(k)))
        .collect();
    let panel = |y_name: &str, remark: &str, lines: Vec<Curve>, top: Option<f64>| {
        let mut panel = Panel::new(190.0, &x, y_name).remark(remark).curves(lines);
        let axis = Axis::from_zero(top.unwrap_or(1.18 * panel.ordinates().1));
        // Ends of the path, and pitch point, over the whole height.
        let marks = [all.path[0], 0.0, all.path[1]].map(|at| {
            let stroke = Stroke::dashed(Ink::PALE, 1.2, &[4.0, 3.0]);
            Curve::line(stroke, vec![(at, 0.0), (at, axis.max)])
        });
        panel.curves.splice(0..0, marks);
        panel.y = Some(axis);
        panel
    };
    let cyclic = |values: fn(&StiffnessCurve) -> &[f64], scale: f64| -> Vec<Curve> {
        curves()
            .map(|(k, c)| Curve::line(model_stroke(k), c.repeated(values(c), window, scale)))
            .collect()
    };
    let shares = curves()
        .map(|(k, c)| {
            let points = c.pair_position.iter().zip(&c.pair_share);
            Curve::line(
                model_stroke(k),
                points.map(|(x, y)| (*x, 100.0 * y)).collect(),
            )
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
    panels[2].x_name = Some("path coordinate from the pitch point / base pitch".into());
    let caption = format!(
        "{} Pale lines: start of contact, pitch point, end of contact. Stiffness and transmission error repeat with the \
         base pitch.",
        all.remark
    );
    let title = "Mesh stiffness, load sharing, transmission error";
    chart("stiffness.svg", title, caption, &entries, &panels)
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
        let (x, y): (Vec<f64>, Vec<f64>) = curve
            .repeated(&curve.mesh, [-0.8, 0.8], 1e-9)
            .into_iter()
            .unzip();
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
