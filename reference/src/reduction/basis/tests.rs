//! One tooth sector compared with the whole mesh, and properties of every basis.

use super::*;
use crate::gear_mesh;
use crate::test_support::{self, coarse};
use gearbench_models::geometry::{Gear, GearParams};

fn params(teeth: u32) -> GearParams {
    GearParams {
        teeth,
        module: 4e-3,
        profile_shift: 0.48,
        face_width: 8e-3,
        bore_radius: 5e-3,
        ..GearParams::default()
    }
}

/// Shapes of some modes at all flank nodes, and over the frequencies.
fn compliance_of(b: &Basis, modes: std::ops::Range<usize>, i: usize, j: usize) -> f64 {
    let n = b.omega.len();
    modes
        .map(|m| b.shapes[i * n + m] * b.shapes[j * n + m] / b.omega[m].powi(2))
        .sum()
}

#[test]
fn sector_and_whole_mesh_agree() {
    for (teeth, helix, mounting) in [
        (10, 0.0, Mounting::gear(true, 2e-6)),
        (9, 0.3, Mounting::gear(true, 0.0)),
        (9, 0.0, Mounting::gear(false, 2e-6)),
    ] {
        let gear = Gear::new(GearParams {
            helix_angle: helix,
            ..params(teeth)
        })
        .unwrap();
        let whole = gear_mesh::gear(&gear, &coarse(2, 2)).unwrap();
        let sector = gear_mesh::sector(&gear, &coarse(2, 2)).unwrap();
        let wanted = ModeSelection::Count(61);
        let a = of_sector(&sector, &Material::STEEL, &mounting, wanted, false).unwrap();
        let b = of_mesh(&whole, &Material::STEEL, &mounting, wanted, false, None).unwrap();
        assert!((a.inertia / b.inertia - 1.0).abs() < 1e-12);
        assert_eq!(a.unknowns, b.unknowns);
        for (p, q) in a.flanks.grids().iter().zip(b.flanks.grids()) {
            assert_eq!((p.tooth, p.side, &p.nodes), (q.tooth, q.side, &q.nodes));
            for (x, y) in p.positions.iter().zip(&q.positions) {
                assert!((x - y).norm() < 1e-12);
            }
        }
        for (x, y) in a.normals.iter().zip(&b.normals) {
            assert!((x - y).norm() < 1e-9);
        }
        // A pair at the end may be whole in one and half in the other.
        let count = a.omega.len().min(b.omega.len());
        let last = *a.family[..count].last().unwrap();
        let count = a.family.partition_point(|f| *f < last);
        assert!(count >= 58);
        for i in 0..count {
            assert!((a.omega[i] / b.omega[i] - 1.0).abs() < 1e-9, "mode {i}");
        }
        assert_eq!(a.family[..count], b.family[..count]);
        // Within a pair any rotation will do; the compliance of the pair is one.
        let nodes = a.normals.len();
        let mut first = 0;
        for same in a.family[..count].chunk_by(|x, y| x == y) {
            let range = first..first + same.len();
            first = range.end;
            let largest = (0..nodes)
                .map(|i| compliance_of(&a, range.clone(), i, i))
                .fold(0.0, f64::max);
            for (i, j) in (0..nodes).map(|i| (i, (7 * i + 3) % nodes)) {
                let (x, y) = (
                    compliance_of(&a, range.clone(), i, j),
                    compliance_of(&b, range.clone(), i, j),
                );
                assert!((x - y).abs() < 1e-6 * largest, "modes {range:?}: {x} {y}");
            }
            // The hub response is checked likewise.
            let squares = |x: &[f64]| x[range.clone()].iter().map(|h| h * h).sum::<f64>();
            for (x, y) in [(&a.hub, &b.hub), (&a.participation, &b.participation)] {
                let scale = x.iter().map(|x| x * x).fold(0.0, f64::max);
                assert!((squares(x) - squares(y)).abs() <= 1e-6 * scale);
            }
            // And the momentum across the axis, by itself and towards the flanks.
            let taken = |b: &Basis, node: usize, axis: usize| -> f64 {
                let n = b.omega.len();
                let modes = range.clone();
                modes
                    .map(|m| b.momentum[m][axis] * b.shapes[node * n + m])
                    .sum()
            };
            for (node, axis) in (0..nodes).map(|k| (k, k % 2)) {
                let (x, y) = (taken(&a, node, axis), taken(&b, node, axis));
                assert!((x - y).abs() < 1e-6, "modes {range:?}: {x} {y}");
            }
            let tensor = |b: &Basis| {
                b.momentum[range.clone()].iter().fold([0.0; 3], |t, p| {
                    [t[0] + p[0] * p[0], t[1] + p[0] * p[1], t[2] + p[1] * p[1]]
                })
            };
            for (x, y) in tensor(&a).iter().zip(tensor(&b)) {
                assert!((x - y).abs() < 1e-6 * a.momentum.iter().map(|p| p[0] * p[0]).sum::<f64>());
            }
        }
        assert_eq!(mounting.free, a.hub.iter().any(|h| *h != 0.0));
        assert_eq!(!mounting.free, a.participation.iter().any(|h| *h != 0.0));
    }
}

/// Modes have no momentum including the inertia added at the hub, so `h_i = - (phi_i^T M e)_nodes / J_added`.
#[test]
fn free_modes_hold_no_momentum_and_the_rigid_one_is_gone() {
    let gear = Gear::new(params(10)).unwrap();
    let whole = gear_mesh::gear(&gear, &coarse(2, 2)).unwrap();
    let wanted = ModeSelection::Count(30);
    let frequencies = |added: f64| {
        let b = of_mesh(
            &whole,
            &Material::STEEL,
            &Mounting::gear(true, added),
            wanted,
            false,
            None,
        )
        .unwrap();
        assert!(b.omega[0] > 1e3);
        b
    };
    let light = frequencies(0.0);
    // A hub that is very heavy stands still: its modes are those of a held hub, and only those that turn it change.
    let heavy = frequencies(1e6 * light.inertia);
    let held = of_mesh(
        &whole,
        &Material::STEEL,
        &Mounting::gear(false, 0.0),
        wanted,
        false,
        None,
    )
    .unwrap();
    for (a, b) in heavy.omega.iter().zip(&held.omega) {
        assert!((a / b - 1.0).abs() < 1e-5);
    }
    assert!((light.inertia / held.inertia - 1.0).abs() < 1e-12);
    for (h, p) in heavy.hub.iter().zip(&held.participation) {
        let expected = p.abs() / heavy.inertia;
        let scale = held
            .participation
            .iter()
            .fold(0.0_f64, |m, p| m.max(p.abs()))
            / heavy.inertia;
        assert!((h.abs() - expected).abs() < 1e-4 * scale, "{h} {expected}");
    }
    // A turning hub that is light yields: no frequency falls, and some rise.
    let sum = |b: &Basis| b.omega.iter().sum::<f64>();
    assert!(sum(&light) > sum(&held));
}

#[test]
fn a_rack_slides_and_a_held_one_is_pulled() {
    let rack = test_support::rack(3, 2e-3, |p| p.face_width = 4e-3);
    let whole = gear_mesh::rack(&rack, &coarse(2, 1)).unwrap();
    for free in [true, false] {
        let mounting = Mounting::rack(free, 0.01);
        let all = of_mesh(
            &whole,
            &Material::STEEL,
            &mounting,
            ModeSelection::Count(usize::MAX / 2),
            false,
            None,
        )
        .unwrap();
        // With all modes the momentum of a held rack is that of its free nodes, e^T M e without the back's share.
        let carried: f64 = all.participation.iter().map(|p| p * p).sum();
        assert!(all.inertia > 0.01);
        assert_eq!(free, carried == 0.0);
        assert!(carried < all.inertia - 0.01);
        let some = of_mesh(
            &whole,
            &Material::STEEL,
            &mounting,
            ModeSelection::UpTo(2e5),
            false,
            None,
        )
        .unwrap();
        let below = all
            .omega
            .partition_point(|w| *w <= std::f64::consts::TAU * 2e5);
        assert_eq!(some.omega.len(), below);
        for (a, b) in some.omega.iter().zip(&all.omega) {
            assert!((a / b - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn up_to_a_frequency_and_a_number_are_the_same_modes() {
    let gear = Gear::new(params(9)).unwrap();
    let sector = gear_mesh::sector(&gear, &coarse(2, 2)).unwrap();
    let mounting = Mounting::gear(true, 0.0);
    let of = |wanted| of_sector(&sector, &Material::STEEL, &mounting, wanted, false).unwrap();
    let by_number = of(ModeSelection::Count(50));
    let edge = 0.5 * (by_number.omega[39] + by_number.omega[40]);
    let by_frequency = of(ModeSelection::UpTo(edge / std::f64::consts::TAU));
    let below = by_number.omega.partition_point(|w| *w <= edge);
    assert_eq!(by_frequency.omega.len(), below);
    assert_eq!(by_frequency.family[..], by_number.family[..below]);
}
