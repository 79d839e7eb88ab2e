//! Recovered displacements agree with those of the gear at the flanks, and kept or truncated modes have the same
//! static displacement everywhere.

#![allow(clippy::print_stdout)]

use super::*;
use crate::reduction::choose::{ModalDamping, reduced};
use crate::reduction::{ModeSelection, basis};
use crate::test_support::{coarse, rack, stub};

const ALL: [bool; 6] = [true; 6];

/// A gear by the sector of a tooth, or by its whole mesh, with some of its modes.
fn of(
    teeth: u32,
    helix: f64,
    mounting: Mounting,
    by_sector: bool,
    along_profile: bool,
) -> MeshRecovery {
    let gear = stub(teeth, helix);
    let params = coarse(1, 2);
    let material = Material::STEEL;
    let wanted = ModeSelection::Count(24);
    let (mesh, basis, whole) = if by_sector {
        let mesh = gear_mesh::sector(&gear, &params).unwrap();
        let basis = basis::of_sector(&mesh, &material, &mounting, wanted, along_profile);
        let whole = MeshExtent::Generated(Box::new((Toothing::Gear(gear), params)));
        (mesh, basis, whole)
    } else {
        let mesh = gear_mesh::gear(&gear, &params).unwrap();
        let basis = basis::of_mesh(&mesh, &material, &mounting, wanted, along_profile, None);
        (mesh, basis, MeshExtent::AtHand)
    };
    let basis = basis.unwrap();
    // Both of a pair or neither, and not the lowest alone.
    let some = |mode: &usize| [0, 2, 3, 6, 9].contains(&basis.family[*mode]);
    let kept = (0..basis.omega.len()).filter(some).collect();
    MeshRecovery {
        mesh,
        whole,
        material,
        mounting,
        basis: Arc::new(basis),
        kept,
        made: None,
        residual: true,
        strips: None,
        found: OnceLock::new(),
    }
}

fn load(numbers: &[u32]) -> BodyLoad {
    let forces = numbers.iter().zip([300.0, -120.0, 55.0]);
    BodyLoad {
        forces: forces.map(|(n, f)| (*n, f)).collect(),
        hub: 2.0,
    }
}

/// Returns the largest difference between displacements along the directions of flank nodes from the mesh and from the
/// reduction, relative to the largest.
fn difference(of: &MeshRecovery, q: &[f64], load: &BodyLoad) -> f64 {
    let mut data = reduced(&of.basis, &of.kept, &ModalDamping::default(), of.residual).unwrap();
    if let Some(strips) = of.strips {
        data = data.over_lines(strips).unwrap();
    }
    let [_, u] = of.displacements(q, load).unwrap();
    let flat: Vec<f64> = u.iter().flat_map(|u| [u.x, u.y, u.z]).collect();
    let found = of.found().unwrap();
    let mut rows = vec![0.0; of.basis.directions()];
    found.surface.along_directions(&flat, &mut rows);
    let (mut most, mut off) = (0.0_f64, 0.0_f64);
    let per_node = data.per_node() as u32;
    for number in 0..data.rows() as u32 {
        let row = data.row_of(number);
        let mut expected: f64 = data
            .shapes_at(number)
            .iter()
            .zip(q)
            .map(|(b, q)| b * q)
            .sum();
        if let Some(r) = &data.residual {
            expected += r.hub[row as usize] * load.hub;
            for (node, f) in &load.forces {
                expected -= f * r.flanks.between(row, data.row_of(*node), data.rows());
            }
        }
        let (node, direction) = (row / per_node, row % per_node);
        let found = match &found.lines {
            None => rows[row as usize],
            Some(lines) => (lines[node as usize].iter())
                .map(|(node, w)| w * rows[*node * per_node as usize + direction as usize])
                .sum(),
        };
        most = most.max(expected.abs());
        off = off.max((found - expected).abs());
    }
    off / most
}

#[test]
fn flanks_move_as_the_gear_says() {
    let free = Mounting::gear(true, 2e-6);
    let floating = Mounting::gear(true, 2e-6).with_added(0.02, 3e-6);
    let floating = floating.lateral(ALL).unwrap();
    for (name, mut of, nodes) in [
        (
            "turning, by a sector",
            of(9, 0.3, free, true, false),
            [3, 40, 41],
        ),
        (
            "the same, whole",
            of(9, 0.3, free, false, false),
            [3, 40, 41],
        ),
        (
            "odd and even harmonics",
            of(10, 0.0, free, true, false),
            [3, 40, 41],
        ),
        (
            "held",
            of(9, 0.0, Mounting::gear(false, 0.0), true, false),
            [0, 7, 20],
        ),
        (
            "floating, by a sector",
            of(9, 0.3, floating, true, false),
            [3, 40, 41],
        ),
        (
            "floating, whole",
            of(9, 0.0, floating, false, false),
            [3, 40, 41],
        ),
        (
            "along the profile",
            of(9, 0.0, free, true, true),
            [3, 40, 9 * 36 + 5],
        ),
    ] {
        let q: Vec<f64> = (0..of.kept.len())
            .map(|i| 1e-6 * (3.0 - i as f64))
            .collect();
        for residual in [true, false] {
            of.residual = residual;
            let off = difference(&of, &q, &load(&nodes));
            println!("{name}: {off:.1e}");
            assert!(off < 1e-6, "{name}: {off:e}");
        }
    }
}

#[test]
fn lines_on_half_spaces_too() {
    let mut of = of(9, 0.0, Mounting::gear(true, 0.0), true, false);
    of.strips = Some(Strips::Layers);
    let q = vec![1e-6; of.kept.len()];
    let off = difference(&of, &q, &load(&[2, 9, 10]));
    assert!(off < 1e-6, "{off:e}");
}

/// Under a load that stays, modes deflect by `Phi^T f/omega^2`: all of the body is then where it is without modes.
#[test]
fn a_static_displacement_does_not_depend_on_the_modes() {
    let mut of = of(9, 0.3, Mounting::gear(true, 2e-6), true, false);
    let load = load(&[3, 40, 41]);
    let data = reduced(&of.basis, &of.kept, &ModalDamping::default(), true).unwrap();
    let q: Vec<f64> = (0..of.kept.len())
        .map(|i| {
            let by_flanks: f64 = (load.forces.iter())
                .map(|(node, f)| -f * data.shapes_at(*node)[i])
                .sum();
            (by_flanks + load.hub * data.hub[i]) / data.omega[i].powi(2)
        })
        .collect();
    let [_, with] = of.displacements(&q, &load).unwrap();
    of.kept = Vec::new();
    of.found = OnceLock::new();
    let [_, without] = of.displacements(&[], &load).unwrap();
    let most = without.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let off = with.iter().zip(&without).map(|(a, b)| (a - b).norm());
    assert!(off.fold(0.0, f64::max) < 1e-6 * most);
    // Nodes of the hub turn alike, as a rigid body.
    let nodes = &of.found().unwrap().nodes;
    let held = &of.mesh.bore.len();
    assert!(*held > 0);
    let place = &of.found().unwrap().tie.place;
    let turns = (0..nodes.len())
        .filter(|n| place[*n] == Tie::HELD)
        .map(|n| {
            let (x, u) = (&nodes[n], &without[n]);
            (x.x * u.y - x.y * u.x) / (x.x * x.x + x.y * x.y)
        });
    let (low, high) = turns.fold((f64::MAX, f64::MIN), |(a, b), t| (a.min(t), b.max(t)));
    assert!(
        high - low < 1e-9 * high.abs() && high != 0.0,
        "{low:e} {high:e}"
    );
}

/// A rack has no sector.
#[test]
fn racks_are_their_whole_mesh() {
    let rack = rack(4, 4e-3, |_| {});
    let mesh = gear_mesh::rack(&rack, &coarse(1, 1)).unwrap();
    let mounting = Mounting::rack(true, 0.1);
    let basis = basis::of_mesh(
        &mesh,
        &Material::STEEL,
        &mounting,
        ModeSelection::Count(8),
        false,
        None,
    );
    let of = MeshRecovery {
        mesh,
        whole: MeshExtent::AtHand,
        material: Material::STEEL,
        mounting,
        basis: Arc::new(basis.unwrap()),
        kept: vec![0, 2, 3],
        made: None,
        residual: true,
        strips: None,
        found: OnceLock::new(),
    };
    let off = difference(&of, &[1e-6, 0.0, -2e-6], &load(&[1, 5, 6]));
    assert!(off < 1e-6, "{off:e}");
}
