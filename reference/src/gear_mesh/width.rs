//! Planes of nodes over the face width.

use super::grading::{geometric, refined};
use super::params::Web;

/// Planes over the width; with a web two of them are its faces.
pub(super) fn planes(layers: usize, b: f64, web: Option<&Web>, refine: usize) -> Vec<f64> {
    let even = |n: usize, from: f64, to: f64| {
        geometric(n, 1.0, 1)
            .into_iter()
            .map(move |t| from + (to - from) * t)
    };
    let mut ends: Vec<f64>;
    match web {
        None => ends = even(layers, -0.5 * b, 0.5 * b).collect(),
        Some(w) => {
            let side = sides(layers, b, w);
            let h = 0.5 * w.thickness;
            ends = even(side, -0.5 * b, -h).collect();
            ends.extend(even(layers - 2 * side, -h, h).skip(1));
            ends.extend(even(side, h, 0.5 * b).skip(1));
        }
    }
    refined(&ends, refine)
}

/// Layers beside the web, on each side.
fn sides(layers: usize, b: f64, w: &Web) -> usize {
    let wanted = (layers as f64 * 0.5 * (1.0 - w.thickness / b)).round() as usize;
    wanted.clamp(1, (layers - 1) / 2)
}
