//! How good the elements of a mesh are.
//!
//! The scaled Jacobian of an element is the least, over its corners, of `det J / (|J_1| |J_2| |J_3|)` with the
//! columns `J_i` of the Jacobian of the map from the reference cube: 1 for a box, 0 for a flat corner (P. M.
//! Knupp, *Algebraic mesh quality metrics*, SIAM J. Sci. Comput. 23, 2001). The sign is also tested at the
//! element's integration points: corners alone do not bound the inside of a curved element.

use super::{EDGES, ElementKind, Mesh};
use crate::element::{Point, THREE, TWO, natural_corner, rule};
use gearbench_models::Vec3;

/// Quality of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Least scaled Jacobian; above 0 when every element is sound.
    pub min_scaled_jacobian: f64,
    /// Mean over the elements.
    pub mean_scaled_jacobian: f64,
    /// The element with the least.
    pub worst_element: usize,
    /// Greatest ratio of the longest to the shortest edge of an element.
    pub max_aspect_ratio: f64,
    /// The element with that ratio.
    pub longest_element: usize,
    /// Volume of all elements [m^3].
    pub volume: f64,
    /// Polar moment of the volume about the z axis [m^5]: times the density, the moment of inertia.
    pub polar_moment: f64,
}

/// Quality of one element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementQuality {
    /// Scaled Jacobian; where the Jacobian is not positive at an integration point, its value there if smaller.
    pub scaled_jacobian: f64,
    /// Longest over shortest edge.
    pub aspect_ratio: f64,
    /// Volume [m^3].
    pub volume: f64,
    /// Its polar moment about the z axis [m^5].
    pub polar_moment: f64,
}

/// Columns of the Jacobian.
fn jacobian(at: &Point, nodes: &[Vec3]) -> [Vec3; 3] {
    let mut j = [Vec3::zeros(); 3];
    for (x, d) in nodes.iter().zip(&at.gradients) {
        for k in 0..3 {
            j[k] += x * d[k];
        }
    }
    j
}

fn scaled([a, b, c]: [Vec3; 3]) -> f64 {
    a.cross(&b).dot(&c) / (a.norm() * b.norm() * c.norm())
}

/// Tests elements of one kind.
pub(super) struct ElementCheck {
    corners: Vec<Point>,
    integration: Vec<Point>,
}

impl ElementCheck {
    pub(super) fn new(kind: ElementKind) -> Self {
        let line: &[_] = match kind {
            ElementKind::C3D8 | ElementKind::C3D8I => &TWO,
            ElementKind::C3D20 | ElementKind::C3D20R => &THREE,
        };
        let integration = rule(line).map(|(xi, weight)| Point::new(kind, xi, weight));
        let corners = (0..8).map(|c| Point::new(kind, natural_corner(c), 0.0));
        ElementCheck {
            corners: corners.collect(),
            integration: integration.collect(),
        }
    }

    pub(super) fn element(&self, nodes: &[Vec3]) -> ElementQuality {
        let mut least = f64::INFINITY;
        for c in &self.corners {
            let s = scaled(jacobian(c, nodes));
            // `min` would drop a NaN.
            least = if s < least || s.is_nan() { s } else { least };
        }
        let (mut volume, mut polar) = (0.0, 0.0);
        for p in &self.integration {
            let j = jacobian(p, nodes);
            let det = j[0].cross(&j[1]).dot(&j[2]);
            if det.is_nan() || det <= 0.0 {
                let s = scaled(j);
                least = if s < least || s.is_nan() { s } else { least };
            }
            let at: Vec3 = nodes.iter().zip(&p.values).map(|(x, &n)| x * n).sum();
            volume += p.weight * det;
            polar += p.weight * det * (at.x * at.x + at.y * at.y);
        }
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        for [a, b] in EDGES {
            let length = (nodes[a] - nodes[b]).norm();
            shortest = shortest.min(length);
            longest = longest.max(length);
        }
        ElementQuality {
            scaled_jacobian: least,
            aspect_ratio: longest / shortest,
            volume,
            polar_moment: polar,
        }
    }
}

/// Quality of each element in turn.
pub fn element_qualities(mesh: &Mesh) -> impl Iterator<Item = ElementQuality> {
    let check = ElementCheck::new(mesh.kind);
    let mut nodes = Vec::with_capacity(mesh.kind.nodes());
    mesh.elements().map(move |e| {
        nodes.clear();
        nodes.extend(e.iter().map(|&n| mesh.nodes[n as usize]));
        check.element(&nodes)
    })
}

/// Measures every element of a mesh.
pub fn quality(mesh: &Mesh) -> Quality {
    let mut q = Quality {
        min_scaled_jacobian: f64::INFINITY,
        mean_scaled_jacobian: 0.0,
        worst_element: 0,
        max_aspect_ratio: 0.0,
        longest_element: 0,
        volume: 0.0,
        polar_moment: 0.0,
    };
    for (i, found) in element_qualities(mesh).enumerate() {
        if found.scaled_jacobian < q.min_scaled_jacobian || found.scaled_jacobian.is_nan() {
            q.min_scaled_jacobian = found.scaled_jacobian;
            q.worst_element = i;
        }
        if found.aspect_ratio > q.max_aspect_ratio {
            q.max_aspect_ratio = found.aspect_ratio;
            q.longest_element = i;
        }
        q.mean_scaled_jacobian += found.scaled_jacobian;
        q.volume += found.volume;
        q.polar_moment += found.polar_moment;
    }
    q.mean_scaled_jacobian /= mesh.element_count().max(1) as f64;
    q
}
