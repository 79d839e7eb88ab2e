//! Sets of nodes, products, and lowest eigenfrequencies.

use crate::assembly::tie::Reduced;
use crate::mesh::Mesh;
use crate::modes;
use faer::sparse::SparseColMat;
use gearbench_models::Vec3;

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
    let found = modes::lowest(reduced, count, &modes::Options::default()).unwrap();
    found.frequencies()
}
