//! Bricks of any element kind, and lowest eigenfrequencies by subspace iteration.

use crate::assembly::tie::Reduced;
use crate::element::natural_corner;
use crate::mesh::{ElementKind, Mesh};
use crate::solve::Cholesky;
use faer::sparse::SparseColMat;
use faer::{Mat, Par};
use gearbench_models::Vec3;
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// A box from the origin, cut into equal cells; nodes ascend along z first, x last.
pub fn brick(kind: ElementKind, cells: [usize; 3], size: [f64; 3]) -> Mesh {
    let points = cells.map(|c| 2 * c + 1);
    let at = |i: [usize; 3]| (i[0] * points[1] + i[1]) * points[2] + i[2];
    let mut number = vec![u32::MAX; points.iter().product()];
    let mut nodes = Vec::new();
    for x in 0..points[0] {
        for y in 0..points[1] {
            for z in 0..points[2] {
                let odd = x % 2 + y % 2 + z % 2;
                if odd == 0 || (odd == 1 && kind.nodes() == 20) {
                    number[at([x, y, z])] = nodes.len() as u32;
                    let part = |i: usize, k: usize| size[k] * i as f64 / (points[k] - 1) as f64;
                    nodes.push(Vec3::new(part(x, 0), part(y, 1), part(z, 2)));
                }
            }
        }
    }
    let mut connectivity = Vec::new();
    for x in 0..cells[0] {
        for y in 0..cells[1] {
            for z in 0..cells[2] {
                connectivity.extend((0..kind.nodes()).map(|a| {
                    let n = natural_corner(a).map(|c| (c + 1.0) as usize);
                    number[at([2 * x + n[0], 2 * y + n[1], 2 * z + n[2]])]
                }));
            }
        }
    }
    Mesh {
        nodes,
        kind,
        connectivity,
        node_sets: BTreeMap::new(),
        face_sets: BTreeMap::new(),
    }
}

/// Nodes that fulfil a condition.
pub fn nodes_where(mesh: &Mesh, condition: impl Fn(&Vec3) -> bool) -> Vec<u32> {
    (0..mesh.nodes.len() as u32)
        .filter(|&i| condition(&mesh.nodes[i as usize]))
        .collect()
}

/// Largest absolute value.
pub fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// `A x` of a lower triangle.
pub fn product(a: &SparseColMat<usize, f64>, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    for j in 0..a.ncols() {
        for (i, v) in a.row_idx_of_col(j).zip(a.val_of_col(j)) {
            y[i] += v * x[j];
            if i != j {
                y[j] += v * x[i];
            }
        }
    }
    y
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The lowest eigenfrequencies [Hz] of a held body, ascending, by subspace iteration (K.-J. Bathe, *Finite
/// Element Procedures*, ch. 11); each is accepted only by its true residual.
pub fn frequencies(reduced: &Reduced, count: usize) -> Vec<f64> {
    let (k, m) = (&reduced.stiffness, &reduced.mass);
    let (n, width) = (k.ncols(), 2 * count + 4);
    assert!(width < n);
    let factor = Cholesky::new(k.as_ref()).unwrap();
    let mut basis: Vec<Vec<f64>> = (0..width)
        .map(|c| {
            (0..n)
                .map(|i| (1.0 + (i * (2 * c + 3)) as f64 * 0.618).sin())
                .collect()
        })
        .collect();
    for _ in 0..60 {
        let mut y = Mat::zeros(n, width);
        for (c, x) in basis.iter().enumerate() {
            for (i, f) in product(m, x).into_iter().enumerate() {
                y[(i, c)] = f;
            }
        }
        factor.solve_many(y.as_mut(), Par::Seq);
        // Orthonormal in the mass, twice for rounding.
        let mut done: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        for c in 0..width {
            let mut x: Vec<f64> = (0..n).map(|i| y[(i, c)]).collect();
            for _ in 0..2 {
                for (q, mq) in &done {
                    let part = dot(mq, &x);
                    x.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
                }
            }
            let size = dot(&x, &product(m, &x)).sqrt();
            x.iter_mut().for_each(|x| *x /= size);
            let mx = product(m, &x);
            done.push((x, mx));
        }
        let images: Vec<Vec<f64>> = done.iter().map(|(q, _)| product(k, q)).collect();
        let ritz = DMatrix::from_fn(width, width, |i, j| dot(&done[i].0, &images[j]));
        let eigen = ((&ritz + ritz.transpose()) * 0.5).symmetric_eigen();
        let mut order: Vec<usize> = (0..width).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        let turned = |of: &dyn Fn(usize) -> Vec<f64>, c: usize| {
            let mut x = vec![0.0; n];
            for i in 0..width {
                let part = eigen.eigenvectors[(i, order[c])];
                x.iter_mut().zip(of(i)).for_each(|(x, q)| *x += part * q);
            }
            x
        };
        basis = (0..width)
            .map(|c| turned(&|i| done[i].0.clone(), c))
            .collect();
        let converged = basis.iter().take(count).enumerate().all(|(c, x)| {
            let (kx, mx) = (product(k, x), product(m, x));
            let value = eigen.eigenvalues[order[c]];
            let left: f64 = kx
                .iter()
                .zip(&mx)
                .map(|(k, m)| (k - value * m).powi(2))
                .sum();
            left.sqrt() < 1e-6 * dot(&kx, &kx).sqrt()
        });
        if converged {
            return (0..count)
                .map(|c| eigen.eigenvalues[order[c]].sqrt() / std::f64::consts::TAU)
                .collect();
        }
    }
    panic!("subspace iteration did not settle");
}
