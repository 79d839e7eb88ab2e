//! Against CalculiX 2.20: the stored beam of 20 x 2 x 2 elements, twelve eigenfrequencies with each element.

use super::support::frequencies;
use crate::assembly::assemble;
use crate::assembly::tie::{MassKind, Tie};
use crate::deck::{Target, read};
use crate::mesh::{ElementKind, Mesh};
use std::collections::BTreeMap;

/// Frequencies [Hz] of a stored deck whose nodes are clamped in one set, beside the stored ones.
fn of_deck(kind: ElementKind, name: &str, table: &str, count: usize) -> Vec<[f64; 2]> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/calculix/modal");
    let deck = read(format!("{folder}/{name}_{}.inp.gz", kind.name())).unwrap();
    assert_eq!((deck.blocks.len(), deck.blocks[0].kind), (1, kind));
    let mesh = Mesh {
        nodes: deck.nodes.clone(),
        kind,
        connectivity: deck.blocks[0].connectivity.clone(),
        node_sets: BTreeMap::new(),
        face_sets: BTreeMap::new(),
    };
    let clamp = &deck.boundaries[0];
    assert_eq!(clamp.directions, [1, 3]);
    assert!(matches!(clamp.target, Target::Set(_)));
    let material = deck.material("steel").unwrap();
    let a = assemble(&mesh, &material).unwrap();
    let tie = Tie::new(&mesh.nodes, deck.target(&clamp.target), &[]);
    let ours = frequencies(&tie.reduce(&a, &[], MassKind::Consistent), count);
    let table = std::fs::read_to_string(format!("{folder}/{table}.csv")).unwrap();
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
        for (i, [ours, stored]) in of_deck(kind, "beam", "eig_beam", 12)
            .into_iter()
            .enumerate()
        {
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
    let found = of_deck(ElementKind::C3D8I, "beam", "eig_beam", 12);
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
    let quadratic = of_deck(ElementKind::C3D20, "beam", "eig_beam", 12);
    for i in [0, 1, 2, 3, 6, 7] {
        let difference = found[i][0] / quadratic[i][0] - 1.0;
        assert!(difference.abs() < 3e-2, "mode {}: {difference:e}", i + 1);
    }
}
