//! Shapes of the modes of a gear of equal sectors at its flank nodes.

use super::Shape;
use crate::modes::cyclic::{CyclicModes, Part};
use crate::reduction::rigid::ModeMotion;
use crate::reduction::surface::Surface;
use crate::vector::dot;

/// Momentum of a mode of a cyclic gear along x and y. With the momentum `s` of the sector the teeth add up to
///
/// ```text
/// sum_t R^t Re(s exp(i t mu_n)) = z/2 (Re s_x + Im s_y, Re s_y - Im s_x)   for n = 1, else 0
/// ```
///
/// and `s` becomes `-i s` for the sine part.
pub(super) fn cyclic_momentum(found: &CyclicModes, mode: usize, masses: &[f64]) -> [f64; 2] {
    let m = &found.modes[mode];
    if m.harmonic != 1 {
        return [0.0; 2];
    }
    let u = found.shapes[1].col(m.column);
    let [x, y] = [0, 1].map(|axis| {
        (masses.iter().enumerate()).fold((0.0, 0.0), |(re, im), (node, m)| {
            let c = u[3 * node + axis];
            (re + m * c.re, im + m * c.im)
        })
    });
    let half = 0.5 * f64::from(found.sectors);
    match m.part {
        Part::Single | Part::Cosine => [half * (x.0 + y.1), half * (y.0 - x.1)],
        Part::Sine => [half * (x.1 - y.0), half * (y.1 + x.0)],
    }
}

/// Returns a mode of a cyclic gear at its flank nodes; `bore` is a node tied to the hub.
pub(super) fn cyclic_shape(
    found: &CyclicModes,
    mode: usize,
    nodes: &Surface,
    rigid: &[f64],
    pull: &[f64],
    bore: usize,
) -> Shape {
    let m = &found.modes[mode];
    let u = found.shapes[m.harmonic as usize].col(m.column);
    let teeth = u64::from(found.sectors);
    let per_tooth = nodes.directions.len() / found.sectors as usize;
    let along: Vec<(f64, f64)> = (nodes.mesh_nodes.iter().zip(&nodes.directions))
        .take(per_tooth)
        .map(|(&node, n)| {
            (0..3).fold((0.0, 0.0), |(re, im), axis| {
                let c = u[3 * node as usize + axis];
                (re + n[axis] * c.re, im + n[axis] * c.im)
            })
        })
        .collect();
    let flanks = (0..teeth)
        .flat_map(|tooth| {
            // Whole turns taken out first: exact phases for all teeth.
            let turns = (tooth * u64::from(m.harmonic)) % teeth;
            let (sin, cos) = (std::f64::consts::TAU * turns as f64 / teeth as f64).sin_cos();
            along.iter().map(move |(re, im)| match m.part {
                Part::Single | Part::Cosine => re * cos - im * sin,
                Part::Sine => re * sin + im * cos,
            })
        })
        .collect();
    // The hub turns, and the gear has angular momentum, only where all teeth move alike.
    let (mut hub, mut momentum) = (0.0, 0.0);
    if m.harmonic == 0 {
        let real = |i: usize| u[i].re;
        let of_bore = 3 * bore..3 * bore + 3;
        let unit = &rigid[of_bore.clone()];
        hub = of_bore.zip(unit).map(|(i, e)| real(i) * e).sum::<f64>() / dot(unit, unit);
        momentum = teeth as f64
            * pull
                .iter()
                .enumerate()
                .map(|(i, p)| real(i) * p)
                .sum::<f64>();
    }
    Shape {
        omega2: m.omega2,
        flanks,
        hub,
        momentum,
        linear: [0.0; 2],
        moved: ModeMotion::default(),
    }
}
