//! A connected body of a deck, and the mesh of a gear that it becomes.

use super::patch::{Grid, Quad};
use super::{BodyShape, DeckGear, circle, decline, rack, spur};
use crate::deck::data::Deck;
use crate::deck::error::DeckError;
use crate::mesh::{Block, GearMesh, Mesh, flank_set};
use gearbench_models::Vec3;
use gearbench_models::geometry::{FlankGrid, Side};
use gearbench_models::stiffness::Material;
use std::collections::BTreeMap;

/// A flank as the deck names it, in local numbers.
pub(super) struct NamedFlank {
    pub(super) set: String,
    pub(super) label: i64,
    pub(super) side: Side,
    pub(super) quads: Vec<Quad>,
    /// The node set, if it is one, and how many corners of elements it has: all have to lie in the grid.
    pub(super) members: Option<(Vec<u32>, usize)>,
}

/// A flank that was found: its grid, and the tooth by where it stands.
pub(super) struct PlacedFlank {
    pub(super) tooth: u32,
    pub(super) side: Side,
    pub(super) grid: Grid,
}

/// What the placement of a body adds to its mesh.
pub(super) struct Placement {
    pub(super) shape: BodyShape,
    pub(super) teeth: u32,
    pub(super) centre: Vec3,
    pub(super) phase: f64,
    pub(super) flanks: Vec<PlacedFlank>,
    /// Positions in the own frame.
    pub(super) positions: Vec<Vec3>,
}

/// A connected body in local numbers, where the deck has it.
pub(super) struct Body {
    pub(super) name: String,
    pub(super) nodes: Vec<u32>,
    pub(super) elements: Vec<u32>,
    pub(super) positions: Vec<Vec3>,
    pub(super) blocks: Vec<Block>,
    pub(super) bore_set: String,
    pub(super) bore: Vec<u32>,
    pub(super) flanks: Vec<NamedFlank>,
    pub(super) material: Material,
    pub(super) rigid_body: Option<usize>,
}

impl Body {
    /// Corner nodes of the elements, element by element.
    pub(super) fn corners(&self) -> impl Iterator<Item = &[u32]> {
        let corners = |b: &Block| b.kind.corners();
        let blocks = self.blocks.iter();
        blocks.flat_map(move |b| b.elements().map(move |e| &e[..corners(b)]))
    }

    /// Which nodes are corners of elements.
    pub(super) fn corner_nodes(&self) -> Vec<bool> {
        let mut corner = vec![false; self.positions.len()];
        for &n in self.corners().flatten() {
            corner[n as usize] = true;
        }
        corner
    }

    /// Bore nodes at corners of elements: mid-side nodes may lie on chords.
    pub(super) fn bore_corners(&self) -> Vec<u32> {
        let corner = self.corner_nodes();
        let corners = self.bore.iter().copied();
        corners.filter(|&n| corner[n as usize]).collect()
    }

    /// Middle of the width [m].
    pub(super) fn mid_width(&self) -> f64 {
        let z = || self.positions.iter().map(|x| x.z);
        let (low, high) = (z().fold(f64::MAX, f64::min), z().fold(f64::MIN, f64::max));
        super::snapped(0.5 * (low + high), high - low)
    }

    /// The mesh in its own frame.
    pub(super) fn into_gear(self, deck: &Deck) -> Result<DeckGear, DeckError> {
        let bore: Vec<Vec3> = self
            .bore_corners()
            .iter()
            .map(|&n| self.positions[n as usize])
            .collect();
        let mut placement = match circle::shape(&bore) {
            circle::Shape::Circle { centre, radius } => spur::place(&self, deck, centre, radius)?,
            circle::Shape::Plane { normal } => rack::place(&self, deck, normal)?,
            circle::Shape::Neither => {
                return Err(decline(
                    deck,
                    &self.bore_set,
                    "nodes on a circle about z (a gear) or in a plane parallel to z (a rack)",
                    "neither",
                    "z is the axis of rotation: turn the model if it is not",
                ));
            }
        };
        placement
            .flanks
            .sort_by_key(|f| (f.tooth, f.side == Side::Right));
        if let Some(w) = placement
            .flanks
            .windows(2)
            .find(|w| (w[0].tooth, w[0].side) == (w[1].tooth, w[1].side))
        {
            return Err(decline(
                deck,
                &w[1].grid.set,
                "one set for a flank",
                format!("`{}` for the same flank", w[0].grid.set),
                "remove one of them",
            ));
        }
        let mut node_sets = BTreeMap::from([("bore".to_owned(), self.bore.clone())]);
        let mut face_sets = BTreeMap::new();
        let mut flanks = Vec::with_capacity(placement.flanks.len());
        for f in placement.flanks {
            let name = flank_set(f.tooth, f.side);
            face_sets.insert(format!("s{name}"), f.grid.faces);
            let members = f.grid.members.unwrap_or_else(|| f.grid.nodes.clone());
            node_sets.insert(name, members);
            let nodes = f.grid.nodes.iter();
            flanks.push(FlankGrid {
                tooth: f.tooth,
                side: f.side,
                rows: f.grid.rows,
                columns: f.grid.columns,
                positions: nodes.map(|&n| placement.positions[n as usize]).collect(),
                nodes: f.grid.nodes,
            });
        }
        Ok(DeckGear {
            name: self.name,
            shape: placement.shape,
            mesh: GearMesh {
                mesh: Mesh {
                    nodes: placement.positions,
                    blocks: self.blocks,
                    node_sets,
                    face_sets,
                },
                teeth: placement.teeth,
                bore: self.bore,
                flanks,
            },
            material: self.material,
            centre: placement.centre,
            phase: placement.phase,
            nodes: self.nodes,
            elements: self.elements,
            rigid_body: self.rigid_body,
        })
    }
}
