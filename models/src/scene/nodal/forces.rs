//! Gap rates of nodal points, and their forces on nodes and hubs.

use super::islands::{Nodal, NodalActive};
use crate::Vec3;
use crate::contact::nodal::{
    Block, GearNodes, LineMotion, LineSlope, NodalPoint, NodalPoints, UNUSED, weighted,
};
use crate::geometry::along_profile;
use crate::kinematics::{HubPose, Row};
use crate::scene::members::{SceneGear, SceneMesh};
use gearbench_integrators::system::StateView;

impl Nodal {
    /// Computes the rates of gaps and sliding speeds before residual compliance, where dampers and friction need them.
    /// The nodes of the active points of some gears are blocks of the numbers of the solve.
    pub(super) fn rates(
        &mut self,
        start: usize,
        (solved, blocks): (&[usize], &[Block]),
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: StateView<'_>,
    ) {
        let points = &self.found.points;
        let of = |a: &NodalActive| &meshes[points[a.point].mesh as usize];
        if !self.active[start..].iter().any(|a| of(a).dissipates()) {
            return;
        }
        let slides = self.active[start..]
            .iter()
            .any(|a| of(a).friction.is_some());
        for (i, g) in gears.iter().enumerate() {
            if let Some(field) = g.model.displacement() {
                let met = &self.gears[i];
                let v = g.at(at).v;
                let [outwards, along] = &mut self.velocities[i];
                outwards.resize(met.nodes.len(), 0.0);
                match solved.iter().position(|&g| g == i).map(|k| blocks[k]) {
                    // Only the nodes of active points.
                    Some(block) => {
                        let numbers = &self.numbers[block.start..][..block.len];
                        self.of_block.resize(block.len, 0.0);
                        field.displacements(v, numbers, &mut self.of_block);
                        for (&node, out) in met.index.iter().zip(&mut *outwards) {
                            if node != UNUSED {
                                *out = self.of_block[node as usize - block.start];
                            }
                        }
                    }
                    None => field.displacements(v, &met.nodes, outwards),
                }
                along.resize(if slides { met.along.len() } else { 0 }, 0.0);
                field.displacements(v, &met.along[..along.len()], along);
            }
        }
        let mut row = Row::default();
        for i in start..self.active.len() {
            let mut a = self.active[i];
            let p = &self.found.points[a.point];
            let mesh = &meshes[p.mesh as usize];
            if !mesh.dissipates() {
                continue;
            }
            let [_, master] = p.sides();
            let of_master = GearNodes::at(
                &self.gears[mesh.gears[master]].displacement,
                &p.slots[master],
            );
            a.direction = p.direction(of_master, p.gap0);
            a.tapered_gap = p.gap0;
            a.of_line = self.of_line(p, mesh, [0.0; 2], |g, slots| {
                GearNodes::at(&self.gears[g].displacement, slots)
            });
            (a.effective_radii, a.rate) = self.rate_along(gears, mesh, &a, at, &mut row);
            if mesh.friction.is_some() {
                let direction = p.normal.norm() * along_profile(&p.normal);
                a.sliding.direction = direction;
                let along = (direction, 0.0);
                (a.sliding.effective_radii, a.sliding.speed) =
                    self.speed_along(gears, mesh, &a, (along, 1), at, &mut row);
            }
            self.active[i] = a;
        }
    }

    /// Returns the poses of the hubs of a mesh at the state of the evaluation.
    fn hub_poses(&self, mesh: &SceneMesh) -> [Option<&HubPose>; 2] {
        mesh.gears.map(|g| self.hub_poses[g].as_ref())
    }

    /// Returns the effective radii of a point along its direction, and the rate of its gap before residual compliance,
    /// from the [velocities](Self::rates) of the nodes.
    fn rate_along(
        &self,
        gears: &[SceneGear],
        mesh: &SceneMesh,
        a: &NodalActive,
        at: StateView<'_>,
        row: &mut Row,
    ) -> ([f64; 2], f64) {
        let along = (a.direction, a.tapered_gap);
        self.speed_along(gears, mesh, a, (along, 0), at, row)
    }

    /// Returns the effective radii of a point along a direction, and the speed of the slave relative to the master
    /// along it, with the velocities of nodes outwards (0) or along the profile (1).
    fn speed_along(
        &self,
        gears: &[SceneGear],
        mesh: &SceneMesh,
        a: &NodalActive,
        (along, of_nodes): ((Vec3, f64), usize),
        at: StateView<'_>,
        row: &mut Row,
    ) -> ([f64; 2], f64) {
        let p = &self.found.points[a.point];
        let (effective_radii, mut speed) = match a.of_line.filter(|_| of_nodes == 0) {
            Some(of_line) => {
                row.clear();
                let stand = self.hub_poses(mesh);
                let (radii, drift) =
                    line_rows(gears, mesh, (p, &self.found, &of_line), stand, at, row);
                self.deformed_rows(p, gears, mesh, at, row);
                (radii, drift + row.dot(at.v))
            }
            None => {
                let stand = self.hub_poses(mesh);
                let (radii, drift) = rows_of(gears, mesh, p, along, (&self.found, stand), at, row);
                (radii, drift + row.dot(at.v))
            }
        };
        for k in 0..2 {
            let hub = gears[mesh.gears[k]].model.hub();
            let own = gears[mesh.gears[k]].at(at);
            speed += effective_radii[k] * hub.speed(own.t, own.v);
            let velocities = &self.velocities[mesh.gears[k]][of_nodes];
            if !velocities.is_empty() {
                speed -= weighted(&p.weights[k], &GearNodes::at(velocities, &p.slots[k]));
            }
        }
        (effective_radii, speed)
    }

    /// Returns the derivative of the gap of a line by the motion of the hubs, with the displacements of nodes of a gear and
    /// further derivatives by the places on both flanks.
    fn of_line(
        &self,
        p: &NodalPoint,
        mesh: &SceneMesh,
        by_place: [f64; 2],
        displacements: impl Fn(usize, &[u32; 4]) -> [f64; 4],
    ) -> Option<LineSlope> {
        let line = p.line?;
        let a = [0, 1].map(|k| displacements(mesh.gears[k], &p.slots[k]));
        Some(self.found.line_slope(line, a, by_place))
    }

    /// Appends the slopes of the gap of a line by the node positions of gears with deformed lines.
    fn deformed_rows(
        &self,
        p: &NodalPoint,
        gears: &[SceneGear],
        mesh: &SceneMesh,
        at: StateView<'_>,
        row: &mut Row,
    ) {
        let Some(line) = p.line else { return };
        let deformed = &self.found.lines[line as usize].deformed;
        for ((k, lines), &g) in deformed.iter().enumerate().zip(&mesh.gears) {
            let g = &gears[g];
            if let (Some(lines), Some(nodes)) = (lines, g.model.deformed_lines()) {
                row.target(g.offset, -1.0);
                nodes.row(g.at(at), lines, &p.weights[k], row);
            }
        }
    }

    /// Returns the power of dashpots and friction [W]: that of the forces, less that of the elastic forces alone,
    /// which is the rate of the contact energy. Directions are those of both deformed flanks.
    pub(in crate::scene) fn dissipated(
        &self,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: StateView<'_>,
    ) -> f64 {
        let mut row = Row::default();
        let mut power = 0.0;
        for (solved, island) in self.solved.iter().zip(&self.islands) {
            if !island.dissipates {
                continue;
            }
            let u = solved.solve.displacements();
            for a in &self.active[solved.points.clone()] {
                let p = &self.found.points[a.point];
                let mesh = &meshes[p.mesh as usize];
                power -= a.sliding.force.f * a.sliding.speed;
                if a.force.n != 0.0 {
                    // The rate of the gap, without the change of the energy with the places.
                    let gap = NodalActive {
                        of_line: self
                            .of_line(p, mesh, [0.0; 2], |g, slots| self.gears[g].total(slots)),
                        ..*a
                    };
                    power -= a.force.n * self.rate_along(gears, mesh, &gap, at, &mut row).1;
                }
                let (gap, force) = a.elastic;
                if force == 0.0 {
                    continue;
                }
                let [_, master] = p.sides();
                let under_elastic = |g: usize, slots: &[u32; 4]| {
                    let nodes = &self.gears[g];
                    let mut x = GearNodes::at(&nodes.displacement, slots);
                    if slots[0] != UNUSED {
                        for (x, &slot) in x.iter_mut().zip(slots) {
                            let i = nodes.index[slot as usize];
                            *x += u.get(i as usize).copied().unwrap_or(0.0);
                        }
                    }
                    x
                };
                let of_master = under_elastic(mesh.gears[master], &p.slots[master]);
                let elastic = NodalActive {
                    direction: p.direction(of_master, gap),
                    tapered_gap: gap,
                    of_line: self.of_line(p, mesh, [0.0; 2], under_elastic),
                    ..*a
                };
                power += force * self.rate_along(gears, mesh, &elastic, at, &mut row).1;
            }
        }
        power
    }

    /// Computes forces on nodes, directions, effective base radii and rows of the active points from `start` on.
    pub(super) fn distribute(
        &mut self,
        start: usize,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: StateView<'_>,
    ) {
        for a in &self.active[start..] {
            if a.force.n == 0.0 {
                continue;
            }
            let p = &self.found.points[a.point];
            for (k, &g) in meshes[p.mesh as usize].gears.iter().enumerate() {
                let nodes = &mut self.gears[g];
                for (&slot, w) in p.slots[k].iter().zip(p.weights[k]) {
                    if slot != UNUSED {
                        nodes.force[slot as usize] += w * a.force.n;
                        nodes.friction_force[slot as usize] += w * a.sliding.force.f;
                    }
                }
            }
        }
        for i in start..self.active.len() {
            if i == self.rows.len() {
                self.rows.push(Default::default());
            }
            let mut rows = std::mem::take(&mut self.rows[i]);
            rows.iter_mut().for_each(Row::clear);
            let mut a = self.active[i];
            if a.force.n != 0.0 {
                self.turn(&mut a, gears, meshes, at, &mut rows);
                let of_mesh = meshes[self.found.points[a.point].mesh as usize].gears;
                for (k, g) in of_mesh.into_iter().enumerate() {
                    self.torque[g] += a.effective_radii[k] * a.force.n
                        + a.sliding.effective_radii[k] * a.sliding.force.f;
                }
            }
            self.active[i] = a;
            self.rows[i] = rows;
        }
    }

    /// Computes direction, effective base radii and rows of a point under its force.
    fn turn(
        &self,
        a: &mut NodalActive,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: StateView<'_>,
        [row, sliding]: &mut [Row; 2],
    ) {
        let p = &self.found.points[a.point];
        let mesh = &meshes[p.mesh as usize];
        let poses = self.hub_poses(mesh);
        let [_, master] = p.sides();
        let of_master = self.gears[mesh.gears[master]].total(&p.slots[master]);
        a.direction = p.direction(of_master, a.gap);
        a.tapered_gap = a.gap;
        if let Some(line) = p.line {
            // The energy changes with the places as well.
            let law = mesh.law.shared(p.share);
            let by_force = -law.d_potential_dk(a.elastic.0, p.stiffness) * p.stiffness;
            let ln_force = self.found.lines[line as usize].ln_force;
            let by_place = ln_force.map(|ln_force| by_force * ln_force / a.force.n);
            a.of_line = self.of_line(p, mesh, by_place, |g, slots| self.gears[g].total(slots));
        }
        a.effective_radii = match &a.of_line {
            Some(of_line) => {
                if let LineSlope::Relative(wrench) = of_line {
                    a.direction = wrench.force;
                }
                let found = (p, &self.found, of_line);
                let (radii, _) = line_rows(gears, mesh, found, poses, at, row);
                self.deformed_rows(p, gears, mesh, at, row);
                radii
            }
            None => {
                let along = (a.direction, a.tapered_gap);
                rows_of(gears, mesh, p, along, (&self.found, poses), at, row).0
            }
        };
        if mesh.friction.is_some() {
            let along = (a.sliding.direction, 0.0);
            rows_of(gears, mesh, p, along, (&self.found, poses), at, sliding);
        }
    }

    /// Adds the forces of all points.
    pub(in crate::scene) fn add_forces(&self, gears: &[SceneGear], f: &mut [f64]) {
        for (a, [row, sliding]) in self.active.iter().zip(&self.rows) {
            if !row.is_empty() {
                row.add_to(a.force.n, f);
            }
            if !sliding.is_empty() {
                sliding.add_to(a.sliding.force.f, f);
            }
        }
        for ((g, nodes), torque) in gears.iter().zip(&self.gears).zip(&self.torque) {
            let range = g.range();
            if *torque != 0.0 && g.model.hub().is_free() {
                f[range.start] += torque;
            }
            if let Some(field) = g.model.displacement() {
                field.apply_nodal_forces(&nodes.nodes, &nodes.force, &mut f[range.clone()]);
                field.apply_nodal_forces(&nodes.along, &nodes.friction_force, &mut f[range]);
            }
        }
    }
}

/// Returns the effective radii of the hubs of a line for its derivative by their motion. It writes to `row` the entries of the
/// other directions of the hubs, and returns the prescribed part of the speed.
pub(in crate::scene) fn line_rows(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    (p, found, slope): (&NodalPoint, &NodalPoints, &LineSlope),
    hub_poses: [Option<&HubPose>; 2],
    at: StateView<'_>,
    row: &mut Row,
) -> ([f64; 2], f64) {
    let motion = p.line.map(|line| found.lines[line as usize].motion);
    let (wrench, motion) = match (slope, motion) {
        (LineSlope::OwnDirections(radii), _) => return (*radii, 0.0),
        (LineSlope::Relative(wrench), Some(LineMotion::Relative(motion))) => {
            (wrench, &found.motions[motion as usize])
        }
        (LineSlope::Relative(_), _) => unreachable!("a derivative is that of its line"),
    };
    let mut drift = 0.0;
    let radii = [(0, -1.0), (1, 1.0)].map(|(k, sign)| {
        let g = &gears[mesh.gears[k]];
        let mut own = motion.of_nodes[k];
        own.add(sign, wrench);
        let hub = &g.model.hub().hub;
        if let Some(hub_pose) = hub_poses[k] {
            row.target(g.offset, 1.0);
            drift += hub.wrench_row_on(at.t, hub_pose, &own, row, false);
        }
        hub.own_component(hub_poses[k], &own)
    });
    (radii, drift)
}

/// Returns the effective radii of hubs of gears with a field for a direction of motion of the slave relative to the
/// master. It writes to `row` the entries of the other gears and of the other directions of hubs, and returns the
/// prescribed part of the speed. The direction comes with the gap in the tip taper of the point, the points with the
/// poses of both hubs.
pub(in crate::scene) fn rows_of(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    p: &NodalPoint,
    (direction, tapered_gap): (Vec3, f64),
    (found, hub_poses): (&NodalPoints, [Option<&HubPose>; 2]),
    at: StateView<'_>,
    row: &mut Row,
) -> ([f64; 2], f64) {
    let (mut effective_radii, mut drift) = ([0.0; 2], 0.0);
    row.clear();
    let [slave, _] = p.sides();
    for k in 0..2 {
        let g = &gears[mesh.gears[k]];
        let sign = if k == slave { 1.0 } else { -1.0 };
        // The taper of a point acts on the slave body only; it is radial and exerts no torque on the master.
        let aside = if k == slave { 0.0 } else { tapered_gap };
        match p.partner {
            Some(partner) if g.model.displacement().is_none() => {
                let (own, point) = (g.at(at), &found.partners[partner as usize]);
                row.target(g.offset, sign);
                let direction = direction - aside * p.taper_gradient;
                drift += sign * g.model.row(own, point, &direction, row);
            }
            _ => {
                let (hub, own) = (&g.model.hub().hub, g.at(at));
                let stand = hub_poses[k];
                effective_radii[k] = sign * hub.effective_radius_on(stand, &p.x, &direction);
                if let Some(stand) = stand {
                    row.target(g.offset, sign);
                    let along = (&p.x, &direction);
                    drift += sign * hub.lateral_row_on(own.t, stand, along, row, false);
                }
            }
        }
    }
    (effective_radii, drift)
}
