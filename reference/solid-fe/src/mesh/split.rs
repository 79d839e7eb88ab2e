//! Division of hexahedra into tetrahedra, as a substitute for other mesh generators on the same body.

use super::{ElementKind, Mesh};
use crate::element::{MAX_NODES, natural, values};
use std::collections::HashMap;

/// A mesh of hexahedra of 20 nodes cut into tetrahedra of 10, six for each; `None` for other elements. Sets are left out.
///
/// From the node with the smallest number of each element to the triangles of the three faces that do not have it, which
/// are cut from their own smallest: neighbours cut a common face alike (J. Dompierre et al., *How to subdivide pyramids,
/// prisms and hexahedra into tetrahedra*, 8th International Meshing Roundtable, 1999). New mid-side nodes stand on the
/// quadratic faces.
pub fn tetrahedra(mesh: &Mesh) -> Option<Mesh> {
    let kind = mesh.kind()?;
    if kind.nodes() != 20 {
        return None;
    }
    let mut nodes = mesh.nodes.clone();
    let mut middles = HashMap::new();
    let mut connectivity = Vec::with_capacity(60 * mesh.element_count());
    let key = |a: u32, b: u32| (a.min(b), a.max(b));
    for element in mesh.elements() {
        for (edge, &mid) in kind.edges().iter().zip(&element[8..]) {
            let [a, b] = edge.map(|c| element[c]);
            middles.insert(key(a, b), mid);
        }
    }
    for element in mesh.elements() {
        let first = (0..8).min_by_key(|&c| element[c])?;
        for face in kind.faces().iter().filter(|f| !f.contains(&first)) {
            let low = (0..4).min_by_key(|&i| element[face[i]])?;
            let at = |i: usize| face[(low + i) % 4];
            for triangle in [[at(0), at(1), at(2)], [at(0), at(2), at(3)]] {
                // Faces look inwards, towards the first node.
                let corners = [triangle[0], triangle[1], triangle[2], first];
                connectivity.extend(corners.map(|c| element[c]));
                for edge in ElementKind::C3D10.edges() {
                    let [a, b] = edge.map(|c| corners[c]);
                    let mid = middles
                        .entry(key(element[a], element[b]))
                        .or_insert_with(|| {
                            let (p, q) = (natural(kind, a), natural(kind, b));
                            let mut weights = [0.0; MAX_NODES];
                            let middle = [0, 1, 2].map(|i| 0.5 * (p[i] + q[i]));
                            values(kind, middle, &mut weights);
                            let place = element.iter().zip(weights);
                            nodes.push(place.map(|(&n, w)| w * mesh.nodes[n as usize]).sum());
                            nodes.len() as u32 - 1
                        });
                    connectivity.push(*mid);
                }
            }
        }
    }
    Some(Mesh::new(ElementKind::C3D10, nodes, connectivity))
}
