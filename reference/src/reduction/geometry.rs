//! Toothing data from the flanks of a mesh: teeth, radii, module.
//!
//! The flanks of a gear carry an involute ([`crate::recognise::involute`]): base radius, base helix and base thickness by
//! least squares over the flank nodes, end reliefs left out; module and pressure angle are those of
//! [`crate::recognise::standard`]. The flanks of a rack are planes whose normals stand at the pressure angle to its
//! displacement, one pitch apart.

use super::Basis;
use super::store::Motion;
use crate::recognise::standard::{is_standard, readings};
use crate::recognise::{self, FlankPoint, Involute, ToolCandidate, ToolSpec};
use gearbench_models::Vec3;
use gearbench_models::geometry::{FlankGrid, Side};
use std::f64::consts::PI;

/// By which part the base pitch of a mesh may be off before a module counts as none of the standard.
const NEAR: f64 = 2e-3;

/// Nodes nearer to the involute than this part of the tip radius are on it.
const FINE: f64 = 1e-7;

/// A toothing as its flank nodes show it.
#[derive(Clone, Debug, PartialEq)]
pub struct Toothing {
    /// Largest radius of a flank node [m], for an internal gear the smallest one; for a rack the height of its tips
    /// above the reference line.
    pub tip: f64,
    /// Radius at the other end of the flanks [m]; of a rack the height there, negative below the reference line.
    pub low: f64,
    /// Base radius [m]; for a rack its base pitch over 2 pi, the equivalent of a base radius per tooth.
    pub base: f64,
    /// Width of the flanks [m].
    pub width: f64,
    /// Normal module [m] at the pressure angle; for a rack the transverse one.
    pub module: f64,
    /// Normal pressure angle [rad], for a gear the most probable; for a rack the transverse one.
    pub pressure_angle: f64,
    /// True if the module is one of ISO 54.
    pub standard: bool,
    /// Every flank runs parallel to z: spur toothing without crowning.
    pub straight: bool,
    /// The involute through the flank nodes of a gear.
    pub involute: Option<Involute>,
    /// Tools that it may have been cut with, the likeliest first; dedendum factors count to the lowest flank node.
    pub readings: Vec<ToolCandidate>,
}

impl Toothing {
    /// Looks at the flanks of a basis; `teeth` of the whole gear.
    pub fn of(basis: &Basis, motion: Motion, teeth: u32) -> Self {
        let grids = basis.flanks.grids();
        let positions: Vec<Vec3> = grids
            .iter()
            .flat_map(|g| g.positions.iter().copied())
            .collect();
        let height = |x: &Vec3| match motion {
            Motion::Turn => x.x.hypot(x.y),
            Motion::Slide => -x.x,
        };
        let extent = |of: &dyn Fn(&Vec3) -> f64| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            positions
                .iter()
                .map(of)
                .fold(ends, |e, v| (e.0.min(v), e.1.max(v)))
        };
        let (low, tip) = extent(&height);
        let inward = motion == Motion::Turn
            && grids.first().is_some_and(|g| {
                let ends = [g.positions.first(), g.positions.last()];
                let [root, tip] = ends.map(|x| x.map_or(0.0, &height));
                root > tip
            });
        let (back, front) = extent(&|x| x.z);
        let straight = grids.iter().all(|g| {
            g.positions.chunks_exact(g.columns.max(1)).all(|row| {
                let off = row.iter().map(|x| (x.xy() - row[0].xy()).norm());
                off.fold(0.0, f64::max) < 1e-9 * tip.abs().max(front - back)
            })
        });
        let pairs = || positions.iter().zip(&basis.normals);
        let mut involute = None;
        let mut tools = Vec::new();
        let (base, module, pressure_angle, standard) = match motion {
            Motion::Turn => {
                let across = |n: &Vec3| n.x.hypot(n.y);
                let base =
                    median(pairs().map(|(x, n)| ((x.x * n.y - x.y * n.x) / across(n)).abs()));
                let twist = median(pairs().map(|(x, n)| -n.z / (x.x * n.y - x.y * n.x)));
                let points: Vec<FlankPoint> = grids.iter().flat_map(points).collect();
                involute = Involute::guess(teeth, base, twist).fitted_to_most(&points, FINE * tip);
                // A pinion-type cutter cannot be derived from the gear.
                tools = (involute.as_ref().filter(|_| !inward)).map_or(Vec::new(), |fit| {
                    readings(fit, [tip, low], NEAR, ToolSpec::default())
                });
                let base = involute.map_or(base, |fit| fit.base_radius);
                match tools.first() {
                    Some(tool) => (base, tool.module, tool.pressure_angle, tool.standard),
                    None => (base, f64::NAN, f64::NAN, false),
                }
            }
            Motion::Slide => {
                let angle = median(pairs().map(|(_, n)| n.x.abs().atan2(n.y.abs())));
                let module = rack_pitch(basis) / PI;
                (
                    module * angle.cos() / 2.0,
                    module,
                    angle,
                    is_standard(module, NEAR),
                )
            }
        };
        let (low, tip) = if inward { (tip, low) } else { (low, tip) };
        Toothing {
            tip,
            low,
            base,
            width: front - back,
            module,
            pressure_angle,
            standard,
            straight,
            // The half angle of an internal flank is that of the tooth space, so that no tooth thickness is reported.
            involute: involute.filter(|_| !inward),
            readings: tools,
        }
    }
}

/// The nodes of a flank about the axis.
fn points(grid: &FlankGrid) -> impl Iterator<Item = FlankPoint> + '_ {
    grid.positions.iter().map(|x| FlankPoint {
        radius: x.x.hypot(x.y),
        angle: x.y.atan2(x.x),
        height: x.z,
        tooth: grid.tooth,
        side: grid.side,
    })
}

/// The median of values; not a number where there are none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    recognise::median(values).unwrap_or(f64::NAN)
}

/// Returns the smallest distance of two flanks of one side along the displacement.
fn rack_pitch(basis: &Basis) -> f64 {
    let of = |side: Side| {
        let own = basis.flanks.grids().iter().filter(|g| g.side == side);
        let mut places: Vec<f64> = own
            .filter_map(|g| g.positions.first().map(|x| x.y))
            .collect();
        places.sort_by(f64::total_cmp);
        let steps = places.windows(2).map(|w| w[1] - w[0]);
        steps.fold(f64::INFINITY, f64::min)
    };
    let pitch = of(Side::Left).min(of(Side::Right));
    if pitch.is_finite() { pitch } else { f64::NAN }
}

#[cfg(test)]
pub(super) mod tests;
