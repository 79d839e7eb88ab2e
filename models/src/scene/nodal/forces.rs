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
        for i in start..self.active.len() {
            let mut a = self.active[i];
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
            a.direction = p.direction(of_master, p.gap0);
            a.faded = p.gap0;
            (a.effective_radii, a.rate) = self.rate_along(gears, mesh, &a, at, &mut row);
            self.active[i] = a;
        }
    }

    /// Effective radii of a point along its direction, and the rate of its gap before residual compliance, by the
    /// [velocities](Self::rates) of the nodes.
    fn rate_along(
        &self,
        gears: &[SceneGear],
        mesh: &SceneMesh,
        a: &NodalActive,
        at: At<'_>,
        row: &mut Row,
    ) -> ([f64; 2], f64) {
        let p = &self.found.points[a.point];
        let (effective_radii, mut rate) = rows_of(gears, mesh, a, &self.found, at, row);
        rate += row.dot(at.v);
        for k in 0..2 {
            let hub = gears[mesh.gears[k]].model.hub();
            let own = gears[mesh.gears[k]].at(at);
            rate += effective_radii[k] * hub.speed(own.t, own.v);
            let v = GearNodes::at(&self.velocities[mesh.gears[k]], &p.slots[k]);
            rate -= weighted(&p.weights[k], &v);
        }
        (effective_radii, rate)
    }

    /// Power that the dashpots take [W]: that of the forces, less that of the elastic ones by themselves, which is what
    /// the energy of the contact grows by. Directions are those of either deformed flank.
    pub(in crate::scene) fn dissipated(
        &self,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: At<'_>,
    ) -> f64 {
        let mut row = Row::default();
        let mut power = 0.0;
        for (solved, island) in self.solved.iter().zip(&self.islands) {
            if !island.damped {
                continue;
            }
            let u = solved.solve.displacements();
            for a in &self.active[solved.points.clone()] {
                let p = &self.found.points[a.point];
                let mesh = &meshes[p.mesh as usize];
                if a.force.n != 0.0 {
                    power -= a.force.n * self.rate_along(gears, mesh, a, at, &mut row).1;
                }
                let (gap, force) = a.elastic;
                if force == 0.0 {
                    continue;
                }
                let [_, master] = p.sides();
                let nodes = &self.gears[mesh.gears[master]];
                let mut of_master = GearNodes::at(&nodes.displacement, &p.slots[master]);
                if p.slots[master][0] != UNUSED {
                    for (x, &slot) in of_master.iter_mut().zip(&p.slots[master]) {
                        let i = nodes.index[slot as usize];
                        *x += u.get(i as usize).copied().unwrap_or(0.0);
                    }
                }
                let elastic = NodalActive {
                    direction: p.direction(of_master, gap),
                    faded: gap,
                    ..*a
                };
                power += force * self.rate_along(gears, mesh, &elastic, at, &mut row).1;
            }
        }
        power
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
            a.direction = p.direction(of_master, a.gap);
            a.faded = a.gap;
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
        // What fades a point out answers to the slave alone; radial, it does not turn the master.
        let aside = if k == slave { 0.0 } else { a.faded };
        match p.partner {
            Some(partner) if g.model.displacement().is_none() => {
                let (own, point) = (g.at(at), &found.partners[partner as usize]);
                row.target(g.offset, sign);
                let direction = a.direction - aside * p.fading;
                drift += sign * g.model.row(own, point, &direction, row);
            }
            _ => effective_radii[k] = sign * g.model.hub().effective_radius(&p.x, &a.direction),
        }
    }
    (effective_radii, drift)
}
