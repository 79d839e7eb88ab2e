//! Sets of nodes, and lowest eigenfrequencies.

use crate::Vec3;
use crate::assembly::tie::Reduced;
use crate::mesh::Mesh;
use crate::modes;

/// Nodes that fulfil a condition.
pub fn nodes_where(mesh: &Mesh, condition: impl Fn(&Vec3) -> bool) -> Vec<u32> {
    (0..mesh.nodes.len() as u32)
        .filter(|&i| condition(&mesh.nodes[i as usize]))
        .collect()
}

/// Returns the lowest eigenfrequencies [Hz] of a supported body, ascending.
pub fn frequencies(reduced: &Reduced, count: usize) -> Vec<f64> {
    let found = modes::lowest(reduced, count, &modes::Options::default()).unwrap();
    found.frequencies()
}
