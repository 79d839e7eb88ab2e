//! What the flanks of a mesh tell of its toothing: teeth, radii, module.
//!
//! A spur or helical involute has its normals tangent to the base cylinder, so that every flank node gives the base
//! radius `r_b = |x n_y - y n_x| / sqrt(n_x^2 + n_y^2)`; their median is taken, for end reliefs and splines bend the
//! outermost normals. `m = 2 r_b / (z cos alpha)` then leaves one unknown, the pressure angle. The flanks of a rack
//! are planes whose normals stand at the pressure angle to its displacement, one pitch apart.

use super::Basis;
use super::store::Motion;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use std::f64::consts::PI;

/// Pressure angles that are tried, the usual one first [deg].
const ANGLES: [f64; 6] = [20.0, 14.5, 15.0, 22.5, 25.0, 17.5];

/// Modules of ISO 54, both series [mm].
const MODULES: [f64; 36] = [
    1.0, 1.125, 1.25, 1.375, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0,
    6.5, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 25.0, 28.0, 32.0, 36.0,
    40.0, 45.0, 50.0,
];

/// How far a module may be from one of the standard.
const NEAR: f64 = 2e-3;

/// A toothing as its flank nodes show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toothing {
    /// Largest radius of a flank node [m]; of a rack the height of its tips above the reference line.
    pub tip: f64,
    /// Smallest radius of a flank node [m]; of a rack the height there, negative below the reference line.
    pub low: f64,
    /// Base radius [m]; of a rack its base pitch over 2 pi, what a gear's base radius is per tooth.
    pub base: f64,
    /// Width of the flanks [m].
    pub width: f64,
    /// Transverse module [m] at the pressure angle.
    pub module: f64,
    /// Transverse pressure angle [rad]; of a gear the likeliest.
    pub pressure_angle: f64,
    /// The module is one of ISO 54.
    pub standard: bool,
    /// Every flank runs parallel to z: spur toothing without crowning.
    pub straight: bool,
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
        let (back, front) = extent(&|x| x.z);
        let straight = grids.iter().all(|g| {
            g.positions.chunks_exact(g.columns.max(1)).all(|row| {
                let off = row.iter().map(|x| (x.xy() - row[0].xy()).norm());
                off.fold(0.0, f64::max) < 1e-9 * tip.abs().max(front - back)
            })
        });
        let pairs = || positions.iter().zip(&basis.normals);
        let (base, module, pressure_angle, standard) = match motion {
            Motion::Turn => {
                let base =
                    median(pairs().map(|(x, n)| ((x.x * n.y - x.y * n.x) / n.x.hypot(n.y)).abs()));
                let at = |angle: f64| 2.0 * base / (f64::from(teeth) * angle.to_radians().cos());
                let likely = ANGLES.into_iter().find(|a| is_standard(at(*a)));
                let angle = likely.unwrap_or(ANGLES[0]);
                (base, at(angle), angle.to_radians(), likely.is_some())
            }
            Motion::Slide => {
                let angle = median(pairs().map(|(_, n)| n.x.abs().atan2(n.y.abs())));
                let module = rack_pitch(basis) / PI;
                (
                    module * angle.cos() / 2.0,
                    module,
                    angle,
                    is_standard(module),
                )
            }
        };
        Toothing {
            tip,
            low,
            base,
            width: front - back,
            module,
            pressure_angle,
            standard,
            straight,
        }
    }
}

fn is_standard(module: f64) -> bool {
    MODULES
        .iter()
        .any(|m| (1e3 * module / m - 1.0).abs() < NEAR)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Least distance along the displacement of two flanks of one side.
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
