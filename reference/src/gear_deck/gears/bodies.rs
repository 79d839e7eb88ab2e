//! The connected bodies of a deck with their bores, flanks and material.

use super::body::{Body, NamedFlank};
use super::decline;
use super::groups::joined;
use super::names::{flank_name, is_bore_name};
use super::patch::{Quad, boundary};
use crate::deck::{Deck, DeckError, DeckErrorKind};
use crate::mesh::{self, Block, Face};
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use gearbench_models::stiffness::Material;

/// Greatest coordinate [m] of a body: squares and sums of squares stay finite.
const GREATEST: f64 = 1e9;

/// Marks a node that no element has.
const NONE: u32 = u32::MAX;

/// Splits a deck into bodies; `other` replaces missing values of a material.
pub(super) fn split(deck: &Deck, other: Option<Material>) -> Result<Vec<Body>, DeckError> {
    for block in &deck.blocks {
        let far = |n: &&u32| deck.nodes[**n as usize].amax() > GREATEST;
        if let Some(&n) = block.connectivity.iter().find(far) {
            return Err(decline(
                deck,
                "",
                format!("coordinates within {GREATEST:e} m"),
                format!("node {} outside this range", deck.node_name(n)),
                "give coordinates in metres",
            ));
        }
    }
    let mut groups = joined(deck);
    // Body of each group, in the order of first elements; then body and local number of each node.
    let mut body_of_group = vec![NONE; deck.nodes.len()];
    let mut elements: Vec<Vec<u32>> = Vec::new();
    for e in 0..deck.element_count() as u32 {
        let group = groups.find(deck.element(e)[0]) as usize;
        if body_of_group[group] == NONE {
            body_of_group[group] = elements.len() as u32;
            elements.push(Vec::new());
        }
        elements[body_of_group[group] as usize].push(e);
    }
    let mut nodes: Vec<Vec<u32>> = vec![Vec::new(); elements.len()];
    let mut body_of = vec![NONE; deck.nodes.len()];
    let mut local = vec![NONE; deck.nodes.len()];
    for n in 0..deck.nodes.len() as u32 {
        let body = body_of_group[groups.find(n) as usize];
        if body != NONE {
            body_of[n as usize] = body;
            local[n as usize] = nodes[body as usize].len() as u32;
            nodes[body as usize].push(n);
        }
    }
    let whose = |set: &str, members: &mut dyn Iterator<Item = u32>| -> Result<u32, DeckError> {
        let mut bodies = members.map(|n| (n, body_of[n as usize]));
        let Some((_, body)) = bodies.next() else {
            return Err(decline(
                deck,
                set,
                "nodes in the set",
                "none",
                "fill or remove it",
            ));
        };
        match bodies.find(|b| b.1 != body || b.1 == NONE) {
            _ if body == NONE => Err(decline(
                deck,
                set,
                "nodes of elements",
                "a node that belongs to no element",
                "remove free nodes from the set",
            )),
            Some((n, _)) => Err(decline(
                deck,
                set,
                "nodes of one body",
                format!("node {} of another", deck.node_name(n)),
                "give each gear sets of its own, such as `bore1` and `bore2`",
            )),
            None => Ok(body),
        }
    };

    let mut bores: Vec<Option<&str>> = vec![None; elements.len()];
    let mut flank_sets: Vec<Vec<(&str, i64, Side)>> = vec![Vec::new(); elements.len()];
    for (name, members) in &deck.node_sets {
        if is_bore_name(name) {
            let body = whose(name, &mut members.iter().copied())? as usize;
            if let Some(other) = bores[body].replace(name) {
                return Err(decline(
                    deck,
                    name,
                    "one bore set on a body",
                    format!("`{other}` on the same"),
                    "give the second set another name",
                ));
            }
        } else if let Some((label, side)) = flank_name(name) {
            let body = whose(name, &mut members.iter().copied())? as usize;
            flank_sets[body].push((name, label, side));
        }
    }
    let mut surfaces: Vec<Vec<(&str, i64, Side)>> = vec![Vec::new(); elements.len()];
    for (name, faces) in &deck.surfaces {
        if let Some((label, side)) = name.strip_prefix('s').and_then(flank_name) {
            let members = &mut faces.iter().map(|f| deck.element(f.element)[0]);
            let body = whose(name, members)? as usize;
            if !flank_sets[body].iter().any(|f| (f.1, f.2) == (label, side)) {
                surfaces[body].push((name, label, side));
            }
        }
    }

    let materials = deck.section_materials();
    let mut bodies = Vec::with_capacity(elements.len());
    for (i, elements) in elements.into_iter().enumerate() {
        let nodes = std::mem::take(&mut nodes[i]);
        let first = elements[0];
        // Without a set the bore is looked for.
        let bore_set = bores[i].unwrap_or_default();
        let mut blocks: Vec<Block> = Vec::new();
        let material = materials[first as usize];
        for &e in &elements {
            if materials[e as usize] != material {
                return Err(decline(
                    deck,
                    bore_set,
                    "one material in a body",
                    format!("another at element {}", deck.element_name(e)),
                    "a gear has one material",
                ));
            }
            let nodes = deck.element(e).iter().map(|&n| local[n as usize]);
            mesh::push(&mut blocks, deck.block(e).kind, nodes);
        }
        let positions: Vec<Vec3> = nodes.iter().map(|&n| deck.nodes[n as usize]).collect();
        let mut body = Body {
            name: deck
                .block(first)
                .set
                .clone()
                .unwrap_or_else(|| format!("gear{}", i + 1)),
            material: full_material(deck, bore_set, material, other)?,
            bore_set: bore_set.to_owned(),
            bore: (deck.node_sets.get(bore_set).into_iter().flatten())
                .map(|&n| local[n as usize])
                .collect(),
            rigid_body: deck.rigid_bodies.iter().position(|r| r.set == bore_set),
            nodes,
            elements,
            positions,
            blocks,
            flanks: Vec::new(),
        };
        if !flank_sets[i].is_empty() {
            let faces = boundary(&body.blocks);
            let corner = body.corner_nodes();
            let mut inside = vec![false; body.positions.len()];
            for &(set, label, side) in &flank_sets[i] {
                let members = &deck.node_sets[set];
                let mut corners = 0;
                for &n in members {
                    let n = local[n as usize] as usize;
                    inside[n] = true;
                    corners += usize::from(corner[n]);
                }
                let quads = faces
                    .iter()
                    .filter(|q| q.corners.iter().all(|&n| inside[n as usize]))
                    .copied()
                    .collect();
                for &n in members {
                    inside[local[n as usize] as usize] = false;
                }
                let set = set.to_owned();
                body.flanks.push(NamedFlank {
                    set,
                    label,
                    side,
                    quads,
                    members: Some((
                        members.iter().map(|&n| local[n as usize]).collect(),
                        corners,
                    )),
                });
            }
        }
        for &(set, label, side) in &surfaces[i] {
            let quads = deck.surfaces[set]
                .iter()
                .filter_map(|f| {
                    // The elements of a body ascend in the deck's numbers.
                    let element = body.elements.partition_point(|&e| e < f.element);
                    let nodes: Vec<u32> = (deck.element(f.element).iter())
                        .map(|&n| local[n as usize])
                        .collect();
                    let face = Face {
                        element: element as u32,
                        face: f.face,
                    };
                    Quad::of(face, deck.block(f.element).kind, &nodes)
                })
                .collect();
            let set = set.to_owned();
            body.flanks.push(NamedFlank {
                set,
                label,
                side,
                quads,
                members: None,
            });
        }
        bodies.push(body);
    }
    Ok(bodies)
}

fn full_material(
    deck: &Deck,
    bore: &str,
    name: Option<&str>,
    other: Option<Material>,
) -> Result<Material, DeckError> {
    let found = name.and_then(|name| deck.materials.get(name));
    if let Some(other) = other {
        let said = found.map_or((None, None), |m| (m.elastic, m.density));
        let (young, poisson) = said.0.unwrap_or((other.young, other.poisson));
        return Ok(Material {
            young,
            poisson,
            density: said.1.unwrap_or(other.density),
        });
    }
    let refuse = |expected: String, found: &str, help: &str| DeckError {
        kind: DeckErrorKind::Material,
        ..decline(deck, bore, expected, found, help)
    };
    let Some(name) = name else {
        return Err(refuse(
            "a *SOLID SECTION for the elements of the body".into(),
            "none",
            "give its element set a material",
        ));
    };
    deck.material(name).ok_or_else(|| {
        refuse(
            format!("*ELASTIC and *DENSITY of material `{name}`"),
            "only some of these constants",
            "a gear needs E, nu and the density",
        )
    })
}
