//! Against CalculiX 2.20: the stored beam of 20 x 2 x 2 elements, twelve eigenfrequencies with each element,
//! and mass and inertia of the stored gears.

use super::support::{frequencies, largest};
use crate::assembly::assemble;
use crate::assembly::tie::{HubMotion, MassKind, Tie};
use crate::deck::read;
use crate::mesh::{ElementKind, Mesh};
use gearbench_models::stiffness::Material;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/calculix/modal");

/// Mesh, clamped nodes and material of a stored deck.
fn stored(kind: ElementKind, name: &str) -> (Mesh, Vec<u32>, Material) {
    let deck = read(format!("{FOLDER}/{name}_{}.inp.gz", kind.name())).unwrap();
    assert_eq!((deck.blocks.len(), deck.blocks[0].kind), (1, kind));
    let mesh = Mesh::new(
        kind,
        deck.nodes.clone(),
        deck.blocks[0].connectivity.clone(),
    );
    let clamp = &deck.boundaries[0];
    assert_eq!(clamp.directions, [1, 3]);
    let held = deck.target(&clamp.target).to_vec();
    (mesh, held, deck.material("steel").unwrap())
}

/// Frequencies [Hz] of the beam beside the stored ones.
fn beam(kind: ElementKind) -> Vec<[f64; 2]> {
    let (mesh, held, material) = stored(kind, "beam");
    let a = assemble(&mesh, &material).unwrap();
    let tie = Tie::new(&mesh.nodes, &held, &[]);
    let ours = frequencies(&tie.reduce(&a, &[], MassKind::Consistent), 12);
    let table = std::fs::read_to_string(format!("{FOLDER}/eig_beam.csv")).unwrap();
    let mut lines = table.lines();
    let column = format!("{}_hz", kind.name());
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|c| c == column)
        .unwrap();
    ours.into_iter()
        .zip(lines)
        .map(|(f, line)| [f, line.split(',').nth(place).unwrap().parse().unwrap()])
        .collect()
}

#[test]
fn the_beam_s_frequencies_are_calculix_s() {
    // The stored figures have seven digits.
    for kind in [ElementKind::C3D8, ElementKind::C3D20, ElementKind::C3D20R] {
        for (i, [ours, stored]) in beam(kind).into_iter().enumerate() {
            assert!(
                (ours / stored - 1.0).abs() < 1e-6,
                "{kind:?} mode {}: {ours} Hz, stored {stored} Hz",
                i + 1
            );
        }
    }
}

#[test]
fn condensed_incompatible_modes_differ_from_calculix_s_by_their_missing_mass() {
    // CalculiX gives the internal displacements mass. In slow bending that takes inertia from the outside of the
    // chord (its frequency lies a little higher), in faster motion it adds inertia: lower by a part that grows.
    let found = beam(ElementKind::C3D8I);
    for (i, [ours, stored]) in found.iter().enumerate() {
        let difference = ours / stored - 1.0;
        let expected = if i < 2 { -2e-4..0.0 } else { 0.0..4e-2 };
        assert!(
            expected.contains(&difference),
            "mode {}: {ours} Hz, stored {stored} Hz",
            i + 1
        );
    }
    // The bending that plain bricks lock in comes out as quadratic elements have it.
    let quadratic = beam(ElementKind::C3D20);
    for i in [0, 1, 2, 3, 6, 7] {
        let difference = found[i][0] / quadratic[i][0] - 1.0;
        assert!(difference.abs() < 3e-2, "mode {}: {difference:e}", i + 1);
    }
}

#[test]
fn gears_have_the_stored_mass_and_inertia_and_turn_without_force() {
    // Mass [kg] and moment of inertia about the axis [kg m^2] that CalculiX's runs on these meshes were
    // evaluated with.
    for (name, mass, inertia) in [
        ("g1", 0.332_857, 3.096_810e-4),
        ("g2", 0.725_171, 1.542_303_5e-3),
    ] {
        let (mesh, _, material) = stored(ElementKind::C3D8, name);
        let a = assemble(&mesh, &material).unwrap();
        let total: f64 = a.lumped.iter().sum();
        assert!((total / mass - 1.0).abs() < 2e-6, "{name}: {total} kg");
        let turned: Vec<f64> = mesh
            .nodes
            .iter()
            .flat_map(|x| HubMotion::Turn.of(x).data.0[0])
            .collect();
        let mut image = vec![0.0; turned.len()];
        a.mass.apply(&turned, &mut image);
        let found: f64 = turned.iter().zip(&image).map(|(u, p)| u * p).sum();
        assert!(
            (found / inertia - 1.0).abs() < 2e-7,
            "{name}: {found} kg m^2"
        );
        a.stiffness.apply(&turned, &mut image);
        let stiffest = a.stiffness.entries().iter().flatten();
        let size = stiffest.fold(0.0_f64, |m, k| m.max(k.abs())) * largest(&turned);
        assert!(largest(&image) < 1e-13 * size);
    }
}
