//! Hubs with out-of-plane freedom: properties of every basis, and one tooth sector compared with the whole mesh.

use super::rigid::rigid_mass;
use super::{Basis, ModeSelection, Mounting, basis, mounting_of};
use crate::assembly::assemble;
use crate::gear_mesh::{self, GearMesh};
use crate::test_support::{self, coarse, stub};
use crate::vector::dot;
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::reduced::OutOfPlaneShapes;
use gearbench_models::gear::rigid;
use gearbench_models::kinematics::{BodyMass, OutOfPlane};
use gearbench_models::spec::{Bearing, Body, Freedom, Mount};
use gearbench_models::stiffness::Material;
use nalgebra::Matrix3;
use std::sync::Arc;

const STEEL: Material = Material::STEEL;
const ALL: [bool; 6] = [true; 6];

fn floating(mounting: Mounting, free: [bool; 6], mass: f64, tilting: f64) -> Mounting {
    mounting.with_added(mass, tilting).lateral(free).unwrap()
}

fn of_mesh(mesh: &GearMesh, mounting: &Mounting, wanted: ModeSelection) -> Basis {
    basis::of_mesh(mesh, &STEEL, mounting, wanted, false, None).unwrap()
}

fn lateral(b: &Basis) -> &OutOfPlaneShapes {
    b.lateral.as_ref().unwrap()
}

/// Returns the linear momentum, and the angular momentum about the hub, of a mode per unit velocity of its coordinate,
/// including the inertia added at the hub.
fn momentum(b: &Basis, mounting: &Mounting, mode: usize) -> [f64; 6] {
    let (i, added) = (b.integrals.as_ref().unwrap(), mounting.added());
    let mut hub = lateral(b).hub[mode];
    hub[mounting.own()] = b.hub[mode];
    std::array::from_fn(|d| {
        let of_mesh = match d {
            0..3 => i.translation[3 * mode + d],
            _ => i.rotation[3 * mode + d - 3],
        };
        of_mesh + added[d] * hub[d]
    })
}

fn holds_no_momentum(b: &Basis, mounting: &Mounting) {
    let rigid = rigid_mass(lateral(b));
    for mode in 0..b.omega.len() {
        let p = momentum(b, mounting, mode);
        for d in mounting.directions() {
            let share = p[d].abs() / rigid[d][d].sqrt();
            assert!(share < 1e-9, "mode {mode}, direction {d}: {share:e}");
        }
        for d in (0..6).filter(|d| !mounting.lateral[*d]) {
            assert_eq!(lateral(b).hub[mode][d], 0.0);
        }
        // The momentum that accelerates the bearing includes the added mass.
        for d in 0..2 {
            let share = (b.momentum[mode][d] - p[d]).abs() / rigid[d][d].sqrt();
            assert!(share < 1e-9, "mode {mode}, along {d}: {share:e}");
        }
    }
}

#[test]
fn sector_and_whole_mesh_agree_and_no_mode_holds_momentum() {
    let tilts = [false, false, false, true, true, false];
    let along = [true, true, true, false, false, false];
    for (teeth, helix, mounting) in [
        (
            10,
            0.0,
            floating(Mounting::gear(true, 2e-6), ALL, 0.02, 3e-6),
        ),
        (9, 0.3, floating(Mounting::gear(true, 0.0), ALL, 0.0, 0.0)),
        (
            9,
            0.0,
            floating(Mounting::gear(false, 2e-6), ALL, 0.01, 0.0),
        ),
        (
            8,
            0.2,
            floating(Mounting::gear(true, 0.0), tilts, 0.0, 1e-6),
        ),
        (8, 0.0, floating(Mounting::gear(true, 0.0), along, 0.1, 0.0)),
    ] {
        let gear = stub(teeth, helix);
        let whole = gear_mesh::gear(&gear, &coarse(2, 2)).unwrap();
        let sector = gear_mesh::sector(&gear, &coarse(2, 2)).unwrap();
        let wanted = ModeSelection::Count(61);
        let a = basis::of_sector(&sector, &STEEL, &mounting, wanted, false).unwrap();
        let b = of_mesh(&whole, &mounting, wanted);
        assert_eq!(a.unknowns, b.unknowns);
        let (la, lb) = (lateral(&a), lateral(&b));
        assert_eq!((la.free, lb.free), (mounting.lateral, mounting.lateral));
        let (ra, rb) = (rigid_mass(la), rigid_mass(lb));
        for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
            let scale = (rb[i][i] * rb[j][j]).sqrt();
            assert!((ra[i][j] - rb[i][j]).abs() < 1e-9 * scale, "{i} {j}");
        }
        holds_no_momentum(&a, &mounting);
        holds_no_momentum(&b, &mounting);
        let count = a.omega.len().min(b.omega.len());
        let last = *a.family[..count].last().unwrap();
        let count = a.family.partition_point(|f| *f < last);
        assert!(count >= 57);
        assert!(a.omega[0] > 1e3);
        for i in 0..count {
            assert!((a.omega[i] / b.omega[i] - 1.0).abs() < 1e-9, "mode {i}");
        }
        assert_eq!(a.family[..count], b.family[..count]);
        // Within a pair any rotation will do: how the hub and the flanks move together is one.
        let mut first = 0;
        for same in a.family[..count].chunk_by(|x, y| x == y) {
            let range = first..first + same.len();
            first = range.end;
            let hub = |b: &Basis, node: usize, d: usize| -> [f64; 2] {
                let n = b.omega.len();
                range.clone().fold([0.0; 2], |s, m| {
                    let h = lateral(b).hub[m][d];
                    [s[0] + h * h, s[1] + h * b.shapes[node * n + m]]
                })
            };
            for (node, d) in (0..a.normals.len()).map(|k| (k, k % 6)) {
                let (x, y) = (hub(&a, node, d), hub(&b, node, d));
                let scale = 1.0 / ra[d][d];
                assert!((x[0] - y[0]).abs() < 1e-6 * scale, "modes {range:?} {d}");
                let scale = (scale / la.mass).sqrt();
                assert!((x[1] - y[1]).abs() < 1e-6 * scale, "modes {range:?} {d}");
            }
        }
        let n = a.directions();
        let largest = (0..n as u32)
            .map(|k| b.compliance_between(k, k))
            .fold(0.0, f64::max);
        for (i, j) in (0..n).map(|i| (i as u32, ((11 * i + 3) % n) as u32)) {
            let (x, y) = (a.compliance_between(i, j), b.compliance_between(i, j));
            assert!((x - y).abs() < 1e-9 * largest, "{i} {j}: {x:e} {y:e}");
        }
        for (x, y) in a.compliance.hub.iter().zip(&b.compliance.hub) {
            let scale = (b.compliance.hub_hub * largest).sqrt();
            assert!((x - y).abs() <= 1e-9 * scale);
        }
    }
}

/// A unit displacement of the hub moves the mesh by the rigid motion: the mass matrix of the body is that of the
/// elements.
#[test]
fn the_rigid_part_is_that_of_the_elements() {
    let rack = test_support::rack(3, 2e-3, |p| p.face_width = 4e-3);
    let bar = gear_mesh::rack(&rack, &coarse(2, 1)).unwrap();
    let mounting = floating(Mounting::rack(true, 0.01), ALL, 0.01, 2e-7);
    let b = of_mesh(&bar, &mounting, ModeSelection::Count(30));
    holds_no_momentum(&b, &mounting);
    let body = lateral(&b);
    // The centre of mass of a rack is not on its reference line, so that translations and rotations are coupled.
    assert!(body.centre[0].abs() > 1e-4, "{:?}", body.centre);
    let assembly = assemble(&bar.mesh, &STEEL).unwrap();
    let motions: Vec<_> = (0..6).map(|d| mounting.motion_of(d)).collect();
    let fields = motions.iter().map(|m| {
        let at = |x: &Vec3| -> [f64; 3] { m.of(x).into() };
        bar.mesh.nodes.iter().flat_map(at).collect::<Vec<f64>>()
    });
    let fields: Vec<Vec<f64>> = fields.collect();
    let (rigid, added) = (rigid_mass(body), mounting.added());
    let mut image = vec![0.0; fields[0].len()];
    for (j, field) in fields.iter().enumerate() {
        assembly.mass.apply(field, &mut image);
        for i in 0..6 {
            let of_mesh = dot(&fields[i], &image) + if i == j { added[i] } else { 0.0 };
            let scale = (rigid[i][i] * rigid[j][j]).sqrt();
            assert!((of_mesh - rigid[i][j]).abs() < 1e-12 * scale, "{i} {j}");
        }
    }
}

/// A very heavy hub is at rest; a hub fixed in a direction is the limit.
#[test]
fn a_heavy_hub_is_a_held_one() {
    let gear = stub(9, 0.0);
    let sector = gear_mesh::sector(&gear, &coarse(1, 1)).unwrap();
    let modes = |mounting: &Mounting| {
        basis::of_sector(&sector, &STEEL, mounting, ModeSelection::Count(40), false).unwrap()
    };
    let light = modes(&floating(Mounting::gear(false, 0.0), ALL, 0.0, 0.0));
    let heavy = modes(&floating(Mounting::gear(false, 0.0), ALL, 1e6, 1e3));
    let held = modes(&Mounting::gear(false, 0.0));
    for (a, b) in heavy.omega.iter().zip(&held.omega) {
        assert!((a / b - 1.0).abs() < 1e-5, "{a} {b}");
    }
    let sum = |b: &Basis| b.omega.iter().take(38).sum::<f64>();
    assert!(sum(&light) > 1.001 * sum(&held));
}

#[test]
fn what_turns_with_the_gear_is_free_in_both_directions_or_held() {
    let gear = Mounting::gear(true, 0.0);
    for (free, words) in [
        (
            [true, false, false, false, false, false],
            "translations along x and y",
        ),
        (
            [true, true, false, false, true, true],
            "tilts about x and y",
        ),
    ] {
        let why = gear.lateral(free).unwrap_err();
        assert!(why.cause.contains(words), "{why}");
        assert!(why.help.contains("a stiff bearing holds one"));
        assert!(Mounting::rack(true, 0.0).lateral(free).is_ok());
    }
    // The own motion is not looked at.
    let own = gear.lateral([false, false, false, false, false, true]);
    assert_eq!(own, Ok(gear));
    let rack = Mounting::rack(true, 0.1);
    let free = [true, true, false, false, false, false];
    assert!(!rack.lateral(free).unwrap().lateral[1]);
}

/// Axes of a rack's hub start with its slide, which is the own y.
#[test]
fn a_mounting_is_that_of_the_hub() {
    let none = rigid::spec();
    let steel = STEEL.density;
    let lateral_of = |mass: f64, free: [usize; 2]| {
        let mut directions = [const { Freedom::Fixed }; 6];
        free.into_iter().for_each(|d| directions[d] = Freedom::Free);
        Some(Arc::new(OutOfPlane {
            directions,
            bearing: Bearing::default(),
            body: BodyMass {
                mass,
                inertia: Matrix3::identity(),
                centre: Vec3::zeros(),
            },
            spins: false,
        }))
    };
    let rack = Body::Rack(test_support::rack(3, 2e-3, |_| {}));
    let mut hub = test_support::hub(Mount::Prismatic, Some(Vec3::y()));
    hub.lateral = lateral_of(rack.mass(steel) + 0.5, [1, 3]);
    let context = test_support::context(&rack, &hub, &none);
    let mounting = mounting_of(&context).unwrap();
    assert_eq!(mounting.lateral, [true, false, false, false, true, false]);
    let gear = Body::Gear(stub(9, 0.0));
    let mut hub = test_support::hub(Mount::Revolute, None);
    hub.lateral = lateral_of(gear.mass(steel) + 0.5, [0, 1]);
    let context = test_support::context(&gear, &hub, &none);
    let mounting = mounting_of(&context).unwrap();
    assert_eq!(mounting.lateral, [true, true, false, false, false, false]);
    assert!((mounting.added_mass - 0.5).abs() < 1e-12);
    for (mass, free, words) in [
        (gear.mass(steel), [0, 2], "a stiff bearing holds one"),
        (0.5 * gear.mass(steel), [0, 1], "leave `mass_kg` out"),
    ] {
        let mut hub = hub.clone();
        hub.lateral = lateral_of(mass, free);
        let e = mounting_of(&test_support::context(&gear, &hub, &none)).unwrap_err();
        assert!(e.to_string().contains(words), "{e}");
    }
}
