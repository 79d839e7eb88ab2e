//! Frequencies against the stored CalculiX tables, on the decks CalculiX solved: bores and beam ends clamped.
//!
//! `C3D8` and `C3D20R` are the same elements in both programs and must agree to the printed digits. Our `C3D8I`
//! condenses its incompatible modes, which CalculiX does not (it gives them mass); it is judged by the
//! quadratic element on the same mesh.

#![allow(clippy::print_stdout)]

use gearbench_models::geometry::{Gear, GearParams};
use gearbench_models::stiffness::Material;
use gearbench_reference::assembly::assemble;
use gearbench_reference::assembly::tie::{HubMotion, MassKind, Tie};
use gearbench_reference::deck::{self, Deck};
use gearbench_reference::gear_mesh::{GearMeshParams, Tooth, sector};
use gearbench_reference::mesh::{ElementKind, Mesh};
use gearbench_reference::modes::cyclic::{self, Hub};
use gearbench_reference::modes::{Modes, Options, lowest};
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("calculix/modal")
}

/// A column of a table of frequencies [Hz].
fn table(name: &str, column: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(folder().join(name)).expect("stored table");
    let at = reader
        .headers()
        .unwrap()
        .iter()
        .position(|h| h == column)
        .expect("column");
    reader
        .records()
        .filter_map(|r| r.unwrap()[at].parse().ok())
        .collect()
}

/// Returns mesh, fixed nodes and material of a deck with one body; `kind` may replace the element type.
fn stored(name: &str, kind: Option<ElementKind>) -> (Mesh, Vec<u32>, Material) {
    let deck: Deck = deck::read(folder().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let block = &deck.blocks[0];
    let kind = kind.unwrap_or(block.kind);
    let mesh = Mesh::new(kind, deck.nodes.clone(), block.connectivity.clone());
    let mut held: Vec<u32> = Vec::new();
    for b in &deck.boundaries {
        assert_eq!(b.directions, [1, 3], "{name}: clamped nodes expected");
        held.extend(deck.target(&b.target));
    }
    let material = deck.section_materials()[0]
        .and_then(|m| deck.material(m))
        .expect("material");
    (mesh, held, material)
}

/// Returns the modes of a deck with one body and fixed nodes.
fn modes_of(name: &str, kind: Option<ElementKind>, count: usize) -> Modes {
    let (mesh, held, material) = stored(name, kind);
    let assembly = assemble(&mesh, &material).unwrap();
    let r = Tie::new(&mesh.nodes, &held, &[]).reduce(&assembly, &[], MassKind::Consistent);
    let modes = lowest(&r, count, &Options::default()).unwrap();
    let worst = modes.residuals.iter().copied().fold(0.0, f64::max);
    assert!(worst < 1e-7, "{name}: residual {worst:e}");
    modes
}

/// Greatest relative difference of the leading frequencies.
fn difference(modes: &Modes, table: &[f64]) -> f64 {
    let pairs = modes.frequencies().into_iter().zip(table);
    pairs.map(|(f, t)| (f / t - 1.0).abs()).fold(0.0, f64::max)
}

/// Compares a deck with a column and prints the row of the table.
fn agrees(deck: &str, csv: &str, column: &str, tolerance: f64) {
    let stored = table(csv, column);
    let count = stored.len().min(20);
    let d = difference(&modes_of(deck, None, count), &stored);
    println!("| {deck} | {count} | {d:.1e} |");
    assert!(d < tolerance, "{deck}: {d:.2e}");
}

#[test]
fn hexahedra_agree() {
    // The stored figures have seven digits.
    for (deck, csv, column, tolerance) in [
        ("beam_C3D8.inp.gz", "eig_beam.csv", "C3D8_hz", 1e-6),
        ("g1_C3D8.inp.gz", "eig_z20_uniform.csv", "C3D8_hz", 1e-5),
        ("g2_C3D8.inp.gz", "eig_z30_uniform.csv", "C3D8_hz", 1e-5),
        ("impA_g1_C3D8.inp.gz", "eig_impA_g1.csv", "C3D8_hz", 1e-5),
        ("impA_g2_C3D8.inp.gz", "eig_impA_g2.csv", "C3D8_hz", 1e-5),
        ("beam_C3D20.inp.gz", "eig_beam.csv", "C3D20_hz", 1e-6),
        ("beam_C3D20R.inp.gz", "eig_beam.csv", "C3D20R_hz", 1e-6),
        (
            "impA_g1_C3D20R.inp.gz",
            "eig_impA_g1.csv",
            "C3D20R_hz",
            1e-5,
        ),
    ] {
        agrees(deck, csv, column, tolerance);
    }
}

#[test]
fn condensed_incompatible_modes_differ_from_calculix_s_by_their_missing_mass() {
    // CalculiX gives the internal displacements mass. In slow bending that takes inertia from the outside of the
    // chord (its frequency lies a little higher), in faster motion it adds inertia: lower by a part that grows.
    let ours = modes_of("beam_C3D8I.inp.gz", None, 12).frequencies();
    for (i, (ours, stored)) in ours
        .iter()
        .zip(table("eig_beam.csv", "C3D8I_hz"))
        .enumerate()
    {
        let difference = ours / stored - 1.0;
        let expected = if i < 2 { -2e-4..0.0 } else { 0.0..4e-2 };
        assert!(
            expected.contains(&difference),
            "mode {}: {ours} Hz, stored {stored} Hz",
            i + 1
        );
    }
    // The bending that plain bricks lock in comes out as quadratic elements have it.
    let quadratic = modes_of("beam_C3D20.inp.gz", None, 12).frequencies();
    for i in [0, 1, 2, 3, 6, 7] {
        let difference = ours[i] / quadratic[i] - 1.0;
        assert!(difference.abs() < 3e-2, "mode {}: {difference:e}", i + 1);
    }
}

#[test]
fn gears_have_the_stored_mass_and_inertia_and_turn_without_force() {
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    // Mass [kg] and moment of inertia about the axis [kg m^2] that CalculiX's runs on these meshes were
    // evaluated with.
    for (name, mass, inertia) in [
        ("g1_C3D8.inp.gz", 0.332_857, 3.096_810e-4),
        ("g2_C3D8.inp.gz", 0.725_171, 1.542_303_5e-3),
    ] {
        let (mesh, _, material) = stored(name, None);
        let a = assemble(&mesh, &material).unwrap();
        let total: f64 = a.lumped.iter().sum();
        assert!((total / mass - 1.0).abs() < 2e-6, "{name}: {total} kg");
        let turned = mesh
            .nodes
            .iter()
            .flat_map(|x| HubMotion::Turn.of(x).data.0[0]);
        let turned: Vec<f64> = turned.collect();
        let mut image = vec![0.0; turned.len()];
        a.mass.apply(&turned, &mut image);
        let found: f64 = turned.iter().zip(&image).map(|(u, p)| u * p).sum();
        assert!(
            (found / inertia - 1.0).abs() < 2e-7,
            "{name}: {found} kg m^2"
        );
        a.stiffness.apply(&turned, &mut image);
        let size = largest(a.stiffness.entries().as_flattened()) * largest(&turned);
        assert!(largest(&image) < 1e-13 * size);
    }
}

#[test]
fn condensed_incompatible_modes_are_near_the_quadratic_element() {
    let stored = table("eig_impA_g1.csv", "C3D20R_hz");
    let ours = modes_of("impA_g1_C3D8.inp.gz", Some(ElementKind::C3D8I), 6);
    let d = difference(&ours, &stored);
    println!("| impA_g1, condensed C3D8I to C3D20R | 6 | {d:.1e} |");
    assert!(d < 0.02, "{d:.2e}");
}

#[test]
fn condensed_incompatible_modes_meet_the_quadratic_element_at_as_many_unknowns() {
    // The quadratic element agrees with CalculiX's to the printed digits; here it stands for it.
    let gear = Gear::new(GearParams {
        teeth: 20,
        module: 4e-3,
        face_width: 0.01,
        bore_radius: 0.02,
        ..GearParams::default()
    })
    .unwrap();
    let modes = |kind, [flank, fillet, root, across, rim, width]: [usize; 6]| {
        let tooth = Tooth {
            flank,
            fillet,
            root,
            across,
        };
        let params = GearMeshParams {
            kind,
            tooth,
            rim,
            width,
            ..GearMeshParams::default()
        };
        let section = sector(&gear, &params).unwrap();
        let options = Options {
            verify: false,
            ..Options::default()
        };
        cyclic::lowest(
            &section.as_sector(),
            &Material::STEEL,
            &Hub::fixed(),
            20,
            &options,
        )
        .unwrap()
    };
    let linear = modes(ElementKind::C3D8I, [8, 6, 3, 8, 8, 8]);
    let quadratic = modes(ElementKind::C3D20R, [6, 4, 2, 6, 4, 4]);
    let ratio = linear.unknowns as f64 / quadratic.unknowns as f64;
    assert!((0.9..1.2).contains(&ratio), "unknowns {ratio}");
    let (a, b) = (linear.frequencies(), quadratic.frequencies());
    let d = a
        .iter()
        .zip(&b)
        .map(|(a, b)| (a / b - 1.0).abs())
        .fold(0.0, f64::max);
    println!("| refined z = 20, condensed C3D8I to C3D20R | 20 | {d:.1e} |");
    assert!(d < 0.01, "{d:.2e}");
}

/// A gear meshed and written by gearbench, solved by CalculiX as a whole and here from one sector.
#[test]
fn two_hundred_modes_of_a_generated_gear() {
    let body = Gear::new(GearParams {
        teeth: 24,
        module: 4e-3,
        face_width: 0.02,
        bore_radius: 0.02,
        ..GearParams::default()
    })
    .unwrap();
    // Parameters of the mesh as in `calculix/modal/SOURCE.md`.
    let params = GearMeshParams {
        kind: ElementKind::C3D8,
        tooth: Tooth {
            flank: 9,
            fillet: 6,
            root: 3,
            across: 8,
        },
        layers: 2,
        rim: 6,
        width: 6,
        ..GearMeshParams::default()
    };
    let section = sector(&body, &params).unwrap();
    let stored = table("eig_z24_generated.csv", "C3D8_hz");
    let modes = cyclic::lowest(
        &section.as_sector(),
        &Material::STEEL,
        &Hub::fixed(),
        stored.len(),
        &Options::default(),
    )
    .unwrap();
    assert_eq!(modes.unknowns, 108_864);
    let worst = modes
        .frequencies()
        .iter()
        .zip(&stored)
        .map(|(f, t)| (f / t - 1.0).abs())
        .fold(0.0, f64::max);
    println!("generated gear, {} modes: {worst:.1e}", stored.len());
    assert!(worst < 1e-5, "{worst:e}");
}
