//! Recognition of gears from their surface: generated ones and those of stored decks, rotated, moved and shuffled.
#![allow(clippy::print_stdout, reason = "observed figures")]

use super::*;
use crate::deck;
use crate::gear_deck;
use crate::gear_mesh::{self, GearMesh, GearMeshParams, Tooth};
use crate::mesh::{self, ElementKind, Mesh};
use crate::test_support::{calculix, noise};
use gearbench_models::geometry::Gear;
use nalgebra::Rotation3;

/// The mesh without its sets, its nodes and elements in another order, turned and moved.
pub(crate) fn strange(mesh: &Mesh, turn: Vec3, shift: Vec3) -> Mesh {
    let order = |n: usize, size: f64| {
        let by = noise(n, size);
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| by[a].total_cmp(&by[b]));
        order
    };
    let nodes = order(mesh.nodes.len(), 1.0);
    let mut place = vec![0; nodes.len()];
    for (i, &n) in nodes.iter().enumerate() {
        place[n] = i as u32;
    }
    let rotation = Rotation3::new(turn);
    let positions = nodes.iter().map(|&n| rotation * mesh.nodes[n] + shift);
    let elements = order(mesh.element_count(), 2.0);
    let connectivity = elements.iter().flat_map(|&e| mesh.element(e));
    Mesh::new(
        mesh.kind().unwrap(),
        positions.collect(),
        connectivity.map(|&n| place[n as usize]).collect(),
    )
}

pub(crate) fn found(mesh: &Mesh) -> RecognisedGear {
    let skin = Skin::of(&mesh.nodes, &mesh.blocks);
    recognise(&skin, &SpecifiedBody::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Largest relative error of base pitch, base helix, base thickness, tip and root radius.
fn errors(found: &RecognisedGear, g: &Gear) -> [f64; 5] {
    let fit = &found.fit;
    let part = |a: f64, b: f64| (a / b - 1.0).abs();
    let thickness = 2.0 * g.r_base() * g.half_angle_base();
    let helix = g.base_helix_angle();
    [
        part(fit.base_pitch(), g.base_pitch()),
        (fit.base_helix_angle() - helix).abs() / helix.abs().max(1.0),
        part(fit.base_thickness(), thickness),
        part(found.tip.radius, g.r_tip()),
        part(found.root.radius, g.r_root()),
    ]
}

pub(crate) fn plain(kind: ElementKind) -> GearMeshParams {
    GearMeshParams {
        kind,
        tooth: Tooth {
            flank: 6,
            ..Tooth::coarse()
        },
        layers: 1,
        rim: 1,
        width: 2,
        ..GearMeshParams::default()
    }
}

fn generated(g: &Gear, kind: ElementKind) -> GearMesh {
    gear_mesh::gear(g, &plain(kind)).unwrap()
}

#[test]
fn generated_gears_are_found_again() {
    let (mut tried, mut largest) = (0, 0.0_f64);
    for teeth in [12, 17, 25, 40, 71, 120] {
        for shift in [-0.5, 0.0, 0.5, 1.0] {
            for helix in [0.0_f64, -10.0, 20.0, 30.0] {
                let params = gearbench_models::geometry::GearParams {
                    teeth,
                    module: 3e-3,
                    profile_shift: shift,
                    helix_angle: helix.to_radians(),
                    // Pointed teeth are cut off lower.
                    addendum: if teeth < 25 && shift == 1.0 { 0.7 } else { 1.0 },
                    bore_radius: 1.2e-3 * f64::from(teeth) * 0.5,
                    ..Default::default()
                };
                let Ok(g) = Gear::new(params) else { continue };
                tried += 1;
                let own = generated(&g, ElementKind::C3D8);
                let turn = Vec3::new(0.3 + f64::from(teeth), -0.7 + shift, helix);
                let mesh = strange(&own.mesh, turn, Vec3::new(0.1, -0.05, 0.02));
                let found = found(&mesh);
                assert_eq!(found.fit.teeth, teeth);
                let errors = errors(&found, &g);
                let worst = errors.iter().copied().fold(0.0, f64::max);
                largest = largest.max(worst);
                assert!(
                    worst < 1e-9,
                    "z {teeth}, x {shift}, helix {helix}: {errors:?}"
                );
                assert_eq!(found.flanks.len(), 2 * teeth as usize);
                // As many faces as the flanks of the mesh have: nothing of the fillet, all up to the tip.
                let faces: usize = found.flanks.iter().map(|p| p.faces.len()).sum();
                assert_eq!(faces, 2 * teeth as usize * 12);
                assert_eq!(found.bore_nodes.len(), own.bore.len());
                assert!((found.bore.radius / g.params().bore_radius - 1.0).abs() < 1e-9);
                let axis = Rotation3::new(turn) * Vec3::z();
                assert!(found.axis.direction.cross(&axis).norm() < 1e-9);
                let reading = found.readings(ToolSpec::default())[0];
                assert!((reading.module / 3e-3 - 1.0).abs() < 1e-9 && reading.standard);
                assert!((reading.profile_shift - shift).abs() < 1e-7, "{reading:?}");
                assert!((reading.helix_angle - helix.to_radians()).abs() < 1e-9);
            }
        }
    }
    println!("involutes of {tried} generated gears: sizes within {largest:.1e}");
    assert!(tried > 60, "{tried}");
}

/// The stored gears of CalculiX, made by another program: only some teeth are fine, those of case C are shifted.
#[test]
fn calculix_gears_are_found_without_their_sets() {
    for (case, name) in [
        ("case-a-fine", "AF8_d05"),
        ("case-a-coarse", "A8_d05"),
        ("case-c", "C8_d25"),
        ("rack-pinion", "R8b_d05"),
    ] {
        let path = format!("{}/calculix/{case}/params.json", env!("CARGO_MANIFEST_DIR"));
        let p: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let gears = gear_deck::gears(&calculix(&format!("{case}/{name}.inp.gz"))).unwrap();
        let toothed = gears
            .iter()
            .filter(|g| g.shape == gear_deck::BodyShape::Gear);
        for (i, g) in toothed.enumerate() {
            let expected = &p[format!("gear{}", i + 1)];
            let number = |key: &str| expected[key].as_f64().unwrap();
            let common = |key: &str| p["gear_common"][key].as_f64().unwrap();
            let mesh = strange(
                &g.mesh.mesh,
                Vec3::new(1.0, 2.0, -0.4),
                Vec3::new(0.3, 0.1, -0.2),
            );
            let found = found(&mesh);
            let z = number("z");
            let alpha = common("alpha_deg").to_radians();
            let half = (std::f64::consts::FRAC_PI_2 + 2.0 * number("x") * alpha.tan()) / z
                + gearbench_models::geometry::inv(alpha);
            let near = |what: &str, a: f64, b: f64| {
                println!(
                    "gear of CalculiX, {case}: {what} within {:.1e}",
                    (a / b - 1.0).abs()
                );
                assert!((a / b - 1.0).abs() < 1e-7, "{case} {i}: {what} {a} {b}");
            };
            assert_eq!(f64::from(found.fit.teeth), z);
            near("base radius", found.fit.base_radius, number("r_base"));
            near("base thickness", found.fit.half_angle, half);
            near("tip", found.tip.radius, number("r_tip"));
            near("root", found.root.radius, number("r_root"));
            near("bore", found.bore.radius, number("rbore"));
            near("width", found.width, common("face_width_m"));
            assert!(found.fit.base_helix_angle().abs() < 1e-7);
            assert!(found.fit.residual[0] < 1e-9, "{:?}", found.fit);
            assert_eq!(found.flanks.len(), 2 * found.fit.teeth as usize);
            let reading = found.readings(ToolSpec::default())[0];
            near("module", reading.module, common("module_m"));
            assert!((reading.profile_shift - number("x")).abs() < 1e-5);
        }
    }
}

/// Recognition is insensitive to nodes rounded to five digits, facets, and a tip relief of a hundredth of the module.
#[test]
fn rounded_nodes_and_relieved_tips_cost_little() {
    let params = gearbench_models::geometry::GearParams {
        teeth: 25,
        module: 4e-3,
        helix_angle: 0.25,
        bore_radius: 20e-3,
        ..Default::default()
    };
    let g = Gear::new(params.clone()).unwrap();
    let mut own = generated(&g, ElementKind::C3D8).mesh;
    for x in &mut own.nodes {
        *x = x.map(|x| (x * 1e6).round() / 1e6);
    }
    let off = errors(&found(&own), &g);
    assert!(off.iter().all(|e| *e < 1e-4), "{off:?}");
    let relieved = Gear::new(gearbench_models::geometry::GearParams {
        modifications: gearbench_models::geometry::Modifications {
            tip_relief: Some(gearbench_models::geometry::TipRelief {
                amount: 40e-6,
                start_radius: g.r_reference() + 2e-3,
                shape: gearbench_models::geometry::ReliefShape::Linear,
            }),
            ..Default::default()
        },
        ..params
    })
    .unwrap();
    let found = found(&generated(&relieved, ElementKind::C3D8).mesh);
    let off = errors(&found, &relieved);
    // The nodes at the tip have moved inwards.
    assert!(
        off[..3].iter().all(|e| *e < 1e-4) && off[3] < 1e-3,
        "{off:?} {:?} {:?}",
        found.fit,
        found.active
    );
    // The relieved part still belongs to the flank.
    assert_eq!(
        found.flanks.iter().map(|p| p.faces.len()).sum::<usize>(),
        50 * 12
    );
}

/// A body that is not a gear is refused with the missing part, as is a gear without a bore.
#[test]
fn other_bodies_are_refused() {
    let of = |mesh: &Mesh| {
        let skin = Skin::of(&mesh.nodes, &mesh.blocks);
        recognise(&skin, &SpecifiedBody::default())
            .unwrap_err()
            .to_string()
    };
    let cube = crate::mesh::brick(ElementKind::C3D8, [3, 4, 5], [1.0, 2.0, 3.0]);
    assert!(
        of(&cube).contains("outermost") || of(&cube).contains("bore"),
        "{}",
        of(&cube)
    );
    assert!(recognise(&Skin::new(&[], []), &SpecifiedBody::default()).is_err());
}

#[test]
fn tetrahedra_are_found_with_grids_on_their_flanks() {
    for helix in [0.0, 0.3] {
        let params = gearbench_models::geometry::GearParams {
            teeth: 19,
            module: 4e-3,
            helix_angle: helix,
            bore_radius: 18e-3,
            ..Default::default()
        };
        let g = Gear::new(params).unwrap();
        let own = generated(&g, ElementKind::C3D20);
        let mesh = strange(
            &mesh::tetrahedra(&own.mesh).unwrap(),
            Vec3::new(0.4, 1.9, 0.2),
            Vec3::x(),
        );
        let skin = Skin::of(&mesh.nodes, &mesh.blocks);
        let found = recognise(&skin, &SpecifiedBody::default()).unwrap();
        let off = errors(&found, &g);
        assert!(off.iter().all(|e| *e < 1e-9), "{off:?}");
        assert_eq!(found.flanks.len(), 38);
        let positions: Vec<Vec3> = mesh.nodes.iter().map(|x| found.own(x)).collect();
        for patch in &found.flanks {
            let grid = tied::lay(&skin, &found, patch, &positions).unwrap();
            assert_eq!((grid.rows, grid.columns), (13, 3));
            for (x, point) in grid.positions.iter().zip(&grid.points) {
                let weights = || point.0.iter();
                assert!((weights().map(|p| p.1).sum::<f64>() - 1.0).abs() < 1e-12);
                let on_face = weights()
                    .map(|&(n, w)| w * positions[n as usize])
                    .sum::<Vec3>();
                // The quadratic face leaves the involute by less than a chord by far.
                assert!((x - on_face).norm() < 2e-6, "{}", (x - on_face).norm());
                // On the involute of the gear itself.
                let point = FlankPoint {
                    radius: x.xy().norm(),
                    angle: x.y.atan2(x.x) + found.fit.phase,
                    height: x.z,
                    tooth: patch.tooth,
                    side: patch.side,
                };
                assert!(found.fit.distance(&point).abs() < 1e-12);
            }
            let radii = |r: usize| grid.positions[r * grid.columns].xy().norm();
            assert!((radii(0) - g.r_form()).abs() < 1e-9);
            assert!((radii(grid.rows - 1) - g.r_tip()).abs() < 1e-9);
        }
    }
}

/// Weights keep rigid motions and linear fields, and so forces and moments, on every kind of face.
#[test]
fn shape_functions_of_faces_reproduce_linear_fields() {
    let face = mesh::Face {
        element: 0,
        face: 0,
    };
    for (corners, mids) in [(3, 0), (3, 3), (4, 0), (4, 4)] {
        let numbers: Vec<u32> = (0..8).collect();
        let facet =
            Facet::new(face, &numbers[..corners], &numbers[corners..corners + mids]).unwrap();
        let plane: Vec<[f64; 2]> = match corners {
            3 => vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            _ => vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
        };
        let middle = (0..mids).map(|i| {
            let (a, b) = (plane[i], plane[(i + 1) % corners]);
            [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
        });
        let places: Vec<[f64; 2]> = plane.iter().copied().chain(middle).collect();
        for (i, at) in places.iter().enumerate() {
            for (j, (n, _)) in tied::shape(&facet, *at).into_iter().enumerate() {
                assert!((n - f64::from(u8::from(i == j))).abs() < 1e-15);
            }
        }
        let xi = [0.21, 0.34];
        let n = tied::shape(&facet, xi);
        let sum = |f: &dyn Fn(usize) -> f64| (0..n.len()).map(f).sum::<f64>();
        assert!((sum(&|i| n[i].0) - 1.0).abs() < 1e-15);
        for k in 0..2 {
            assert!((sum(&|i| n[i].0 * places[i][k]) - xi[k]).abs() < 1e-15);
            for l in 0..2 {
                let slope = sum(&|i| n[i].1[l] * places[i][k]);
                assert!((slope - f64::from(u8::from(k == l))).abs() < 1e-15);
            }
        }
    }
}

/// Meshes of Gmsh in millimetres, quadratic tetrahedra with straight sides, axis along x, no sets; `gmsh/spur_gear.py`
/// makes them.
#[test]
fn gmsh_gears_are_found() {
    for (teeth, bore) in [(20, 15e-3), (30, 25e-3)] {
        let path = format!("{}/gmsh/spur_z{teeth}.msh.gz", env!("CARGO_MANIFEST_DIR"));
        let read = deck::read(path).unwrap();
        let gears =
            gear_deck::gears_with(&read, Some(gearbench_models::stiffness::Material::STEEL))
                .unwrap();
        let [gear] = &gears[..] else {
            panic!("{} bodies", gears.len())
        };
        let found = gear.found.as_ref().and_then(RecognisedBody::gear).unwrap();
        let g = Gear::new(gearbench_models::geometry::GearParams {
            teeth,
            module: 4e-3,
            tip_radius: 0.3,
            bore_radius: bore,
            ..Default::default()
        })
        .unwrap();
        let off = errors(found, &g);
        println!(
            "gear of Gmsh, {teeth} teeth: sizes within {:.1e}",
            off.iter().copied().fold(0.0, f64::max)
        );
        assert!(off.iter().all(|e| *e < 1e-4), "{off:?}");
        assert!((found.bore.radius / bore - 1.0).abs() < 1e-6);
        assert!((found.axis.direction - Vec3::x()).norm() < 1e-6);
        assert!((gear.centre - Vec3::new(5e-3, 30e-3, -12e-3)).norm() < 1e-7);
        assert_eq!(gear.mesh.flanks.len(), 2 * teeth as usize);
        assert!(!gear.mesh.tied.is_empty());
        let reading = found.readings(ToolSpec::default());
        assert!(reading.len() == 1 && (reading[0].module / 4e-3 - 1.0).abs() < 1e-4);
    }
}
