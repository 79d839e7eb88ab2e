//! The surface of a body: faces of elements that no other element shares, with outward normals and areas.

use crate::groups::Groups;
use crate::mesh::{self, Block, Face};
use gearbench_models::Vec3;

/// Most nodes of a face: four corners and as many mid-side nodes.
const MOST: usize = 8;

/// A face at the surface: corners in order around it, then the mid-side node of each side, if it has any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// Whose face it is.
    pub face: Face,
    nodes: [u32; MOST],
    sides: u8,
    mid_sides: bool,
}

impl Facet {
    /// A face from its corners, 3 or 4, and its mid-side nodes: none, or the one between corner `i` and `i + 1` at
    /// place `i`. `None` for other numbers of nodes.
    pub fn new(face: Face, corners: &[u32], mids: &[u32]) -> Option<Self> {
        let sides = corners.len();
        if !(3..=4).contains(&sides) || !(mids.is_empty() || mids.len() == sides) {
            return None;
        }
        let mut nodes = [u32::MAX; MOST];
        nodes[..sides].copy_from_slice(corners);
        nodes[sides..sides + mids.len()].copy_from_slice(mids);
        Some(Facet {
            face,
            nodes,
            sides: sides as u8,
            mid_sides: !mids.is_empty(),
        })
    }

    /// Corners in order around the face.
    pub fn corners(&self) -> &[u32] {
        &self.nodes[..self.sides as usize]
    }

    /// Mid-side nodes, in the order of the sides.
    pub fn mids(&self) -> &[u32] {
        &self.nodes()[self.sides as usize..]
    }

    /// Corners, then mid-side nodes.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.sides as usize * (1 + usize::from(self.mid_sides))]
    }
}

/// The surface of one body.
#[derive(Clone, Debug)]
pub struct Skin<'a> {
    /// Positions of all nodes of the body [m].
    pub nodes: &'a [Vec3],
    /// Faces of the surface.
    pub facets: Vec<Facet>,
    /// Outward unit normal of each face.
    pub normals: Vec<Vec3>,
    /// Area of each face [m^2].
    pub areas: Vec<f64>,
}

impl<'a> Skin<'a> {
    /// The surface made of these faces, each with a point inside its element. Faces without area are left out.
    pub fn new(nodes: &'a [Vec3], faces: impl IntoIterator<Item = (Facet, Vec3)>) -> Self {
        let mut skin = Skin {
            nodes,
            facets: Vec::new(),
            normals: Vec::new(),
            areas: Vec::new(),
        };
        for (facet, inside) in faces {
            let x = |i: usize| nodes[facet.corners()[i % facet.corners().len()] as usize];
            let sides = facet.corners().len();
            // The vector area of the polygon of the corners.
            let area = (1..sides - 1)
                .map(|i| 0.5 * (x(i) - x(0)).cross(&(x(i + 1) - x(0))))
                .sum::<Vec3>();
            let size = area.norm();
            if !(size.is_finite() && size > 0.0) {
                continue;
            }
            let outwards = (x(0) - inside).dot(&area) > 0.0;
            skin.facets.push(facet);
            skin.normals
                .push(if outwards { area / size } else { -area / size });
            skin.areas.push(size);
        }
        skin
    }

    /// The surface of a body of elements.
    pub fn of(nodes: &'a [Vec3], blocks: &[Block]) -> Self {
        let (mut block, mut before) = (0, 0);
        let surface = mesh::boundary(blocks).into_iter();
        Self::new(
            nodes,
            surface.filter_map(|face| {
                // Faces ascend with the elements.
                while face.element as usize - before >= blocks[block].element_count() {
                    before += blocks[block].element_count();
                    block += 1;
                }
                let kind = blocks[block].kind;
                let at = (face.element as usize - before) * kind.nodes();
                let element = &blocks[block].connectivity[at..][..kind.nodes()];
                let sides = kind.faces()[usize::from(face.face)].len();
                let of_face: Vec<u32> = (kind.face_nodes(usize::from(face.face)))
                    .map(|i| element[i])
                    .collect();
                let corners = &element[..kind.corners()];
                let middle = corners.iter().map(|&n| nodes[n as usize]).sum::<Vec3>();
                let facet = Facet::new(face, &of_face[..sides], &of_face[sides..])?;
                Some((facet, middle / corners.len() as f64))
            }),
        )
    }

    /// Corners of all faces, each once, ascending.
    pub fn corner_nodes(&self) -> Vec<u32> {
        let mut seen = vec![false; self.nodes.len()];
        for facet in &self.facets {
            for &n in facet.corners() {
                seen[n as usize] = true;
            }
        }
        let all = 0..self.nodes.len() as u32;
        all.filter(|&n| seen[n as usize]).collect()
    }

    /// Faces that pass `keep`, in groups that hang together by common corners, largest areas first.
    pub fn pieces(&self, keep: impl Fn(usize) -> bool) -> Vec<Vec<u32>> {
        let mut groups = Groups::new(self.nodes.len());
        let kept = (0..self.facets.len() as u32).filter(|&f| keep(f as usize));
        let kept: Vec<u32> = kept.collect();
        for &f in &kept {
            let corners = self.facets[f as usize].corners();
            for &n in &corners[1..] {
                groups.join(corners[0], n);
            }
        }
        let mut number = vec![u32::MAX; self.nodes.len()];
        let mut pieces: Vec<(f64, Vec<u32>)> = Vec::new();
        for f in kept {
            let group = groups.find(self.facets[f as usize].corners()[0]) as usize;
            if number[group] == u32::MAX {
                number[group] = pieces.len() as u32;
                pieces.push((0.0, Vec::new()));
            }
            let piece = &mut pieces[number[group] as usize];
            piece.0 += self.areas[f as usize];
            piece.1.push(f);
        }
        pieces.sort_by(|a, b| b.0.total_cmp(&a.0));
        pieces.into_iter().map(|p| p.1).collect()
    }

    /// Nodes of faces, each once, ascending: corners only, or all.
    pub fn nodes_of(&self, faces: &[u32], all: bool) -> Vec<u32> {
        let of = |f: &u32| {
            let facet = &self.facets[*f as usize];
            if all { facet.nodes() } else { facet.corners() }
        };
        let mut nodes: Vec<u32> = faces.iter().flat_map(of).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}
