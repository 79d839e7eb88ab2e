//! A connected body of a deck, and the mesh of a gear that it becomes.

use super::patch::{Grid, Quad};
use super::{BodyShape, DeckGear, circle, decline, rack, recognised_body, spur};
use crate::deck::{Deck, DeckError};
use crate::gear_mesh::{GearMesh, flank_set};
use crate::mesh::{Block, Mesh};
use crate::recognise::{self, Axis, Misfit, Skin, SpecifiedBody};
use crate::vector::turned;
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
    /// The node set, if it is one, and its number of element corners, all of which have to be in the grid.
    pub(super) members: Option<(Vec<u32>, usize)>,
}

/// A flank that was found: its grid, and the tooth at its position.
pub(super) struct PlacedFlank {
    pub(super) tooth: u32,
    pub(super) side: Side,
    pub(super) grid: Grid,
}

/// Pose and flanks that the recognition of a body adds to its mesh.
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

    /// Returns the shape of the bore, seen along z.
    fn bore_shape(&self) -> circle::Shape {
        let bore = self.bore_corners().into_iter();
        let bore: Vec<Vec3> = bore.map(|n| self.positions[n as usize]).collect();
        circle::shape(&bore)
    }

    /// The mesh in its own frame. What no set names is recognised: the bore or the back, the flanks, an axis that is not z.
    pub(super) fn into_gear(
        mut self,
        deck: &Deck,
        known: &SpecifiedBody,
    ) -> Result<DeckGear, DeckError> {
        let mut axis = Axis {
            direction: Vec3::z(),
            point: Vec3::zeros(),
        };
        let mut missing = Vec::new();
        let shape = self.bore_shape();
        let along_z = matches!(shape, circle::Shape::Circle { .. });
        let plane = matches!(shape, circle::Shape::Plane { .. });
        if self.flanks.is_empty() || !(along_z || plane) {
            let positions = std::mem::take(&mut self.positions);
            let skin = Skin::of(&positions, &self.blocks);
            let found = recognise::body(&skin, known);
            self.positions = positions.clone();
            match found {
                Ok(found) => {
                    if self.bore.is_empty() {
                        self.bore = found.held().to_vec();
                    }
                    if self.flanks.is_empty() {
                        return Ok(recognised_body::gear(self, deck, &skin, found));
                    }
                    // Sets name flanks: they are taken as they are, in the frame where the axis is z.
                    axis.direction = found.axis().direction;
                    self.positions = positions.iter().map(|x| axis.seen(x)).collect();
                }
                // A bore about z without flanks is a body without contact.
                Err(Misfit::Missing(why)) if along_z => {
                    missing.push(format!("all flanks are missing: {why}"));
                }
                Err(misfit) => return Err(self.unknown(deck, &misfit)),
            }
        }
        let mut placement = match self.bore_shape() {
            circle::Shape::Circle { centre, radius } => {
                spur::place(&self, (deck, &axis), centre, radius)?
            }
            circle::Shape::Plane { normal } => rack::place(&self, deck, normal)?,
            circle::Shape::Neither => {
                return Err(decline(
                    deck,
                    &self.bore_set,
                    "nodes on a circle about the axis of rotation (a gear) or in a plane parallel to z (a rack)",
                    "neither",
                    "put the nodes of the bore, and no others, into the set",
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
        let height = |x: &Vec3| match placement.shape {
            BodyShape::Gear => x.xy().norm(),
            BodyShape::Rack { .. } => -x.x,
        };
        let on = (placement.flanks.iter()).flat_map(|f| f.grid.nodes.iter());
        let heights = on.map(|&n| height(&placement.positions[n as usize]));
        let [low, high] = recognise::extent(heights);
        let flank_height = if low > high {
            f64::INFINITY
        } else {
            high - low
        };
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
        let gear = DeckGear {
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
                tied: Vec::new(),
            },
            material: self.material,
            centre: axis.turned_back(&placement.centre),
            axis: axis.direction,
            phase: placement.phase,
            nodes: self.nodes,
            elements: self.elements,
            rigid_body: self.rigid_body,
            found: None,
            missing,
        };
        let by_sets = match known.flanks {
            Some(_) if !gear.mesh.flanks.is_empty() => Err(Misfit::Against {
                key: "flank_radii_m",
                said: "where flanks end".to_owned(),
                found: "node sets define the flanks of the body".to_owned(),
            }),
            _ => Ok(()),
        };
        let agrees = by_sets
            .and_then(|()| known.same_axis(&gear.axis))
            .and_then(|()| {
                let through = Axis {
                    direction: match gear.shape {
                        BodyShape::Gear => gear.axis,
                        // A rack has a line in the place of an axis: its reference line.
                        BodyShape::Rack { direction } => {
                            axis.turned_back(&turned(Vec3::y(), direction))
                        }
                    },
                    point: gear.centre,
                };
                known.same_point(&through, flank_height)
            });
        agrees.map_err(|e| against(deck, &gear.name, &e))?;
        Ok(gear)
    }

    /// Declines a body that is not a gear by its sets nor by its surface, or not the specified one.
    fn unknown(&self, deck: &Deck, why: &Misfit) -> DeckError {
        if let Misfit::Against { .. } = why {
            return against(deck, &self.name, why);
        }
        let first = deck.element_name(self.elements[0]);
        decline(
            deck,
            &self.bore_set,
            "a gear: teeth with involute flanks and a bore about one axis; a rack: teeth with plane flanks and a plane back; \
             or a node set `bore` (or `bore1`, ...) and sets such as `flank_1l`",
            format!("{why}, on the body of element {first}"),
            "name the set of the bore nodes `bore` and the sets of the flanks `flank_1l`, `flank_1r`, or give `axis` and \
             `axis_point_m` of the gear in the scene",
        )
    }
}

/// Declines a body that disagrees with its specification.
fn against(deck: &Deck, body: &str, why: &Misfit) -> DeckError {
    decline(
        deck,
        "",
        format!("`{body}` as given in the scene"),
        why.to_string(),
        "correct the parameter, or leave it out",
    )
}
