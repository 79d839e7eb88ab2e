//! Shape functions of hexahedra, wedges and tetrahedra, in the node order of [`crate::mesh::ElementKind`].
//!
//! Natural coordinates: of hexahedra from -1 to 1; of wedges two area coordinates from 0, the third from -1 to 1;
//! of tetrahedra three volume coordinates from 0. Node 0 of the last two stands where those are 0.

use crate::mesh::{ElementKind, Shape};

/// Most nodes an element has.
pub const MAX_NODES: usize = 20;

/// Natural coordinates of the nodes of hexahedra: +-1 at corners, with one 0 at mid-side nodes.
const HEXAHEDRON: [[f64; 3]; MAX_NODES] = [
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

/// Natural coordinates of the corners of wedges.
const WEDGE: [[f64; 3]; 6] = [
    [0.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
];

/// Natural coordinates of the corners of tetrahedra.
const TETRAHEDRON: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
];

/// Natural coordinates of a node.
///
/// # Panics
/// If the kind has no such node.
pub fn natural(kind: ElementKind, node: usize) -> [f64; 3] {
    let corners: &[[f64; 3]] = match kind.shape() {
        Shape::Hexahedron => return HEXAHEDRON[node],
        Shape::Wedge => &WEDGE,
        Shape::Tetrahedron => &TETRAHEDRON,
    };
    match node.checked_sub(corners.len()) {
        None => corners[node],
        Some(edge) => {
            let [a, b] = kind.edges()[edge].map(|n| corners[n]);
            [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]))
        }
    }
}

/// Values of the shape functions at a point.
pub fn values(kind: ElementKind, xi: [f64; 3], out: &mut [f64; MAX_NODES]) {
    for (a, out) in out.iter_mut().enumerate().take(kind.nodes()) {
        *out = shape(kind, a, xi).0;
    }
}

/// Gradients of the shape functions by the natural coordinates at a point.
pub fn gradients(kind: ElementKind, xi: [f64; 3], out: &mut [[f64; 3]; MAX_NODES]) {
    for (a, out) in out.iter_mut().enumerate().take(kind.nodes()) {
        *out = shape(kind, a, xi).1;
    }
}

/// Returns value and gradient of the shape function of one node.
fn shape(kind: ElementKind, node: usize, xi: [f64; 3]) -> (f64, [f64; 3]) {
    match kind.shape() {
        Shape::Hexahedron => hexahedron(kind, &HEXAHEDRON[node], xi),
        Shape::Wedge => wedge(kind, node, xi),
        Shape::Tetrahedron => tetrahedron(kind, node, xi),
    }
}

fn hexahedron(kind: ElementKind, node: &[f64; 3], xi: [f64; 3]) -> (f64, [f64; 3]) {
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

/// Area or volume coordinates with their slopes, the one of node 0 first: `1 - sum`, then the natural ones.
fn barycentric<const N: usize>(xi: [f64; 3]) -> [(f64, [f64; 3]); N] {
    std::array::from_fn(|i| match i {
        0 => {
            let sum: f64 = xi[..N - 1].iter().sum();
            (
                1.0 - sum,
                std::array::from_fn(|k| if k < N - 1 { -1.0 } else { 0.0 }),
            )
        }
        i => (
            xi[i - 1],
            std::array::from_fn(|k| f64::from(u8::from(k == i - 1))),
        ),
    })
}

/// `a b` with its gradient.
fn times((a, da): (f64, [f64; 3]), (b, db): (f64, [f64; 3])) -> (f64, [f64; 3]) {
    (a * b, std::array::from_fn(|i| da[i] * b + a * db[i]))
}

/// Of volume coordinates `L`: linear `L_a`; quadratic `L_a (2 L_a - 1)` at corners, `4 L_a L_b` between.
fn tetrahedron(kind: ElementKind, node: usize, xi: [f64; 3]) -> (f64, [f64; 3]) {
    let l = barycentric::<4>(xi);
    if node < 4 {
        let (value, slope) = l[node];
        return match kind.is_quadratic() {
            false => l[node],
            true => times(l[node], (2.0 * value - 1.0, slope.map(|s| 2.0 * s))),
        };
    }
    let [a, b] = kind.edges()[node - 4];
    let (value, slope) = times(l[a], l[b]);
    (4.0 * value, slope.map(|s| 4.0 * s))
}

/// Of area coordinates `T` and `s = +-1`, the side of the node: linear `T (1 + s z) / 2`; quadratic
/// `T (1 + s z) (2 T - 2 + s z) / 2` at corners, `2 T_a T_b (1 + s z)` and `T (1 - z^2)` between.
fn wedge(kind: ElementKind, node: usize, xi: [f64; 3]) -> (f64, [f64; 3]) {
    let t = barycentric::<3>(xi);
    let z = xi[2];
    let half = |side: f64| (0.5 * (1.0 + side * z), [0.0, 0.0, 0.5 * side]);
    let side = |node: usize| if node < 3 { -1.0 } else { 1.0 };
    if node < 6 {
        let s = side(node);
        let (value, slope) = t[node % 3];
        let linear = times(t[node % 3], half(s));
        if !kind.is_quadratic() {
            return linear;
        }
        let factor = (
            2.0 * value - 2.0 + s * z,
            [2.0 * slope[0], 2.0 * slope[1], s],
        );
        return times(linear, factor);
    }
    let [a, b] = kind.edges()[node - 6];
    if side(a) == side(b) {
        let (value, slope) = times(times(t[a % 3], t[b % 3]), half(side(a)));
        (4.0 * value, slope.map(|s| 4.0 * s))
    } else {
        times(t[a], (1.0 - z * z, [0.0, 0.0, -2.0 * z]))
    }
}
