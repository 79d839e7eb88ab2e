//! Boxes of elements.

use super::{ElementKind, Mesh, Shape};
use crate::Vec3;
use crate::element::natural;

/// Nodes of the elements that make up a cell, in steps of half an edge: two wedges, or six tetrahedra about a
/// diagonal (H. W. Kuhn 1960).
fn of_cell(kind: ElementKind) -> Vec<Vec<[usize; 3]>> {
    let whole = |corners: Vec<[usize; 3]>| -> Vec<[usize; 3]> {
        let edges = kind.edges().iter().take(kind.nodes() - kind.corners());
        let middles = edges.map(|&[a, b]| [0, 1, 2].map(|i| (corners[a][i] + corners[b][i]) / 2));
        let middles: Vec<[usize; 3]> = middles.collect();
        corners.into_iter().chain(middles).collect()
    };
    let at = |x: usize, y: usize, z: usize| [2 * x, 2 * y, 2 * z];
    match kind.shape() {
        Shape::Hexahedron => {
            let nodes = (0..kind.nodes()).map(|a| natural(kind, a).map(|c| (c + 1.0) as usize));
            vec![nodes.collect()]
        }
        Shape::Wedge => [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]]
            .map(|t| {
                let layer = |z| t.map(|[x, y]| at(x, y, z));
                whole(layer(0).into_iter().chain(layer(1)).collect())
            })
            .into(),
        Shape::Tetrahedron => [
            [0, 1, 2],
            [1, 2, 0],
            [2, 0, 1],
            [0, 2, 1],
            [1, 0, 2],
            [2, 1, 0],
        ]
        .iter()
        .enumerate()
        .map(|(i, order)| {
            let mut corners = vec![[0; 3]];
            for &axis in order {
                let mut next = corners[corners.len() - 1];
                next[axis] = 2;
                corners.push(next);
            }
            if i >= 3 {
                corners.swap(1, 2);
            }
            whole(corners)
        })
        .collect(),
    }
}

/// Meshes a box from the origin to `size` [m], cut into equal cells: one hexahedron, two wedges or six tetrahedra each.
/// Node numbers ascend along z first and along x last.
pub fn brick(kind: ElementKind, cells: [usize; 3], size: [f64; 3]) -> Mesh {
    let points = cells.map(|c| 2 * c + 1);
    let at = |i: [usize; 3]| (i[0] * points[1] + i[1]) * points[2] + i[2];
    let mut used = vec![false; points.iter().product()];
    let of_cell = of_cell(kind);
    let mut elements = Vec::new();
    for x in 0..cells[0] {
        for y in 0..cells[1] {
            for z in 0..cells[2] {
                elements.extend(of_cell.iter().flatten().map(|n| {
                    let place = at([2 * x + n[0], 2 * y + n[1], 2 * z + n[2]]);
                    used[place] = true;
                    place
                }));
            }
        }
    }
    let mut number = vec![u32::MAX; used.len()];
    let mut nodes = Vec::new();
    for x in 0..points[0] {
        for y in 0..points[1] {
            for z in 0..points[2] {
                if used[at([x, y, z])] {
                    number[at([x, y, z])] = nodes.len() as u32;
                    let part = |i: usize, k: usize| size[k] * i as f64 / (points[k] - 1) as f64;
                    nodes.push(Vec3::new(part(x, 0), part(y, 1), part(z, 2)));
                }
            }
        }
    }
    let connectivity = elements.into_iter().map(|place| number[place]);
    Mesh::new(kind, nodes, connectivity.collect())
}
