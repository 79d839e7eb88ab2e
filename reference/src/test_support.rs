//! Bodies, meshes and numbers that several tests share.

use crate::mesh::{ElementKind, GearMeshParams, Tooth};
use gearbench_models::geometry::{Gear, GearParams, Rack, RackParams};

/// A gear of the default toothing, changed where a test needs it.
pub(crate) fn gear(teeth: u32, module: f64, change: impl FnOnce(&mut GearParams)) -> Gear {
    let mut params = GearParams {
        teeth,
        module,
        ..GearParams::default()
    };
    change(&mut params);
    Gear::new(params).unwrap()
}

/// A rack likewise.
pub(crate) fn rack(teeth: u32, module: f64, change: impl FnOnce(&mut RackParams)) -> Rack {
    let mut params = RackParams {
        teeth,
        module,
        ..RackParams::default()
    };
    change(&mut params);
    Rack::new(params).unwrap()
}

/// A thick-walled gear with stub teeth: a few hundred unknowns.
pub(crate) fn stub(teeth: u32, helix_angle: f64) -> Gear {
    gear(teeth, 4e-3, |p| {
        p.helix_angle = helix_angle;
        p.pressure_angle = 0.5;
        p.profile_shift = 0.35;
        p.addendum = 0.7;
        p.dedendum = 1.0;
        p.tip_radius = 0.15;
        p.bore_radius = 0.25 * 4e-3 * f64::from(teeth);
    })
}

/// Few elements, for what does not depend on how many.
pub(crate) fn coarse(rim: usize, width: usize) -> GearMeshParams {
    GearMeshParams {
        kind: ElementKind::C3D8,
        tooth: Tooth::coarse(),
        layers: 1,
        rim,
        width,
        ..GearMeshParams::default()
    }
}

/// Numbers that look random and repeat.
pub(crate) fn noise(n: usize, size: f64) -> Vec<f64> {
    (0..n)
        .map(|i| size * ((i as f64 * 12.9898).sin() * 43_758.545_3).fract())
        .collect()
}
