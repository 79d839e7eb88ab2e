//! Assembly of teeth to one mesh: node numbers, sets, flanks.
//!
//! Nodes are numbered tooth by tooth, inside a tooth point by point of the section, and there from -z to +z:
//! neighbours have near numbers.

use super::build::{Plan, Template, refine};
use super::profile::Body;
use super::{GearMesh, flank_set};
use crate::mesh::{Face, Mesh};
use gearbench_models::Vec3;
use gearbench_models::geometry::{FlankGrid, Side};
use std::collections::BTreeMap;

/// The mesh on its way.
pub(super) struct Assembly {
    nodes: Vec<Vec3>,
    connectivity: Vec<u32>,
    bore: Vec<u32>,
    flanks: Vec<FlankGrid>,
    node_sets: BTreeMap<String, Vec<u32>>,
    face_sets: BTreeMap<String, Vec<Face>>,
    /// Numbers of the nodes of a tooth, as [point][plane].
    ids: Vec<u32>,
    positions: Vec<Vec3>,
    /// Numbers on the first cut of all and on the last so far.
    first_cut: Vec<u32>,
    last_cut: Vec<u32>,
}

impl Assembly {
    pub(super) fn new(plan: &Plan<'_>, nodes: usize) -> Self {
        let elements = nodes * plan.params.kind.nodes();
        Assembly {
            nodes: Vec::with_capacity(nodes),
            connectivity: Vec::with_capacity(elements),
            bore: Vec::new(),
            flanks: Vec::with_capacity(2 * plan.teeth.len()),
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
            ids: Vec::new(),
            positions: Vec::new(),
            first_cut: Vec::new(),
            last_cut: Vec::new(),
        }
    }

    pub(super) fn tooth(&mut self, plan: &Plan<'_>, t: &Template, place: usize, tooth: u32) {
        let planes = plan.planes.len();
        let cut = t.section.cut * planes;
        let all = t.used.len();
        plan.positions(t, plan.turn(place), &mut self.positions);
        self.ids.clear();
        self.ids.resize(all, u32::MAX);
        let mut from = 0;
        let mut to = all;
        if place > 0 {
            self.ids[..cut].copy_from_slice(&self.last_cut);
            from = cut;
        }
        if plan.closed && place + 1 == plan.teeth.len() {
            self.ids[all - cut..].copy_from_slice(&self.first_cut);
            to = all - cut;
        }
        for i in from..to {
            if t.used[i] {
                self.ids[i] = self.nodes.len() as u32;
                self.nodes.push(self.positions[i]);
            }
        }
        if place == 0 {
            self.first_cut = self.ids[..cut].to_vec();
        }
        self.last_cut.clear();
        self.last_cut.extend_from_slice(&self.ids[all - cut..]);

        let first_element = (self.connectivity.len() / plan.params.kind.nodes()) as u32;
        for &e in &t.elements {
            let ids = &self.ids;
            self.connectivity
                .extend(plan.element_nodes(t, e).map(|n| ids[n]));
        }
        for &p in &t.section.bore {
            let of_point = &self.ids[p as usize * planes..][..planes];
            self.bore
                .extend(of_point.iter().filter(|&&n| n != u32::MAX));
        }
        self.flanks_of(plan, t, tooth, first_element);
    }

    fn flanks_of(&mut self, plan: &Plan<'_>, t: &Template, tooth: u32, first_element: u32) {
        let (planes, f) = (plan.planes.len(), refine(plan.params.kind));
        let layers = plan.layers_over_width();
        for (line, side) in t.section.flanks.iter().zip(Side::BOTH) {
            let name = flank_set(tooth, side);
            let mut set = Vec::with_capacity(line.points.len() * planes);
            for &p in &line.points {
                let of_point = &self.ids[p as usize * planes..][..planes];
                set.extend(of_point.iter().filter(|&&n| n != u32::MAX));
            }
            // Contact sees the corner nodes: quadrilaterals with a node at each corner.
            let mut nodes = Vec::with_capacity((line.points.len() / f + 1) * (layers + 1));
            for &p in line.points.iter().step_by(f) {
                nodes.extend((0..=layers).map(|l| self.ids[p as usize * planes + l * f]));
            }
            let faces = line.faces.iter().flat_map(|&(q, face)| {
                (0..layers).map(move |l| Face {
                    element: first_element + t.element_of[q as usize * layers + l],
                    face,
                })
            });
            self.face_sets.insert(format!("s{name}"), faces.collect());
            self.node_sets.insert(name, set);
            self.flanks.push(FlankGrid {
                tooth,
                side,
                rows: (line.points.len() - 1) / f + 1,
                columns: layers + 1,
                positions: nodes.iter().map(|&n| self.nodes[n as usize]).collect(),
                nodes,
            });
        }
    }

    pub(super) fn finish(mut self, plan: &Plan<'_>) -> GearMesh {
        self.bore.sort_unstable();
        self.bore.dedup();
        self.node_sets.insert("bore".into(), self.bore.clone());
        if matches!(plan.body, Body::Gear(_)) && !plan.closed {
            let present = |cut: &[u32]| cut.iter().copied().filter(|&n| n != u32::MAX).collect();
            let [low, high] = match plan.body.points_inwards() {
                true => [&self.last_cut, &self.first_cut],
                false => [&self.first_cut, &self.last_cut],
            };
            self.node_sets.insert("cut_low".into(), present(low));
            self.node_sets.insert("cut_high".into(), present(high));
        }
        self.nodes.shrink_to_fit();
        self.connectivity.shrink_to_fit();
        GearMesh {
            mesh: Mesh {
                node_sets: self.node_sets,
                face_sets: self.face_sets,
                ..Mesh::new(plan.params.kind, self.nodes, self.connectivity)
            },
            teeth: plan.all_teeth,
            bore: self.bore,
            flanks: self.flanks,
            tied: Vec::new(),
        }
    }
}
