//! Recognition of toothing data from meshes.

use super::*;
use crate::gear_mesh::{self, GearMesh};
use crate::reduction::surface::Surface;
use crate::test_support::{self, counted};
use gearbench_models::gear::elastic::reduced::{FlankCompliance, Residual};

/// A basis of the flanks alone: no modes, no compliance.
pub(in crate::reduction) fn bare(mesh: &GearMesh) -> Basis {
    let surface = Surface::new(mesh).unwrap();
    let n = surface.nodes();
    Basis {
        flanks: surface.flanks,
        normals: surface.directions,
        along_profile: false,
        free: true,
        inertia: 1e-3,
        added_inertia: 0.0,
        unknowns: 3 * mesh.mesh.nodes.len(),
        omega: Vec::new(),
        family: Vec::new(),
        shapes: Vec::new(),
        hub: Vec::new(),
        participation: Vec::new(),
        momentum: Vec::new(),
        unbalance: [0.0; 2],
        compliance: Residual {
            flanks: FlankCompliance::Full(vec![0.0; n * n]),
            hub: vec![0.0; n],
            hub_hub: 0.0,
        },
        near_field: None,
        integrals: None,
        added: [0.0; 2],
        lateral: None,
    }
}

fn close(found: f64, expected: f64, near: f64) {
    assert!(
        (found / expected - 1.0).abs() < near,
        "{found} for {expected}"
    );
}

#[test]
fn a_gear_is_found_again_from_its_flank_nodes() {
    for (teeth, module, angle, shift, helix, standard) in [
        (20, 4e-3, 20.0, 0.0, 0.0, true),
        (17, 2e-3, 20.0, 0.3, 0.0, true),
        (34, 3e-3, 14.5, 0.0, 0.0, true),
        (25, 2.5e-3, 25.0, 0.1, 0.0, true),
        (23, 2.1e-3, 20.0, 0.0, 0.0, false),
        (24, 3e-3, 20.0, 0.0, 20.0, true),
        (24, 3e-3, 20.0, 0.2, -25.0, true),
    ] {
        let gear = test_support::gear(teeth, module, |p| {
            p.pressure_angle = f64::to_radians(angle);
            p.profile_shift = shift;
            p.helix_angle = f64::to_radians(helix);
            p.face_width = 5.0 * module;
            p.tip_radius = 0.3;
            p.bore_radius = 4.0 * module;
        });
        let basis = bare(&gear_mesh::gear(&gear, &counted(6, 1, 2)).unwrap());
        let found = Toothing::of(&basis, Motion::Turn, teeth);
        close(found.tip, gear.r_tip(), 1e-9);
        close(found.base, gear.r_base(), 1e-9);
        close(found.width, gear.face_width(), 1e-9);
        assert_eq!(found.straight, helix == 0.0);
        assert_eq!(found.standard, standard, "{found:?}");
        if standard {
            close(found.module, module, 1e-9);
            assert!((found.readings[0].profile_shift - shift).abs() < 1e-7);
            assert!((found.readings[0].helix_angle - f64::to_radians(helix)).abs() < 1e-9);
            close(found.pressure_angle, f64::to_radians(angle), 1e-12);
        }
    }
}

#[test]
fn a_rack_is_found_again_from_its_flank_nodes() {
    for (module, angle) in [(2e-3, 20.0), (3e-3, 14.5)] {
        let rack = test_support::rack(5, module, |p| {
            p.pressure_angle = f64::to_radians(angle);
            p.face_width = 8e-3;
        });
        let basis = bare(&gear_mesh::rack(&rack, &counted(4, 4, 1)).unwrap());
        let found = Toothing::of(&basis, Motion::Slide, 5);
        close(found.module, module, 1e-9);
        close(found.pressure_angle, f64::to_radians(angle), 1e-9);
        close(found.tip, rack.tip_height(), 1e-9);
        assert!(found.straight && found.standard);
    }
}
