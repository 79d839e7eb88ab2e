//! Meshes of internal gears: nodes on the flanks and the rim, volume and inertia of the section, sectors.

use super::tests::{assert_conforming, small};
use super::*;
use crate::mesh::{ElementKind, quality};
use crate::test_support::layered;
use gearbench_models::Vec3;
use gearbench_models::contact::points::nodal_normals;
use gearbench_models::geometry::{Flanks, Gear, GearParams, Internal, Side};

fn ring(helix_angle: f64) -> Gear {
    Gear::new(GearParams {
        teeth: 61,
        module: 4e-3,
        addendum: 0.8,
        profile_shift: -0.2,
        tip_radius: 0.25,
        helix_angle,
        internal: Some(Internal {
            cutter_teeth: Some(23),
            rim_radius: Some(0.15),
            ..Internal::default()
        }),
        ..GearParams::default()
    })
    .unwrap()
}

#[test]
fn a_ring_is_closed_conforming_and_held_outside() {
    for kind in [ElementKind::C3D8, ElementKind::C3D20] {
        let (g, p) = (ring(0.0), layered(kind, 2));
        let m = gear(&g, &p).unwrap();
        assert!(assert_conforming(&m.mesh) > 0);
        for &n in &m.bore {
            let r = m.mesh.nodes[n as usize].xy().norm();
            assert!((r / g.seat_radius() - 1.0).abs() < 1e-13);
        }
        let mass = g.mass_properties(1.0);
        let q = quality(&m.mesh);
        // Chords of circles and involutes.
        let bound = if kind == ElementKind::C3D8 {
            3e-4
        } else {
            1e-6
        };
        assert!((q.volume / mass.mass - 1.0).abs() < bound);
        assert!((q.polar_moment / mass.izz - 1.0).abs() < bound);
        assert!(q.min_scaled_jacobian > 0.4);
    }
}

#[test]
fn flanks_of_a_ring_lie_on_the_involute_helicoid() {
    for beta in [0.0, 0.3] {
        let g = ring(beta);
        let m = gear(&g, &small()).unwrap();
        let twist = beta.tan() / g.r_reference();
        let normals = Flanks::new(m.flanks.clone());
        for (i, f) in m.flanks.iter().enumerate() {
            assert_eq!(
                (f.tooth, f.side),
                ((61 - i as u32 / 2) % 61, Side::BOTH[i % 2])
            );
            let r = |row: usize| f.positions[row * f.columns].xy().norm();
            assert!((r(0) - g.r_form()).abs() < 1e-12);
            assert!((r(f.rows - 1) - g.r_tip()).abs() < 1e-12);
            for x in &f.positions {
                let (r, centre) = (x.xy().norm(), f64::from(f.tooth) * g.pitch_angle());
                // Viewed from the root, left is clockwise.
                let angle = centre + twist * x.z - f.side.sign() * g.half_angle_at(r);
                let exact = Vec3::new(r * angle.cos(), r * angle.sin(), x.z);
                assert!((x - exact).norm() < 1e-12, "{} {:?}", f.tooth, f.side);
            }
            // Out of the tooth: the line of action touches the base circle behind the point, seen from the tip.
            for (x, n) in f.positions.iter().zip(nodal_normals(&normals, i)) {
                let (r, sign) = (x.xy().norm(), -f.side.sign());
                let at = x.y.atan2(x.x) - sign * (g.roll_length(r) / g.r_base()).atan();
                let (c, s) = (g.base_helix_angle().cos(), g.base_helix_angle().sin());
                let out = sign * Vec3::new(-c * at.sin(), c * at.cos(), -s);
                assert!((n - out).norm() < 2e-3, "{n:?} {out:?}");
                assert!(n.dot(&x.xy().push(0.0)) < 0.0);
            }
        }
        assert_eq!(m.flanks.len(), 122);
    }
}

#[test]
fn a_sector_of_a_ring_is_one_pitch() {
    let g = ring(0.2);
    let m = gear(
        &g,
        &GearMeshParams {
            sector: true,
            ..small()
        },
    )
    .unwrap();
    let [low, high] = ["cut_low", "cut_high"].map(|name| &m.mesh.node_sets[name]);
    assert_eq!(low.len(), high.len());
    let (sin, cos) = g.pitch_angle().sin_cos();
    for (a, b) in low.iter().zip(high) {
        let [a, b] = [a, b].map(|n| m.mesh.nodes[*n as usize]);
        let image = Vec3::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y, a.z);
        assert!((image - b).norm() < 1e-14);
    }
    let whole = quality(&gear(&g, &small()).unwrap().mesh).volume;
    assert!((61.0 * quality(&m.mesh).volume / whole - 1.0).abs() < 1e-12);
}

#[test]
fn a_ring_has_no_web() {
    let web = Web {
        inner_radius: 0.13,
        outer_radius: 0.14,
        thickness: 4e-3,
        layers: 2,
        hub_layers: 2,
    };
    let params = GearMeshParams {
        web: Some(web),
        width: 3,
        ..small()
    };
    let refused = gear(&ring(0.0), &params).unwrap_err();
    assert!(matches!(refused, MeshError::InternalWithWeb), "{refused}");
}
