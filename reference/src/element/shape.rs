//! Shape functions of hexahedra, node order of Abaqus and CalculiX: corners of the lower and the upper face
//! counter-clockwise, then mid-side nodes below, above and between.

use crate::mesh::ElementKind;

/// Most nodes an element has.
pub const MAX_NODES: usize = 20;

/// Natural coordinates of the nodes; those of corners are +-1, of mid-side nodes one is 0.
const NODES: [[f64; 3]; MAX_NODES] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

/// Natural coordinates of a node.
pub fn natural_corner(node: usize) -> [f64; 3] {
    NODES[node]
}

/// Values of the shape functions at a point.
pub fn values(kind: ElementKind, xi: [f64; 3], out: &mut [f64; MAX_NODES]) {
    for (a, node) in NODES.iter().enumerate().take(kind.nodes()) {
        out[a] = shape(kind, node, xi).0;
    }
}

/// Gradients of the shape functions by the natural coordinates at a point.
pub fn gradients(kind: ElementKind, xi: [f64; 3], out: &mut [[f64; 3]; MAX_NODES]) {
    for (a, node) in NODES.iter().enumerate().take(kind.nodes()) {
        out[a] = shape(kind, node, xi).1;
    }
}

/// Value and gradient of one node's function.
fn shape(kind: ElementKind, node: &[f64; 3], xi: [f64; 3]) -> (f64, [f64; 3]) {
    // Per axis: 1 + xi xi_a at a corner side, 1 - xi^2 at the middle; and the slopes.
    let mut f = [0.0; 3];
    let mut slope = [0.0; 3];
    for i in 0..3 {
        if node[i] == 0.0 {
            f[i] = 1.0 - xi[i] * xi[i];
            slope[i] = -2.0 * xi[i];
        } else {
            f[i] = 1.0 + xi[i] * node[i];
            slope[i] = node[i];
        }
    }
    let product = f[0] * f[1] * f[2];
    let d = [
        slope[0] * f[1] * f[2],
        f[0] * slope[1] * f[2],
        f[0] * f[1] * slope[2],
    ];
    if kind.nodes() == 8 {
        return (product / 8.0, d.map(|d| d / 8.0));
    }
    if node.contains(&0.0) {
        return (product / 4.0, d.map(|d| d / 4.0));
    }
    let sum = xi[0] * node[0] + xi[1] * node[1] + xi[2] * node[2] - 2.0;
    let gradient = std::array::from_fn(|i| (d[i] * sum + product * node[i]) / 8.0);
    (product * sum / 8.0, gradient)
}
