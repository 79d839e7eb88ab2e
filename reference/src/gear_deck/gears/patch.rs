//! Recognition of the faces of a flank as a structured grid, from their adjacency.

use super::decline;
use crate::deck::{Deck, DeckError, DeckErrorKind};
use crate::mesh::{self, Block, ElementKind, Face, FaceCorners};
use std::collections::HashMap;

/// A face with its corner nodes, in local numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Quad {
    pub(super) face: Face,
    pub(super) corners: [u32; 4],
}

impl Quad {
    /// A face of an element with these nodes, if it has four corners.
    pub(super) fn of(face: Face, kind: ElementKind, nodes: &[u32]) -> Option<Self> {
        let corners = FaceCorners::of(kind, usize::from(face.face), nodes);
        let corners: [u32; 4] = (*corners).try_into().ok()?;
        Some(Quad { face, corners })
    }
}

/// A structured patch: rows from the root to the tip, columns from -z to +z.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    /// Set it came from.
    pub(super) set: String,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Nodes of the grid, row by row.
    pub(super) nodes: Vec<u32>,
    /// Faces of the grid, row by row.
    pub(super) faces: Vec<Face>,
    /// Whole node set with its mid-side nodes, if the grid came from one.
    pub(super) members: Option<Vec<u32>>,
}

/// Returns the quadrilaterals that belong to one element only.
pub(super) fn boundary(blocks: &[Block]) -> Vec<Quad> {
    let surface = mesh::boundary(blocks);
    let (mut block, mut before) = (0, 0);
    let quad = |face: Face| {
        // Faces ascend with the elements.
        let mut at = face.element as usize - before;
        while at >= blocks[block].element_count() {
            before += blocks[block].element_count();
            block += 1;
            at = face.element as usize - before;
        }
        let Block { kind, connectivity } = &blocks[block];
        Quad::of(face, *kind, &connectivity[at * kind.nodes()..])
    };
    surface.into_iter().filter_map(quad).collect()
}

/// Lays faces out as a grid; `members` is the node set it came from and how many corners of elements it has. `height` grows from the root to the tip, `z` over the width.
pub(super) fn grid(
    deck: &Deck,
    set: &str,
    quads: &[Quad],
    members: Option<&(Vec<u32>, usize)>,
    height: &dyn Fn(u32) -> f64,
    z: &dyn Fn(u32) -> f64,
) -> Result<Grid, DeckError> {
    let grid = lay_out(set, quads, height, z).and_then(|mut grid| match members {
        Some((_, n)) if *n != grid.nodes.len() => {
            Err(format!("{} of {n} nodes in its faces", grid.nodes.len()))
        }
        Some((members, _)) => {
            grid.members = Some(members.clone());
            Ok(grid)
        }
        None => Ok(grid),
    });
    grid.map_err(|found| DeckError {
        kind: DeckErrorKind::Grid,
        ..decline(
            deck,
            set,
            "a structured grid of faces, rows along the profile and columns over the width",
            found,
            "mesh the flank with rows of quadrilaterals and put all nodes of the flank, and no others, in its set",
        )
    })
}

fn lay_out(
    set: &str,
    quads: &[Quad],
    height: &dyn Fn(u32) -> f64,
    z: &dyn Fn(u32) -> f64,
) -> Result<Grid, String> {
    if quads.is_empty() {
        return Err("no face at the surface with all corners in the set".into());
    }
    // Faces at each node, and how many faces have each edge: boundary edges have one.
    let mut at: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    for (i, q) in quads.iter().enumerate() {
        for k in 0..4 {
            let (a, b) = (q.corners[k], q.corners[(k + 1) % 4]);
            at.entry(a).or_default().push(i as u32);
            *edges.entry((a.min(b), a.max(b))).or_default() += 1;
        }
    }
    let mut rim: HashMap<u32, Vec<u32>> = HashMap::new();
    for (&(a, b), &count) in &edges {
        if count == 1 {
            rim.entry(a).or_default().push(b);
            rim.entry(b).or_default().push(a);
        }
    }
    let mut corners: Vec<u32> = at
        .iter()
        .filter(|(_, faces)| faces.len() == 1)
        .map(|(&n, _)| n)
        .collect();
    if corners.len() != 4 {
        return Err(format!(
            "{} faces with {} corners instead of 4",
            quads.len(),
            corners.len()
        ));
    }
    // Two corners at -z; the lower of them starts. Ties are settled by number so that the result is one.
    corners.sort_unstable();
    corners.sort_by(|&a, &b| z(a).total_cmp(&z(b)));
    corners[..2].sort_by(|&a, &b| height(a).total_cmp(&height(b)));
    let (start, tip) = (corners[0], corners[1]);
    let walk = |next: u32| -> Option<Vec<u32>> {
        let mut chain = vec![start, next];
        while !corners.contains(&chain[chain.len() - 1]) {
            let (before, here) = (chain[chain.len() - 2], chain[chain.len() - 1]);
            let neighbours = rim.get(&here)?;
            if neighbours.len() != 2 || chain.len() > at.len() {
                return None;
            }
            chain.push(neighbours[usize::from(neighbours[0] == before)]);
        }
        Some(chain)
    };
    let starts = rim.get(&start).filter(|s| s.len() == 2);
    let broken = || "a rim that branches".to_owned();
    let starts = starts.ok_or_else(broken)?;
    let one = walk(starts[0]).ok_or_else(broken)?;
    let other = walk(starts[1]).ok_or_else(broken)?;
    let (profile, width) = if one[one.len() - 1] == tip {
        (one, other)
    } else {
        (other, one)
    };
    let (rows, columns) = (profile.len(), width.len());
    if profile[rows - 1] != tip
        || (rows - 1) * (columns - 1) != quads.len()
        || rows * columns != at.len()
    {
        return Err(format!(
            "{} faces with sides of {} and {}",
            quads.len(),
            rows - 1,
            columns - 1
        ));
    }
    let mut nodes = vec![u32::MAX; rows * columns];
    for (r, &n) in profile.iter().enumerate() {
        nodes[r * columns] = n;
    }
    nodes[..columns].copy_from_slice(&width);
    let mut used = vec![false; quads.len()];
    let mut faces = Vec::with_capacity(quads.len());
    for r in 1..rows {
        for c in 1..columns {
            let three = [
                nodes[(r - 1) * columns + c - 1],
                nodes[(r - 1) * columns + c],
                nodes[r * columns + c - 1],
            ];
            let face = at[&three[0]].iter().copied().find(|&i| {
                !used[i as usize] && three.iter().all(|n| quads[i as usize].corners.contains(n))
            });
            let Some(i) = face else {
                return Err(format!("no face at row {r}, column {c}"));
            };
            let quad = &quads[i as usize];
            let Some(&last) = quad.corners.iter().find(|n| !three.contains(n)) else {
                return Err("a face with a corner twice".into());
            };
            used[i as usize] = true;
            let known = &mut nodes[r * columns + c];
            if *known != u32::MAX && *known != last {
                return Err(format!("rows without a common node at row {r}, column {c}"));
            }
            *known = last;
            faces.push(quad.face);
        }
    }
    let mut all = nodes.clone();
    all.sort_unstable();
    if all.windows(2).any(|w| w[0] == w[1]) {
        return Err("a node twice in the grid".into());
    }
    Ok(Grid {
        set: set.to_owned(),
        rows,
        columns,
        nodes,
        faces,
        members: None,
    })
}
