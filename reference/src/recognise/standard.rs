//! Module, pressure angle and profile shift that a base pitch may stand for.
//!
//! Flanks have a base pitch, a base helix angle and a base thickness; module and pressure angle are what the tool was:
//!
//! ```text
//! m_n cos alpha_n = p_b cos beta_b / pi,   sin beta = sin beta_b / cos alpha_n,   r = z m_n / (2 cos beta)
//! x = (s_t cos beta / m_n - pi / 2) / (2 tan alpha_n),   s_t = 2 r (psi_b - inv alpha_t)
//! ```
//!
//! (ISO 21771:2007, 4 and 5). The convention: a normal module of ISO 54 (series I and II) at 20 degrees where there is one,
//! else at another usual angle; all pairs within the uncertainty of the base pitch are given. `x` is that of the teeth as
//! they are: one that was thinned counts as one with less shift. Addendum and dedendum factors are over `m_n`, with that
//! shift.

use super::involute::Involute;
use gearbench_models::geometry::inv;
use std::f64::consts::{FRAC_PI_2, PI};

/// Normal pressure angles that are tried, the most common one first [deg].
const ANGLES: [f64; 7] = [20.0, 14.5, 15.0, 17.5, 22.5, 25.0, 30.0];

/// Modules of ISO 54, both series [mm].
const MODULES: [f64; 36] = [
    1.0, 1.125, 1.25, 1.375, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0,
    6.5, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 25.0, 28.0, 32.0, 36.0,
    40.0, 45.0, 50.0,
];

/// Returns true if a module [m] is one of ISO 54 within a relative tolerance.
pub fn is_standard(module: f64, near: f64) -> bool {
    MODULES
        .iter()
        .any(|m| (1e3 * module / m - 1.0).abs() < near)
}

/// Returns the normal pressure angles [rad] at which a normal base pitch [m] has a module of ISO 54 within a relative
/// tolerance, the most common one first.
pub fn angles(normal_base_pitch: f64, near: f64) -> impl Iterator<Item = f64> {
    ANGLES
        .into_iter()
        .map(f64::to_radians)
        .filter(move |a| is_standard(normal_base_pitch / (PI * a.cos()), near))
}

/// Specification of the tool by the user.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolSpec {
    /// Normal module [m].
    pub module: Option<f64>,
    /// Normal pressure angle [rad].
    pub pressure_angle: Option<f64>,
}

/// A tool that the toothing may have been cut with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolCandidate {
    /// Normal module [m].
    pub module: f64,
    /// Normal pressure angle [rad].
    pub pressure_angle: f64,
    /// Helix angle at the reference circle, right hand positive [rad].
    pub helix_angle: f64,
    /// Profile shift coefficient of the reading.
    pub profile_shift: f64,
    /// Addendum factor of the reading.
    pub addendum: f64,
    /// Dedendum factor of the reading.
    pub dedendum: f64,
    /// True if the module is one of ISO 54.
    pub standard: bool,
}

/// Returns the tools that fit, the most probable first: at least one. `radii` are those of tip and root [m]; `near` is
/// the relative uncertainty of the base pitch.
pub fn readings(fit: &Involute, radii: [f64; 2], near: f64, given: ToolSpec) -> Vec<ToolCandidate> {
    let normal = fit.base_pitch() * fit.base_helix_angle().cos();
    let at = |angle: f64| reading(fit, radii, near, angle);
    match (given.module, given.pressure_angle) {
        (_, Some(angle)) => vec![at(angle)],
        (Some(module), None) => vec![at((normal / (PI * module)).clamp(-1.0, 1.0).acos())],
        (None, None) => {
            let found: Vec<ToolCandidate> = angles(normal, near).map(at).collect();
            match found.is_empty() {
                true => vec![at(ANGLES[0].to_radians())],
                false => found,
            }
        }
    }
}

fn reading(fit: &Involute, [tip, root]: [f64; 2], near: f64, angle: f64) -> ToolCandidate {
    let helix_base = fit.base_helix_angle();
    let exact = fit.base_pitch() * helix_base.cos() / (PI * angle.cos());
    let helix = (helix_base.sin() / angle.cos()).clamp(-1.0, 1.0).asin();
    let r = 0.5 * f64::from(fit.teeth) * exact / helix.cos();
    let transverse = (angle.tan() / helix.cos()).atan();
    let thickness = 2.0 * r * (fit.half_angle - inv(transverse));
    let profile_shift = (thickness * helix.cos() / exact - FRAC_PI_2) / (2.0 * angle.tan());
    ToolCandidate {
        module: exact,
        pressure_angle: angle,
        helix_angle: helix,
        profile_shift,
        addendum: (tip - r) / exact - profile_shift,
        dedendum: (r - root) / exact + profile_shift,
        standard: is_standard(exact, near),
    }
}
