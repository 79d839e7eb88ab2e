//! Recognition of racks from their surface: generated ones and the stored one, rotated, moved and shuffled.

use super::*;
use crate::gear_deck::{self, BodyShape};
use crate::gear_mesh;
use crate::mesh::{self, ElementKind, Mesh, brick};
use crate::recognise::tests::{plain, strange};
use crate::recognise::{Misfit, RecognisedBody, Skin, SpecifiedBody, body};
use crate::test_support::{bare, calculix, rack};
use gearbench_models::geometry::Rack;
use gearbench_models::stiffness::Material;
use nalgebra::Rotation3;

fn found(mesh: &Mesh) -> RecognisedRack {
    let skin = Skin::of(&mesh.nodes, &mesh.blocks);
    match body(&skin, &SpecifiedBody::default()) {
        Ok(RecognisedBody::Rack(rack)) => *rack,
        other => panic!("{other:?}"),
    }
}

/// Largest relative error of pitch, angles, heights and the back.
fn worst(found: &RecognisedRack, r: &Rack) -> f64 {
    let p = r.params();
    // A thinned tooth counts as one cut deeper.
    let deeper = 0.5 * p.thinning / r.transverse_pressure_angle().tan();
    let part = |a: f64, b: f64| (a / b - 1.0).abs();
    [
        part(found.pitch, r.pitch()),
        (found.pressure_angle - r.transverse_pressure_angle()).abs(),
        (found.helix_angle - p.helix_angle).abs(),
        part(found.tip, r.tip_height() + deeper),
        part(found.root, r.root_depth() - deeper),
        part(found.back, r.root_depth() + p.body_height - deeper),
        part(found.width, r.face_width()),
        part(found.module(), p.module),
        (found.normal_pressure_angle() - p.pressure_angle).abs(),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}

#[test]
fn generated_racks_are_found_again() {
    for teeth in [2, 5, 8] {
        for helix in [0.0_f64, -10.0, 25.0] {
            for (angle, thinning) in [(20.0_f64, 0.0), (14.5, 60e-6)] {
                let r = rack(teeth, 3e-3, |p| {
                    p.helix_angle = helix.to_radians();
                    p.pressure_angle = angle.to_radians();
                    p.thinning = thinning;
                    p.face_width = 12e-3;
                });
                let own = gear_mesh::rack(&r, &plain(ElementKind::C3D8)).unwrap();
                let turn = Vec3::new(0.3 + f64::from(teeth), -0.7, 0.1 * helix);
                let shift = Vec3::new(0.1, -0.05, 0.02);
                let mesh = strange(&own.mesh, turn, shift);
                let found = found(&mesh);
                let case = format!("{teeth} teeth, helix {helix}, angle {angle}");
                assert!(
                    worst(&found, &r) < 1e-8,
                    "{case}: {} {found:?}",
                    worst(&found, &r)
                );
                assert_eq!(found.teeth, teeth, "{case}");
                assert!(found.residual[1] < 1e-12, "{case}: {:?}", found.residual);
                assert_eq!(found.flanks.len(), 2 * teeth as usize, "{case}");
                let faces: usize = found.flanks.iter().map(|p| p.faces.len()).sum();
                // As many faces as the flanks of the mesh have: nothing of the fillets, all up to the tips.
                assert_eq!(faces, 2 * teeth as usize * 12, "{case}");
                assert_eq!(found.back_nodes.len(), own.bore.len(), "{case}");
                let x = Rotation3::new(turn) * Vec3::x();
                assert!((found.axes[0] - x).norm() < 1e-9, "{case}");
                // The flanks agree tooth by tooth, possibly counted from the opposite end.
                let end = found.axes[2].dot(&(Rotation3::new(turn) * Vec3::z()));
                assert!((end.abs() - 1.0).abs() < 1e-12, "{case}");
                if end > 0.0 {
                    let back = |n: &Vec3| found.own(&(Rotation3::new(turn) * n + shift));
                    let deeper = 0.5 * thinning / r.transverse_pressure_angle().tan();
                    for n in &own.mesh.nodes {
                        let moved = n - Vec3::new(deeper, 0.0, 0.0);
                        assert!((back(n) - moved).norm() < 1e-10, "{case}");
                    }
                }
            }
        }
    }
}

/// Recognition of the stored rack without its sets gives the same body at the same position.
#[test]
fn the_stored_rack_is_found_without_its_sets() {
    let whole = calculix("rack-pinion/R8b_d05.inp.gz");
    let named = gear_deck::gears(&whole).unwrap().swap_remove(1);
    let mut without = whole;
    without
        .node_sets
        .retain(|name, _| name.starts_with("bore1") || name.starts_with("flank1"));
    without.surfaces.clear();
    without.rigid_bodies.clear();
    without.boundaries.clear();
    let bodies =
        gear_deck::gears_known(&without, Some(Material::STEEL), &SpecifiedBody::default()).unwrap();
    let mut racks = bodies.into_iter().filter_map(Result::ok);
    let again = racks
        .rfind(|g| matches!(g.shape, BodyShape::Rack { .. }))
        .unwrap();
    let found = again.found.as_ref().and_then(RecognisedBody::rack).unwrap();
    assert_eq!(again.mesh.teeth, named.mesh.teeth);
    assert!((found.module() / 2e-3 - 1.0).abs() < 1e-8);
    assert!((found.pressure_angle.to_degrees() - 20.0).abs() < 1e-6);
    assert!(
        (again.centre - named.centre).norm() < 1e-9,
        "{:?}",
        again.centre
    );
    assert!((again.phase - named.phase).abs() < 1e-9);
    let BodyShape::Rack { direction } = again.shape else {
        panic!("{:?}", again.shape)
    };
    assert!(direction.abs() < 1e-9);
    for (a, b) in named.mesh.mesh.nodes.iter().zip(&again.mesh.mesh.nodes) {
        assert!((a - b).norm() < 1e-9);
    }
    // The flanks that sets name are among those that are found.
    for f in &named.mesh.flanks {
        let same = again
            .mesh
            .flanks
            .iter()
            .find(|g| (g.tooth, g.side) == (f.tooth, f.side));
        assert!(same.is_some(), "{} {:?}", f.tooth, f.side);
    }
    let mut held = [named.mesh.bore.clone(), again.mesh.bore.clone()];
    held.iter_mut().for_each(|h| h.sort_unstable());
    assert_eq!(held[0], held[1]);
}

/// A rack of tetrahedra has grids of points tied to its flanks, on their planes.
#[test]
fn tetrahedra_are_found_with_grids_on_their_flanks() {
    for helix in [0.0, 0.3] {
        let r = rack(4, 3e-3, |p| p.helix_angle = helix);
        let own = gear_mesh::rack(&r, &plain(ElementKind::C3D20)).unwrap();
        let mesh = strange(
            &mesh::tetrahedra(&own.mesh).unwrap(),
            Vec3::new(0.4, 1.9, 0.2),
            Vec3::x(),
        );
        let gear = gear_deck::gears_with(&bare(&mesh), Some(Material::STEEL))
            .unwrap()
            .swap_remove(0);
        let found = gear.found.as_ref().and_then(RecognisedBody::rack).unwrap();
        assert!(worst(found, &r) < 1e-8, "{}", worst(found, &r));
        assert!(gear.missing.is_empty(), "{:?}", gear.missing);
        assert_eq!((gear.mesh.teeth, gear.mesh.flanks.len()), (4, 8));
        assert!(!gear.mesh.tied.is_empty());
        for grid in &gear.mesh.flanks {
            assert_eq!((grid.rows, grid.columns), (13, 3));
            for (point, x) in grid.nodes.iter().zip(&grid.positions) {
                let follows = gear.mesh.follows(*point);
                assert!((follows.iter().map(|f| f.1).sum::<f64>() - 1.0).abs() < 1e-12);
                let at = |f: &(u32, f64)| f.1 * gear.mesh.mesh.nodes[f.0 as usize];
                assert!((follows.iter().map(at).sum::<Vec3>() - x).norm() < 1e-12);
                assert!(found.distance(x, grid.tooth, grid.side).abs() < 1e-12);
                // On the flank of the rack itself: its own tooth and side.
                let steps = found.steps(grid.tooth);
                let half = r.half_thickness_at(-x.x);
                let y = steps * r.pitch() - x.z * helix.tan() + sense(grid.side) * half;
                assert!((x.y - y).abs() < 1e-9, "{x:?} {y}");
            }
            let ends = [0, grid.nodes.len() - 1].map(|i| -grid.positions[i].x);
            assert!((ends[0] + r.form_depth()).abs() < 1e-9);
            assert!((ends[1] - r.tip_height()).abs() < 1e-9);
        }
    }
}

/// Points off a plane along its normal are as far from it as they were moved.
#[test]
fn points_stand_off_their_planes_as_told() {
    let r = rack(3, 2e-3, |p| p.helix_angle = 0.2);
    let own = gear_mesh::rack(&r, &plain(ElementKind::C3D8)).unwrap();
    let found = found(&own.mesh);
    for side in Side::BOTH {
        for tooth in 0..3 {
            let x = found.point(tooth, side, 0.3e-3, 1e-3, 7e-6);
            assert!((found.distance(&x, tooth, side) - 7e-6).abs() < 1e-15);
            assert!((x.z - 1e-3).abs() < 1e-18);
        }
    }
}

/// Recognition is insensitive to rounding, and a body that is not a rack is refused with the missing part.
#[test]
fn rounded_racks_and_other_bodies() {
    let r = rack(6, 4e-3, |_| {});
    let mut own = gear_mesh::rack(&r, &plain(ElementKind::C3D8)).unwrap().mesh;
    for x in &mut own.nodes {
        *x = x.map(|x| (x * 1e6).round() / 1e6);
    }
    let found = found(&own);
    assert!(worst(&found, &r) < 1e-3, "{}", worst(&found, &r));
    assert_eq!(found.flanks.len(), 12);
    let cube = brick(ElementKind::C3D8, [3, 4, 5], [1.0, 2.0, 3.0]);
    let skin = Skin::of(&cube.nodes, &cube.blocks);
    let why = body(&skin, &SpecifiedBody::default())
        .unwrap_err()
        .to_string();
    assert!(why.contains("as a rack: no two families"), "{why}");
}

/// A specified direction of the width decides its sense, and has to agree with the recognised one.
#[test]
fn what_is_said_of_a_rack_has_to_agree() {
    let r = rack(5, 3e-3, |_| {});
    let own = gear_mesh::rack(&r, &plain(ElementKind::C3D8)).unwrap().mesh;
    let skin = Skin::of(&own.nodes, &own.blocks);
    let with = |axis: [f64; 3], point: Option<[f64; 3]>| {
        let known = SpecifiedBody {
            axis: Some(axis.into()),
            point: point.map(Vec3::from),
            ..SpecifiedBody::default()
        };
        body(&skin, &known)
    };
    let turned = with([0.0, 0.01, -2.0], Some([0.0, 3e-3, 0.0])).unwrap();
    let turned = turned.rack().unwrap();
    assert_eq!(turned.axes[2], -Vec3::z());
    assert!((turned.axes[1] + Vec3::y()).norm() < 1e-15);
    for (axis, point, key) in [
        ([0.0, 1.0, 0.0], None, "axis"),
        ([0.0, 0.0, 1.0], Some([2e-3, 0.0, 0.0]), "axis_point_m"),
    ] {
        match with(axis, point) {
            Err(Misfit::Against { key: found, .. }) => assert_eq!(found, key),
            other => panic!("{other:?}"),
        }
    }
}
