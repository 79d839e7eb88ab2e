mod patch;
mod support;
mod waves;

use super::tie::{HubMotion, MassKind, Tie};
use super::{Assembly, assemble};
use crate::Material;
use crate::Vec3;
use crate::mesh::brick;
use crate::mesh::{ElementKind, Mesh};
use crate::test_support::{largest, product};

/// A bar of `n` bricks along x, slightly distorted inside.
fn bar(n: usize) -> Mesh {
    let length = 1e-2 * n as f64;
    let mut mesh = brick(ElementKind::C3D8, [n, 1, 1], [length, 1e-2, 8e-3]);
    for x in &mut mesh.nodes {
        if x.x > 1e-6 && x.x < length - 1e-6 {
            x.x += 0.1 * (2.0 * x.y + x.z - 9e-3);
        }
    }
    mesh
}

fn assembled(n: usize) -> (Mesh, Assembly) {
    let mesh = bar(n);
    let a = assemble(&mesh, &Material::STEEL).unwrap();
    (mesh, a)
}

#[test]
fn a_pulled_bar_needs_forces_at_its_ends_only() {
    // Uniaxial stress: a linear displacement field that every mesh must hold exactly.
    let (mesh, a) = assembled(5);
    let nu = Material::STEEL.poisson;
    let u: Vec<f64> = mesh
        .nodes
        .iter()
        .flat_map(|x| [1e-4 * x.x, -1e-4 * nu * x.y, -1e-4 * nu * x.z])
        .collect();
    let mut f = vec![0.0; u.len()];
    a.stiffness.apply(&u, &mut f);
    let size = largest(&f);
    assert!(largest(&f[12..60]) < 1e-11 * size);
    let pull: f64 = (0..4).map(|k| f[60 + 3 * k]).sum();
    let expected = 1e-4 * Material::STEEL.young * 1e-2 * 8e-3;
    assert!((pull / expected - 1.0).abs() < 1e-12, "{pull} {expected}");
}

#[test]
fn consistent_and_lumped_mass_are_that_of_the_body() {
    let size = [5e-2, 1e-2, 8e-3];
    let expected = Material::STEEL.density * size.iter().product::<f64>();
    for kind in ElementKind::ALL {
        let a = assemble(&brick(kind, [3, 2, 2], size), &Material::STEEL).unwrap();
        let mut y = vec![0.0; 3 * a.lumped.len()];
        a.mass.apply(&vec![1.0; y.len()], &mut y);
        assert!((y.iter().sum::<f64>() / 3.0 / expected - 1.0).abs() < 1e-12);
        assert!((a.lumped.iter().sum::<f64>() / expected - 1.0).abs() < 1e-12);
        assert!(a.lumped.iter().all(|m| *m > 0.0), "{kind:?}");
    }
}

#[test]
fn reduced_matrices_are_those_of_the_tied_mesh() {
    let (mesh, a) = assembled(4);
    let bore: Vec<u32> = (0..4).collect();
    let motions = [
        HubMotion::Turn,
        HubMotion::Slide(Vec3::new(0.6, 0.0, 0.8)),
        HubMotion::TurnAbout(Vec3::x()),
    ];
    let added = [1e-3, 2e-2, 3e-4];
    let tie = Tie::new(&mesh.nodes, &bore, &motions);
    let n = tie.coordinates();
    let full = 3 * mesh.nodes.len();
    for kind in [MassKind::Consistent, MassKind::Lumped] {
        let reduced = tie.reduce(&a, &added, kind);
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let (mut u, mut f, mut expected) = (vec![0.0; full], vec![0.0; full], vec![0.0; n]);
            tie.expand(&unit, &mut u);
            a.stiffness.apply(&u, &mut f);
            tie.gather(&f, &mut expected);
            let size = largest(&expected).max(1.0);
            for i in j..n {
                let found = reduced.stiffness.get(i, j).copied().unwrap_or(0.0);
                assert!((found - expected[i]).abs() < 1e-12 * size, "{i} {j}");
            }
            match kind {
                MassKind::Consistent => a.mass.apply(&u, &mut f),
                MassKind::Lumped => {
                    for i in 0..full {
                        f[i] = a.lumped[i / 3] * u[i];
                    }
                }
            }
            tie.gather(&f, &mut expected);
            if j >= n - 3 {
                expected[j] += added[j + 3 - n];
            }
            for i in j..n {
                let found = reduced.mass.get(i, j).copied().unwrap_or(0.0);
                assert!(
                    (found - expected[i]).abs() < 1e-14 * largest(&expected),
                    "{i} {j}"
                );
            }
        }
    }
}

#[test]
fn turning_the_whole_body_with_its_hub_stores_no_energy() {
    let (mesh, a) = assembled(4);
    let tie = Tie::new(&mesh.nodes, &[0, 1, 2, 3], &[HubMotion::Turn]);
    let reduced = tie.reduce(&a, &[0.0], MassKind::Consistent);
    let n = tie.coordinates();
    let mut r = vec![0.0; n];
    for (place, &node) in tie.free.iter().enumerate() {
        let turned = HubMotion::Turn.of(&mesh.nodes[node as usize]);
        r[3 * place..][..3].copy_from_slice(turned.as_slice());
    }
    r[n - 1] = 1.0;
    let size = largest(reduced.stiffness.val()) * largest(&r);
    let f = product(&reduced.stiffness, &r);
    assert!(largest(&f) < 1e-13 * size, "{} {size}", largest(&f));
}

#[test]
fn held_coordinates_are_those_of_clamped_nodes() {
    let (mesh, a) = assembled(3);
    let bore: Vec<u32> = (0..4).collect();
    let clamped = Tie::new(&mesh.nodes, &bore, &[]).reduce(&a, &[], MassKind::Consistent);
    let free = Tie::new(&mesh.nodes, &[], &[]).reduce(&a, &[], MassKind::Consistent);
    let held: Vec<bool> = (0..3 * mesh.nodes.len()).map(|i| i < 12).collect();
    let held = free.held(&held);
    let x: Vec<f64> = (0..held.stiffness.ncols())
        .map(|i| (12.9898 * i as f64).sin())
        .collect();
    assert_eq!(
        product(&held.stiffness, &x),
        product(&clamped.stiffness, &x)
    );
    assert_eq!(product(&held.mass, &x), product(&clamped.mass, &x));
}
