//! A toothed body whose flanks no set names: recognised from its surface.

use super::body::Body;
use super::patch::{Grid, Quad, grid};
use super::{BodyShape, DeckGear, flank_words, snapped};
use crate::deck::Deck;
use crate::gear_mesh::{GearMesh, TiedPoint, flank_set};
use crate::mesh::Mesh;
use crate::recognise::tied::{self, TiedGrid, Unroll};
use crate::recognise::{Patch, RecognisedBody, RecognisedRack, Skin};
use gearbench_models::Vec3;
use gearbench_models::geometry::{FlankGrid, Side};
use std::collections::BTreeMap;

/// Returns the mesh of a recognised body in its own frame, with its `bore` tied to the hub. A flank whose faces are a
/// structured grid of quadrilaterals has contact at its nodes, any other at points tied to its faces.
pub(super) fn gear(body: Body, deck: &Deck, skin: &Skin<'_>, found: RecognisedBody) -> DeckGear {
    let placed = BodyPose::of(&found);
    let own: Vec<Vec3> = (body.positions.iter())
        .map(|x| match &found {
            RecognisedBody::Gear(gear) => gear.own(x),
            RecognisedBody::Rack(rack) => rack.own(x),
        })
        .collect();
    let toothing: &dyn Unroll = match &found {
        RecognisedBody::Gear(gear) => &**gear,
        RecognisedBody::Rack(rack) => &**rack,
    };
    let mut node_sets = BTreeMap::from([("bore".to_owned(), body.bore.clone())]);
    let mut face_sets = BTreeMap::new();
    let mut flanks = Vec::with_capacity(found.flanks().len());
    let mut points: Vec<TiedPoint> = Vec::new();
    let mut missing = absent(&found, placed.teeth);
    for patch in found.flanks() {
        let name = flank_set(patch.tooth, patch.side);
        let (faces, grid) = match structured(deck, skin, &own, toothing, patch) {
            Some(grid) => (
                grid.faces,
                FlankGrid {
                    tooth: patch.tooth,
                    side: patch.side,
                    rows: grid.rows,
                    columns: grid.columns,
                    positions: grid.nodes.iter().map(|&n| own[n as usize]).collect(),
                    nodes: grid.nodes,
                },
            ),
            None => {
                let TiedGrid {
                    rows,
                    columns,
                    positions,
                    points: tied,
                } = match tied::lay(skin, toothing, patch, &own) {
                    Ok(grid) => grid,
                    Err(why) => {
                        let flank = flank_words(patch.tooth, patch.side);
                        missing.push(format!("{flank} cannot have contact points: {why}"));
                        continue;
                    }
                };
                let first = (own.len() + points.len()) as u32;
                let nodes = (first..).take(tied.len()).collect();
                points.extend(tied);
                let faces = patch.faces.iter().map(|&f| skin.facets[f as usize].face);
                (
                    faces.collect(),
                    FlankGrid {
                        tooth: patch.tooth,
                        side: patch.side,
                        rows,
                        columns,
                        nodes,
                        positions,
                    },
                )
            }
        };
        face_sets.insert(format!("s{name}"), faces);
        node_sets.insert(name, skin.nodes_of(&patch.faces, true));
        flanks.push(grid);
    }
    DeckGear {
        name: body.name,
        shape: placed.shape,
        mesh: GearMesh {
            mesh: Mesh {
                nodes: own,
                blocks: body.blocks,
                node_sets,
                face_sets,
            },
            teeth: placed.teeth,
            bore: body.bore,
            flanks,
            tied: points,
        },
        material: body.material,
        centre: placed.centre,
        axis: found.axis().direction,
        phase: placed.phase,
        nodes: body.nodes,
        elements: body.elements,
        rigid_body: body.rigid_body,
        found: Some(found),
        missing,
    }
}

/// Pose of a recognised body in the terms of [`DeckGear`].
struct BodyPose {
    shape: BodyShape,
    teeth: u32,
    centre: Vec3,
    phase: f64,
}

impl BodyPose {
    fn of(found: &RecognisedBody) -> Self {
        match found {
            RecognisedBody::Gear(gear) => BodyPose {
                shape: BodyShape::Gear,
                teeth: gear.fit.teeth,
                centre: gear.axis.point,
                phase: gear.fit.phase,
            },
            RecognisedBody::Rack(rack) => Self::of_rack(rack, found),
        }
    }

    fn of_rack(rack: &RecognisedRack, found: &RecognisedBody) -> Self {
        let [x, y, _] = rack.axes;
        let [e, f] = found.axis().across();
        let size = rack.pitch * f64::from(rack.teeth);
        let phase = snapped(rack.origin.dot(&y), size);
        BodyPose {
            shape: BodyShape::Rack {
                direction: snapped(x.dot(&f).atan2(x.dot(&e)), 1.0),
            },
            teeth: rack.teeth,
            centre: (rack.origin - phase * y).map(|c| snapped(c, size)),
            phase,
        }
    }
}

/// Lists flanks without faces; the ends of a rack may have cut theirs off.
fn absent(found: &RecognisedBody, teeth: u32) -> Vec<String> {
    let flanks = found.flanks();
    let has = |tooth: u32, side: Side| flanks.iter().any(|p| (p.tooth, p.side) == (tooth, side));
    let ends = |tooth: u32, side: Side| match (found, side) {
        (RecognisedBody::Gear(_), _) => false,
        (RecognisedBody::Rack(_), Side::Left) => tooth == (teeth / 2 + 1) % teeth,
        (RecognisedBody::Rack(_), Side::Right) => tooth == teeth / 2,
    };
    (0..teeth)
        .flat_map(|tooth| Side::BOTH.map(|side| (tooth, side)))
        .filter(|&(tooth, side)| !has(tooth, side) && !ends(tooth, side))
        .map(|(tooth, side)| {
            let flank = flank_words(tooth, side);
            format!(
                "{flank} is missing: none of its faces lies on the surface that the others share"
            )
        })
        .collect()
}

/// Returns the faces of a flank as a grid of nodes, if they form one.
fn structured(
    deck: &Deck,
    skin: &Skin<'_>,
    own: &[Vec3],
    toothing: &dyn Unroll,
    patch: &Patch,
) -> Option<Grid> {
    let quad = |f: &u32| {
        let facet = &skin.facets[*f as usize];
        let corners = facet.corners().try_into().ok()?;
        Some(Quad {
            face: facet.face,
            corners,
        })
    };
    let quads: Vec<Quad> = patch.faces.iter().map(quad).collect::<Option<_>>()?;
    let height = |n: u32| toothing.height(&own[n as usize]);
    let z = |n: u32| own[n as usize].z;
    grid(deck, "", &quads, None, &height, &z).ok()
}
