//! How good the elements of a mesh are.
//!
//! The scaled Jacobian of an element is the least, over its corners, of `det J / (|J_1| |J_2| |J_3|)` with the
//! columns `J_i` of the Jacobian along the edges of the corner: 1 for a box, 0 for a flat corner (P. M. Knupp,
//! *Algebraic mesh quality metrics*, SIAM J. Sci. Comput. 23, 2001). Wedges and tetrahedra are scaled so that those
//! of equal edges have 1. The sign is also tested at the
//! element's integration points: corners alone do not bound the inside of a curved element.

use super::{ElementKind, Mesh, Shape};
use crate::Vec3;
use crate::element::{Point, natural, solid_rule};

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
    /// Volume of the element [m^3].
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

/// Quality test of elements of one kind, prepared once.
pub struct ElementCheck {
    kind: ElementKind,
    corners: Vec<Corner>,
    integration: Vec<Point>,
}

/// A corner: shape functions there, and the natural directions of its three edges, if they are not the axes.
struct Corner {
    point: Point,
    edges: Option<[[f64; 3]; 3]>,
}

impl Corner {
    fn new(kind: ElementKind, corner: usize) -> Self {
        let at = natural(kind, corner);
        let edges = match kind.shape() {
            Shape::Hexahedron => None,
            Shape::Wedge | Shape::Tetrahedron => {
                let mut edges = [[0.0; 3]; 3];
                let own = kind.edges().iter().filter(|e| e.contains(&corner));
                for (edge, ends) in edges.iter_mut().zip(own) {
                    let other = natural(kind, if ends[0] == corner { ends[1] } else { ends[0] });
                    *edge = [0, 1, 2].map(|i| other[i] - at[i]);
                }
                // Right-handed, as the axes are.
                let [a, b, c] = edges.map(Vec3::from);
                if a.cross(&b).dot(&c) < 0.0 {
                    edges.swap(0, 1);
                }
                Some(edges)
            }
        };
        Corner {
            point: Point::new(kind, at, 0.0),
            edges,
        }
    }

    /// Jacobian along the edges.
    fn jacobian(&self, nodes: &[Vec3]) -> [Vec3; 3] {
        let j = jacobian(&self.point, nodes);
        match &self.edges {
            None => j,
            Some(edges) => edges.map(|e| j[0] * e[0] + j[1] * e[1] + j[2] * e[2]),
        }
    }
}

impl ElementCheck {
    /// Prepares the corners and the integration points of a kind.
    pub fn new(kind: ElementKind) -> Self {
        let integration = solid_rule(kind).into_iter();
        let integration = integration.map(|(xi, weight)| Point::new(kind, xi, weight));
        let corners = (0..kind.corners()).map(|c| Corner::new(kind, c));
        ElementCheck {
            kind,
            corners: corners.collect(),
            integration: integration.collect(),
        }
    }

    /// Returns the quality of an element with these nodes.
    pub fn element(&self, nodes: &[Vec3]) -> ElementQuality {
        let mut least = f64::INFINITY;
        for c in &self.corners {
            let s = scaled(c.jacobian(nodes));
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
        // An equal-sided element has 1.
        least *= match self.kind.shape() {
            Shape::Hexahedron => 1.0,
            Shape::Wedge => 2.0 / 3.0_f64.sqrt(),
            Shape::Tetrahedron => 2.0_f64.sqrt(),
        };
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        for &[a, b] in self.kind.edges() {
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
    mesh.blocks.iter().flat_map(move |block| {
        let check = ElementCheck::new(block.kind);
        let mut nodes = Vec::with_capacity(block.kind.nodes());
        block.elements().map(move |e| {
            nodes.clear();
            nodes.extend(e.iter().map(|&n| mesh.nodes[n as usize]));
            check.element(&nodes)
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::brick;

    /// An equilateral tetrahedron and wedge have quality 1, a flat corner 0, an inverted one less; volumes are exact.
    #[test]
    fn wedges_and_tetrahedra_are_measured_as_hexahedra_are() {
        let h = 0.75_f64.sqrt();
        let triangle = [
            Vec3::zeros(),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.5, h, 0.0),
        ];
        let above = triangle.map(|x| x + Vec3::z());
        let top = Vec3::new(0.5, h / 3.0, (2.0_f64 / 3.0).sqrt());
        let wedge: Vec<Vec3> = triangle.into_iter().chain(above).collect();
        let tetrahedron: Vec<Vec3> = triangle.into_iter().chain([top]).collect();
        for (kind, nodes, volume) in [
            (ElementKind::C3D6, wedge, 0.5 * h),
            (ElementKind::C3D4, tetrahedron, 0.5 * h * top.z / 3.0),
        ] {
            let numbers = (0..nodes.len() as u32).collect();
            let q = quality(&Mesh::new(kind, nodes.clone(), numbers));
            assert!(
                (q.min_scaled_jacobian - 1.0).abs() < 1e-14,
                "{kind:?} {q:?}"
            );
            assert!((q.volume / volume - 1.0).abs() < 1e-14);
            let mut turned = nodes;
            turned.swap(0, 1);
            if kind == ElementKind::C3D6 {
                turned.swap(3, 4);
            }
            let numbers = (0..turned.len() as u32).collect();
            let q = quality(&Mesh::new(kind, turned, numbers));
            assert!(q.min_scaled_jacobian < 0.0, "{kind:?}");
        }
    }

    #[test]
    fn a_box_has_its_volume_and_moment_whatever_the_elements() {
        let [a, b, c] = [3.0, 2.0, 1.5];
        for kind in ElementKind::ALL {
            let q = quality(&brick(kind, [3, 2, 1], [a, b, c]));
            assert!((q.volume / (a * b * c) - 1.0).abs() < 1e-14, "{kind:?}");
            let moment = a * b * c * (a * a + b * b) / 3.0;
            assert!((q.polar_moment / moment - 1.0).abs() < 1e-14, "{kind:?}");
            assert!(q.min_scaled_jacobian > 0.2, "{kind:?} {q:?}");
        }
    }
}
