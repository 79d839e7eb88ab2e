//! Starting points for a fit of the model to a reference impact.

use crate::gear::properties::{Fit, Start};
use crate::spec::GearSpec;
use std::f64::consts::PI;

/// Fit of the stiffness and the mass of a tooth.
pub const FIT: Fit = Fit {
    parameters: &["tooth_stiffness_n_per_m", "tooth_mass_kg"],
    starts,
};

/// Returns starting points with different splits of the compliance of a pair between contact and teeth, `1/pair =
/// 1/contact + 2/tooth`, because the sum of squares has more than one minimum. A tooth is roughly a bar of half a
/// pitch by 2.25 modules.
fn starts(pair: f64, gear: &GearSpec) -> Vec<Start> {
    let (width, m) = (gear.body.face_width(), gear.body.module());
    let tooth_mass = gear.material.density * 0.5 * PI * m * 2.25 * m * width;
    let mut all = Vec::new();
    for share in [0.35, 0.6] {
        for mass in [0.7, 1.4] {
            let tooth = 2.0 * pair / (1.0 - share) * width;
            all.push(Start {
                contact: pair / share,
                parameters: vec![tooth, mass * tooth_mass],
            });
        }
    }
    all
}
