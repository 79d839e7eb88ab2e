//! Deformed flanks of elastic gears at a state, for figures.
//!
//! A node of a reduced gear moves with the hub, and outward by `a = B q + r T - R F` (and along the profile for gears
//! that support it); finite elements return the positions of their nodes. Racks slide, all other gears rotate: [`Placement`] has both.

use super::assembled::Scene;
use crate::Vec3;
use crate::gear::FlankDisplacement;
use crate::geometry::{FlankGrid, Side};
use crate::kinematics::Placement;
use gearbench_integrators::system::StateView;

/// A section of a deformed flank.
#[derive(Clone, Debug, PartialEq)]
pub struct DeformedFlank {
    /// Tooth of the gear, from 0.
    pub tooth: u32,
    /// Side of the flank.
    pub side: Side,
    /// Nodes from the root to the tip in the frame of the gear, undeformed [m].
    pub at_rest: Vec<Vec3>,
    /// Nodes from the root to the tip after the rigid motion [m]: that of the hub, for reduced gears that of their
    /// mean axes.
    pub with_hub: Vec<Vec3>,
    /// Displacements of the nodes from these positions [m].
    pub displacement: Vec<Vec3>,
}

impl Scene {
    /// Returns sections of the flanks of some teeth of a gear, at the column of nodes nearest to a height on its axis
    /// [m]; empty for gears without nodes.
    pub fn deformed_flanks(
        &mut self,
        at: StateView<'_>,
        gear: usize,
        teeth: &[u32],
        height: f64,
    ) -> Vec<DeformedFlank> {
        let mut found = self.with_carrier_state(at, |scene, carrier_state| {
            scene.carrier_frame_deformed(carrier_state, gear, teeth, height)
        });
        for flank in &mut found {
            let (places, displacements) = (&mut flank.with_hub, &mut flank.displacement);
            self.carriers.lift(gear, at, [places, displacements]);
        }
        found
    }

    /// Returns the sections in the carrier-frame state.
    fn carrier_frame_deformed(
        &mut self,
        at: StateView<'_>,
        gear: usize,
        teeth: &[u32],
        height: f64,
    ) -> Vec<DeformedFlank> {
        self.evaluate_contacts(at);
        let g = &self.gears[gear];
        let Some(surface) = g.model.surface() else {
            return Vec::new();
        };
        let own = g.at(at);
        let hub = &g.model.hub().hub;
        let moved = g.model.hub_state(own).displacement;
        let pose = Placement::new(hub, self.phases()[gear]).pose_at(hub, own.t, own.q, moved);
        let grids = surface.flanks.grids().iter();
        let mut out = Vec::new();
        for grid in grids.filter(|grid| teeth.contains(&grid.tooth)) {
            let off = |c: &usize| (grid.positions[*c].z - height).abs();
            let column = (0..grid.columns).min_by(|a, b| off(a).total_cmp(&off(b)));
            let place = |row: usize| row * grid.columns + column.unwrap_or(0);
            let nodes: Vec<u32> = (0..grid.rows).map(|r| grid.nodes[place(r)]).collect();
            let with_hub: Vec<Vec3> = match surface.displacement {
                None => (0..grid.rows)
                    .map(|r| pose.point(&grid.positions[place(r)]))
                    .collect(),
                // Displacements are relative to the rigid motion that the nodes determine.
                Some(_) => {
                    let mut found = vec![Vec3::zeros(); nodes.len()];
                    surface.nodes.positions(own, &nodes, &mut found);
                    found
                }
            };
            let displacement = match surface.displacement {
                None => {
                    let mut found = vec![Vec3::zeros(); nodes.len()];
                    surface.nodes.positions(own, &nodes, &mut found);
                    found.iter().zip(&with_hub).map(|(x, p)| x - p).collect()
                }
                Some(field) => {
                    let normals = (0..grid.rows).map(|r| normal(grid, column.unwrap_or(0), r));
                    let outward = self.outward(field, own, gear, &nodes, 0);
                    let further = field.along_profile();
                    let along = further.map(|by| self.outward(field, own, gear, &nodes, by));
                    (normals.enumerate())
                        .map(|(r, n)| {
                            let tangent = Vec3::new(-n.y, n.x, 0.0);
                            let along = along.as_ref().map_or(0.0, |a| a[r]);
                            pose.turn(&(outward[r] * n + along * tangent))
                        })
                        .collect()
                }
            };
            out.push(DeformedFlank {
                tooth: grid.tooth,
                side: grid.side,
                at_rest: (0..grid.rows).map(|r| grid.positions[place(r)]).collect(),
                with_hub,
                displacement,
            });
        }
        out
    }

    /// Computes the displacements of nodes, outward or, with the offset of their numbers, along the profile [m].
    fn outward(
        &self,
        field: &dyn FlankDisplacement,
        at: StateView<'_>,
        gear: usize,
        nodes: &[u32],
        further: u32,
    ) -> Vec<f64> {
        let asked: Vec<u32> = nodes.iter().map(|n| n + further).collect();
        let n = asked.len();
        let mut out = vec![0.0; n];
        field.displacements(at.q, &asked, &mut out);
        let of = &self.work.nodal.gears[gear];
        let mut by_load = vec![0.0; n];
        field.hub_compliance(&asked, &mut by_load);
        for (a, r) in out.iter_mut().zip(&by_load) {
            *a += r * of.load;
        }
        let forces = of.nodes.iter().zip(&of.force);
        let forces = forces.chain(of.along.iter().zip(&of.friction_force));
        let pressed: Vec<(u32, f64)> = forces
            .filter(|(_, f)| **f != 0.0)
            .map(|(k, f)| (*k, *f))
            .collect();
        if !field.is_compliant() || pressed.is_empty() {
            return out;
        }
        let mut all = asked;
        all.extend(pressed.iter().map(|p| p.0));
        let mut compliance = vec![0.0; all.len() * all.len()];
        field.compliance(&all, &mut compliance);
        for (k, a) in out.iter_mut().enumerate() {
            let row = &compliance[k * all.len() + n..(k + 1) * all.len()];
            *a -= row.iter().zip(&pressed).map(|(r, p)| r * p.1).sum::<f64>();
        }
        out
    }
}

/// Returns the outward normal of a flank at a node, in the transverse plane of its gear.
fn normal(grid: &FlankGrid, column: usize, row: usize) -> Vec3 {
    let at = |r: usize| grid.positions[r * grid.columns + column];
    let along = at((row + 1).min(grid.rows - 1)) - at(row.saturating_sub(1));
    // From the root to the tip; left flanks look counter-clockwise.
    let sign = grid.side.sign();
    let normal = sign * Vec3::new(-along.y, along.x, 0.0);
    normal / normal.norm().max(f64::MIN_POSITIVE)
}
