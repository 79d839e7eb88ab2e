//! Sectors of generated meshes: modes of one sector compared with those of the whole mesh.

use super::{gear, sector};
use crate::modes::cyclic::{self, Hub};
use crate::modes::{self, Options};
use crate::test_support::{counted, tied};
use gearbench_models::geometry::{Gear, GearParams, Internal};
use gearbench_models::stiffness::Material;

/// The hub of an internal gear is its rim, and its cuts run outwards.
#[test]
fn internal_gears_on_their_rims() {
    let g = Gear::new(GearParams {
        teeth: 61,
        module: 4e-3,
        addendum: 0.8,
        profile_shift: -0.2,
        tip_radius: 0.25,
        helix_angle: 0.2,
        internal: Some(Internal {
            cutter_teeth: Some(23),
            rim_radius: Some(0.15),
            ..Internal::default()
        }),
        ..GearParams::default()
    });
    let (g, params) = (g.unwrap(), counted(3, 2, 1));
    let (hub, options, count) = (Hub::turning(1e-3), Options::default(), 30);
    let of_sector = sector(&g, &params).unwrap();
    let found = cyclic::lowest(
        &of_sector.as_sector(),
        &Material::STEEL,
        &hub,
        count,
        &options,
    );
    let whole = gear(&g, &params).unwrap();
    let (_, matrices) = tied(&whole, &hub.motions, &hub.added_inertia);
    let expected = modes::lowest(&matrices, count, &options).unwrap();
    for (i, (mode, omega2)) in found
        .unwrap()
        .modes
        .iter()
        .zip(&expected.omega2)
        .enumerate()
    {
        // The first mode is the rotation of the free hub.
        let scale = omega2.max(expected.omega2[1]);
        assert!(
            (mode.omega2 - omega2).abs() < 1e-8 * scale,
            "mode {i}: {} {omega2}",
            mode.omega2
        );
    }
}
