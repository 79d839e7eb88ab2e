//! Bricks of any element kind, and lowest eigenfrequencies.

use crate::assembly::tie::Reduced;
use crate::element::natural_corner;
use crate::mesh::{ElementKind, Mesh};
use crate::modes;
use faer::sparse::SparseColMat;
use gearbench_models::Vec3;
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

/// The lowest eigenfrequencies [Hz] of a held body, ascending.
pub fn frequencies(reduced: &Reduced, count: usize) -> Vec<f64> {
    let (k, m) = (reduced.stiffness.as_ref(), reduced.mass.as_ref());
    let found = modes::lowest(k, m, count, &modes::Options::default()).unwrap();
    found.frequencies()
}
