//! Gap rates of nodal points, and their forces on nodes and hubs.

use super::islands::{Nodal, NodalActive};
use crate::contact::nodal::{GearNodes, NodalPoints, UNUSED, weighted};
use crate::kinematics::Row;
use crate::scene::members::{SceneGear, SceneMesh};
use gearbench_integrators::system::At;

impl Nodal {
    /// Gap rates before residual compliance, where a damper asks for them.
    pub(super) fn rates(
        &mut self,
        start: usize,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: At<'_>,
    ) {
        let points = &self.found.points;
        let damped = |a: &NodalActive| meshes[points[a.point].mesh as usize].law.is_dissipative();
        if !self.active[start..].iter().any(damped) {
            return;
        }
        for (i, g) in gears.iter().enumerate() {
            if let Some(field) = g.model.displacement() {
                let nodes = &self.gears[i].nodes;
                self.velocities[i].resize(nodes.len(), 0.0);
                field.displacements(g.at(at).v, nodes, &mut self.velocities[i]);
            }
        }
        let mut row = Row::default();
        for a in &mut self.active[start..] {
            let p = &self.found.points[a.point];
            let mesh = &meshes[p.mesh as usize];
            if !mesh.law.is_dissipative() {
                continue;
            }
            let [_, master] = p.sides();
            let of_master = GearNodes::at(
                &self.gears[mesh.gears[master]].displacement,
                &p.slots[master],
            );
            a.direction = p.direction(of_master);
            (a.effective_radii, a.rate) = rows_of(gears, mesh, a, &self.found, at, &mut row);
            a.rate += row.dot(at.v);
            for k in 0..2 {
                let hub = gears[mesh.gears[k]].model.hub();
                let own = gears[mesh.gears[k]].at(at);
                a.rate += a.effective_radii[k] * hub.speed(own.t, own.v);
                let v = GearNodes::at(&self.velocities[mesh.gears[k]], &p.slots[k]);
                a.rate -= weighted(&p.weights[k], &v);
            }
        }
    }

    /// Forces on nodes, directions, effective base radii and rows of the active points from `start` on.
    pub(super) fn distribute(
        &mut self,
        start: usize,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: At<'_>,
    ) {
        for a in &self.active[start..] {
            if a.force.n == 0.0 {
                continue;
            }
            let p = &self.found.points[a.point];
            for (k, &g) in meshes[p.mesh as usize].gears.iter().enumerate() {
                for (&slot, w) in p.slots[k].iter().zip(p.weights[k]) {
                    if slot != UNUSED {
                        self.gears[g].force[slot as usize] += w * a.force.n;
                    }
                }
            }
        }
        for i in start..self.active.len() {
            if i == self.rows.len() {
                self.rows.push(Row::default());
            }
            let a = &mut self.active[i];
            let p = &self.found.points[a.point];
            let row = &mut self.rows[i];
            row.clear();
            if a.force.n == 0.0 {
                continue;
            }
            let mesh = &meshes[p.mesh as usize];
            let [_, master] = p.sides();
            let of_master = self.gears[mesh.gears[master]].total(&p.slots[master]);
            a.direction = p.direction(of_master);
            if p.weight_derivative != 0.0 && !mesh.hard {
                let energy = mesh.law.potential(a.elastic.0, p.stiffness);
                a.direction -= energy / a.force.n * p.weight_derivative * p.sensitivity[0];
            }
            (a.effective_radii, _) = rows_of(gears, mesh, a, &self.found, at, row);
            for k in 0..2 {
                self.torque[mesh.gears[k]] += a.effective_radii[k] * a.force.n;
            }
        }
    }

    /// Adds the forces of all points.
    pub(in crate::scene) fn add_forces(&self, gears: &[SceneGear], f: &mut [f64]) {
        for (a, row) in self.active.iter().zip(&self.rows) {
            if !row.is_empty() {
                row.add_to(a.force.n, f);
            }
        }
        for ((g, nodes), torque) in gears.iter().zip(&self.gears).zip(&self.torque) {
            let range = g.range();
            if *torque != 0.0 && g.model.hub().coordinates() > 0 {
                f[range.start] += torque;
            }
            if let Some(field) = g.model.displacement() {
                field.apply_nodal_forces(&nodes.nodes, &nodes.force, &mut f[range]);
            }
        }
    }
}

/// Effective base radii of hubs of gears with a field, and, in `row`, the entries of the others, whose prescribed part
/// of the gap rate is returned.
pub(in crate::scene) fn rows_of(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    a: &NodalActive,
    found: &NodalPoints,
    at: At<'_>,
    row: &mut Row,
) -> ([f64; 2], f64) {
    let p = &found.points[a.point];
    let (mut effective_radii, mut drift) = ([0.0; 2], 0.0);
    row.clear();
    let [slave, _] = p.sides();
    for k in 0..2 {
        let g = &gears[mesh.gears[k]];
        let sign = if k == slave { 1.0 } else { -1.0 };
        match p.partner {
            Some(partner) if g.model.displacement().is_none() => {
                let (own, point) = (g.at(at), &found.partners[partner as usize]);
                row.target(g.offset, sign);
                drift += sign * g.model.row(own, point, &a.direction, row);
            }
            _ => effective_radii[k] = sign * g.model.hub().effective_radius(&p.x, &a.direction),
        }
    }
    (effective_radii, drift)
}
