//! Patch tests of the elements: constant strain on distorted meshes, and bending of each kind, are exact.

use crate::Material;
use crate::Vec3;
use crate::assembly::assemble;
use crate::element::Integrator;
use crate::mesh::brick;
use crate::mesh::{ElementKind, Mesh};
use crate::test_support::largest;
use nalgebra::DMatrix;

/// Moves the inner nodes by up to 0.15 of an element; `curved` leaves mid-side nodes where that bends edges.
fn distort(mesh: &mut Mesh, cells: usize, side: f64, curved: bool) {
    let h = side / cells as f64;
    let straight = mesh.nodes.clone();
    let moved = |x: &Vec3| {
        let inside = x.iter().all(|c| *c > 0.01 * h && *c < side - 0.01 * h);
        let size = if curved { 0.04 } else { 0.15 };
        let s = |k: f64| size * h * f64::from(u8::from(inside)) * (k * x.sum() / h + x.x / h).sin();
        x + Vec3::new(s(1.7), s(2.9), s(4.1))
    };
    for x in &mut mesh.nodes {
        *x = moved(x);
    }
    let kind = mesh.kind().unwrap();
    if curved || !kind.is_quadratic() {
        return;
    }
    for e in 0..mesh.element_count() {
        let nodes: Vec<u32> = mesh.element(e).to_vec();
        for (middle, edge) in kind.edges().iter().enumerate() {
            let ends = edge.map(|i| moved(&straight[nodes[i] as usize]));
            mesh.nodes[nodes[kind.corners() + middle] as usize] = 0.5 * (ends[0] + ends[1]);
        }
    }
}

/// Largest force at an inner node over the largest at all, under a linear displacement field.
fn unbalance(kind: ElementKind, curved: bool) -> f64 {
    let (cells, size) = (3, 3e-3);
    let mut mesh = brick(kind, [cells; 3], [size; 3]);
    let regular = mesh.nodes.clone();
    distort(&mut mesh, cells, size, curved);
    let h = [
        [1e-4, 3e-5, -2e-5],
        [5e-5, -2e-4, 4e-5],
        [1e-5, -6e-5, 7e-5],
    ];
    let u: Vec<f64> = mesh
        .nodes
        .iter()
        .flat_map(|x| h.map(|r| r[0] * x.x + r[1] * x.y + r[2] * x.z))
        .collect();
    let a = assemble(&mesh, &Material::STEEL).unwrap();
    let mut f = vec![0.0; u.len()];
    a.stiffness.apply(&u, &mut f);
    let inside: Vec<f64> = (0..mesh.nodes.len())
        .filter(|&i| regular[i].iter().all(|c| *c > 1e-9 && *c < size - 1e-9))
        .flat_map(|i| [f[3 * i], f[3 * i + 1], f[3 * i + 2]])
        .collect();
    assert!(inside.len() >= 24);
    largest(&inside) / largest(&f)
}

#[test]
fn a_linear_field_is_in_balance_on_a_distorted_mesh() {
    for kind in ElementKind::ALL {
        let found = unbalance(kind, false);
        assert!(found < 1e-12, "{kind:?} {found:e}");
    }
    // On bent edges three points per axis still integrate the fifth degree that occurs; two do not.
    let found = unbalance(ElementKind::C3D20, true);
    assert!(found < 1e-12, "{found:e}");
}

#[test]
fn null_spaces_are_those_of_the_integration_rules() {
    for (kind, expected) in [
        (ElementKind::C3D8, 6),
        (ElementKind::C3D8I, 6),
        (ElementKind::C3D20, 6),
        // 8 points of 6 strains each bear 48 of 60 coordinates; six of the twelve others are no rigid motion.
        (ElementKind::C3D20R, 12),
        (ElementKind::C3D4, 6),
        (ElementKind::C3D10, 6),
        // Two points of 6 strains each, not all of them independent: one motion is no rigid one.
        (ElementKind::C3D6, 7),
        (ElementKind::C3D15, 6),
    ] {
        let mesh = brick(kind, [1; 3], [1.0, 0.7, 1.2]);
        let n = kind.nodes();
        let (mut k, mut m) = (vec![0.0; 9 * n * n], vec![0.0; n * n]);
        let order: Vec<Vec3> = mesh
            .element(0)
            .iter()
            .map(|&i| mesh.nodes[i as usize])
            .collect();
        Integrator::new(kind)
            .matrices(0, &order, &Material::STEEL, &mut k, &mut m)
            .unwrap();
        let size = largest(&k);
        let k = DMatrix::from_row_slice(3 * n, 3 * n, &k) / size;
        let values = k.symmetric_eigenvalues();
        assert!(values.iter().all(|v| *v > -1e-13));
        let zeros = values.iter().filter(|v| **v < 1e-10).count();
        assert_eq!(zeros, expected, "{kind:?}");
    }
}

#[test]
fn incompatible_modes_bend_exactly_where_plain_bricks_lock() {
    let (length, height, width): (f64, f64, f64) = (8e-3, 2e-3, 3e-3);
    let (curvature, nu) = (0.3_f64, Material::STEEL.poisson);
    let inertia = width * height.powi(3) / 12.0;
    let exact = 0.5 * Material::STEEL.young * inertia * length * curvature.powi(2);
    let energy = |kind| {
        let mesh = brick(kind, [2, 1, 1], [length, height, width]);
        let u: Vec<f64> = mesh
            .nodes
            .iter()
            .flat_map(|p| {
                let (x, y, z) = (p.x, p.y - 0.5 * height, p.z - 0.5 * width);
                [
                    curvature * x * y,
                    -0.5 * curvature * (x * x + nu * (y * y - z * z)),
                    -nu * curvature * y * z,
                ]
            })
            .collect();
        let a = assemble(&mesh, &Material::STEEL).unwrap();
        let mut f = vec![0.0; u.len()];
        a.stiffness.apply(&u, &mut f);
        0.5 * u.iter().zip(&f).map(|(u, f)| u * f).sum::<f64>() / exact
    };
    for kind in [ElementKind::C3D8I, ElementKind::C3D20, ElementKind::C3D20R] {
        let found = energy(kind);
        assert!((found - 1.0).abs() < 1e-12, "{kind:?} {found}");
    }
    // Two elements over the length: shear locking is coarse.
    let found = energy(ElementKind::C3D8);
    assert!(found > 2.0, "{found}");
}
