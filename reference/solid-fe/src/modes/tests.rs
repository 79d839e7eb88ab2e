//! Modes with known frequencies: chains, bricks, free bodies, multiple eigenvalues.

use super::*;
use crate::Material;
use crate::assembly::assemble;
use crate::assembly::tie::{MassKind, Reduced, Tie};
use crate::mesh::brick;
use crate::mesh::{ElementKind, Mesh};
use faer::sparse::{SparseColMat, Triplet};

/// Kronecker sum of chains between walls on an n x n x n grid: eigenvalues are sums of 4 sin^2, many multiple.
fn grid(n: usize) -> Reduced {
    let index = |x: usize, y: usize, z: usize| (x * n + y) * n + z;
    let (mut k, mut m) = (Vec::new(), Vec::new());
    for x in 0..n {
        for y in 0..n {
            for z in 0..n {
                let i = index(x, y, z);
                k.push(Triplet::new(i, i, 6.0));
                m.push(Triplet::new(i, i, 1.0));
                for (inside, j) in [
                    (x + 1 < n, index((x + 1) % n, y, z)),
                    (y + 1 < n, index(x, (y + 1) % n, z)),
                    (z + 1 < n, index(x, y, (z + 1) % n)),
                ] {
                    if inside {
                        k.push(Triplet::new(j, i, -1.0));
                    }
                }
            }
        }
    }
    let size = n * n * n;
    let make = |t: &[_]| SparseColMat::try_new_from_triplets(size, size, t).unwrap();
    Reduced {
        stiffness: make(&k),
        mass: make(&m),
    }
}

fn exact_grid(n: usize) -> Vec<f64> {
    let one = |i: usize| {
        4.0 * (0.5 * std::f64::consts::PI * i as f64 / (n + 1) as f64)
            .sin()
            .powi(2)
    };
    let mut all = Vec::new();
    for i in 1..=n {
        for j in 1..=n {
            all.extend((1..=n).map(|l| one(i) + one(j) + one(l)));
        }
    }
    all.sort_by(f64::total_cmp);
    all
}

#[test]
fn multiple_eigenvalues_are_complete() {
    let n = 12;
    let pair = grid(n);
    let exact = exact_grid(n);
    for (count, block) in [(1, 1), (40, 8), (150, 6), (60, 12)] {
        let options = Options {
            block: Some(block),
            ..Options::default()
        };
        let modes = lowest(&pair, count, &options).unwrap();
        for i in 0..count {
            let error = (modes.omega2[i] / exact[i] - 1.0).abs();
            assert!(
                error < 1e-11,
                "mode {i} of {count}, block {block}: {error:e}"
            );
            assert!(modes.residuals[i] < 1e-8, "{:e}", modes.residuals[i]);
        }
        let gram = modes.vectors.transpose() * &modes.vectors;
        for i in 0..count {
            for j in 0..count {
                assert!((gram[(i, j)] - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
        assert!(count == 1 || modes.report.verified + block.max(4) >= count);
    }
}

fn reduced(mesh: &Mesh, held: &[u32]) -> Reduced {
    let assembly = assemble(mesh, &Material::STEEL).unwrap();
    Tie::new(&mesh.nodes, held, &[]).reduce(&assembly, &[], MassKind::Consistent)
}

#[test]
fn free_body_has_six_rigid_modes() {
    let mesh = brick(ElementKind::C3D8, [6, 4, 4], [0.06, 0.04, 0.03]);
    let r = reduced(&mesh, &[]);
    let modes = lowest(&r, 20, &Options::default()).unwrap();
    let first = modes.omega2[6];
    assert!(first > 1e8);
    assert!(
        modes.omega2[..6].iter().all(|w2| w2.abs() < 1e-7 * first),
        "{:?}",
        &modes.omega2[..7]
    );
    assert!(
        modes.residuals.iter().all(|r| *r < 1e-7),
        "{:?}",
        modes.residuals
    );
    assert!(modes.report.steps > 0 && modes.report.verified >= 12);
}

#[test]
fn iteration_agrees_with_the_full_decomposition() {
    let mesh = brick(ElementKind::C3D8, [7, 4, 4], [0.05, 0.02, 0.02]);
    let held: Vec<u32> = (0..25).collect();
    let r = reduced(&mesh, &held);
    let (k, m) = (
        Symmetric::new(r.stiffness.as_ref()).unwrap(),
        Symmetric::new(r.mass.as_ref()).unwrap(),
    );
    let full = dense::lowest(&k, &m, 60, 0.0).unwrap();
    let modes = lowest(&r, 60, &Options::default()).unwrap();
    assert!(modes.report.steps > 0);
    for i in 0..60 {
        let error = (modes.omega2[i] / full.omega2[i] - 1.0).abs();
        assert!(error < 1e-9, "mode {i}: {error:e}");
    }
}

#[test]
fn bad_input_is_declined() {
    let find = |pair: &Reduced, count| lowest(pair, count, &Options::default()).map(|_| ());
    let good = grid(3);
    let other = Reduced {
        mass: grid(2).mass,
        ..grid(3)
    };
    assert!(matches!(
        find(&other, 2),
        Err(ModesError::Sizes {
            stiffness: 27,
            mass: 8
        })
    ));
    assert!(matches!(find(&good, 28), Err(ModesError::TooMany { .. })));
    let mut bad = grid(8);
    bad.stiffness.val_mut()[17] = f64::NAN;
    assert!(matches!(find(&bad, 3), Err(ModesError::Matrix(_))));
    let mut negative = grid(8);
    let masses = negative.mass.val_mut();
    masses.iter_mut().for_each(|v| *v = -*v);
    let options = Options {
        shift: Some(-1.0),
        ..Options::default()
    };
    assert!(lowest(&negative, 3, &options).is_err());
}

/// The lowest pair of modes of two equal chains is found when only that pair is requested.
#[test]
fn a_lone_pair_is_found_without_a_count_between_its_halves() {
    let n = 400;
    let mut stiffness = Vec::new();
    for i in 0..n {
        stiffness.push(Triplet::new(i, i, 2.0));
        if i + 1 < n && i + 1 != n / 2 {
            stiffness.push(Triplet::new(i + 1, i, -1.0));
        }
    }
    let unit: Vec<_> = (0..n).map(|i| Triplet::new(i, i, 1.0)).collect();
    let matrix = |t: &[_]| SparseColMat::<usize, f64>::try_new_from_triplets(n, n, t).unwrap();
    let pair = Reduced {
        stiffness: matrix(&stiffness),
        mass: matrix(&unit),
    };
    let found = lowest(&pair, 2, &Options::default()).unwrap();
    // Each chain has n/2 masses between two walls: omega_1 = 2 sin(pi / (2 (n/2 + 1))).
    let exact = 2.0 * (std::f64::consts::PI / (n + 2) as f64).sin();
    for w2 in found.omega2 {
        assert!((w2.sqrt() / exact - 1.0).abs() < 1e-9, "{w2}");
    }
}
