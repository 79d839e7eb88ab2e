//! A gear whose flanks no set names: recognised from its surface.

use super::body::Body;
use super::patch::{Grid, Quad, grid};
use super::{BodyShape, DeckGear};
use crate::deck::data::Deck;
use crate::mesh::{GearMesh, Mesh, TiedPoint, flank_set};
use crate::recognise::tied::{self, TiedGrid};
use crate::recognise::{Patch, Recognised, Skin};
use gearbench_models::Vec3;
use gearbench_models::geometry::FlankGrid;
use std::collections::BTreeMap;

/// The mesh of a recognised gear in its own frame; `bore` are the nodes that its hub holds. A flank whose faces are a
/// structured grid of quadrilaterals touches at its nodes, any other at points tied to its faces.
pub(super) fn gear(body: Body, deck: &Deck, skin: &Skin<'_>, found: &Recognised) -> DeckGear {
    let own: Vec<Vec3> = body.positions.iter().map(|x| found.own(x)).collect();
    let mut node_sets = BTreeMap::from([("bore".to_owned(), body.bore.clone())]);
    let mut face_sets = BTreeMap::new();
    let mut flanks = Vec::with_capacity(found.flanks.len());
    let mut points: Vec<TiedPoint> = Vec::new();
    for patch in &found.flanks {
        let name = flank_set(patch.tooth, patch.side);
        let (faces, grid) = match structured(deck, skin, &own, patch) {
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
                let Some(TiedGrid {
                    rows,
                    columns,
                    positions,
                    points: tied,
                }) = tied::lay(skin, found, patch, &own)
                else {
                    continue;
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
        shape: BodyShape::Gear,
        mesh: GearMesh {
            mesh: Mesh {
                nodes: own,
                blocks: body.blocks,
                node_sets,
                face_sets,
            },
            teeth: found.fit.teeth,
            bore: body.bore,
            flanks,
            tied: points,
        },
        material: body.material,
        centre: found.axis.point,
        axis: found.axis.direction,
        phase: found.fit.phase,
        nodes: body.nodes,
        elements: body.elements,
        rigid_body: body.rigid_body,
        found: Some(Box::new(found.clone())),
    }
}

/// The faces of a flank as a grid of nodes, if they are one.
fn structured(deck: &Deck, skin: &Skin<'_>, own: &[Vec3], patch: &Patch) -> Option<Grid> {
    let quad = |f: &u32| {
        let facet = &skin.facets[*f as usize];
        let corners = facet.corners().try_into().ok()?;
        Some(Quad {
            face: facet.face,
            corners,
        })
    };
    let quads: Vec<Quad> = patch.faces.iter().map(quad).collect::<Option<_>>()?;
    let height = |n: u32| own[n as usize].xy().norm();
    let z = |n: u32| own[n as usize].z;
    grid(deck, "", &quads, None, &height, &z).ok()
}
