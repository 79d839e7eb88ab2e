//! Contacts of gears with displacement fields at a state: points, one solve per island, forces on nodes and hubs.
//!
//! An island holds the meshes that residual compliance couples: an idler that has some joins both of its meshes.

use super::{Scene, SceneGear, SceneMesh, parties};
use crate::Vec3;
use crate::contact::nodal::{
    Block, GapBound, GearNodes, HardSolve, NodalParty, NodalPoints, NodalSolve, Share, Spring,
    UNUSED, weighted,
};
use crate::kinematics::Row;
use crate::law::LawForce;
use crate::spec::Load;
use gearbench_integrators::system::At;

/// A point that carries (or may carry) a force.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodalActive {
    /// Its place among the points.
    pub point: usize,
    /// Direction of the force on the slave; not quite of unit length.
    pub direction: Vec3,
    /// `dg/dtheta` for the hubs of gears that move as one but for a field, free or not.
    pub effective_radii: [f64; 2],
    /// Gap with residual compliance [m].
    pub gap: f64,
    /// Rate of the gap before it [m/s]; 0 where no damper asks.
    pub rate: f64,
    pub force: LawForce,
    /// Gap [m] and force [N] of the elastic law alone.
    pub elastic: (f64, f64),
}

/// Meshes that are solved together, and their gears with residual compliance.
#[derive(Clone, Debug, Default)]
pub(super) struct Island {
    pub meshes: Vec<usize>,
    pub compliant: Vec<usize>,
}

/// What an island left behind for its tangent.
#[derive(Clone, Debug, Default)]
pub(super) struct Solved {
    /// Range of its points.
    pub points: std::ops::Range<usize>,
    pub solve: NodalSolve,
    /// Of hard contact, in the place of the solve's own.
    pub hard: Option<HardSolve>,
    pub springs: Vec<Spring>,
    pub blocks: Vec<Block>,
}

/// Gaps averaged at slave nodes.
#[derive(Default)]
struct Averages {
    /// Gear, slot, sum of `phi A`, sum of `phi A g`.
    nodes: Vec<(usize, u32, f64, f64)>,
    /// Node, point, `phi A`.
    entries: Vec<(usize, usize, f64)>,
    /// Number of each node's constraint, if it has one.
    number: Vec<Option<u32>>,
    closed: Vec<bool>,
    shares: Vec<Share>,
}

impl Nodal {
    /// The compliances that are kept with the nodes in contact are those of another run.
    pub(super) fn forget(&mut self) {
        for solved in &mut self.solved {
            solved.solve.forget();
        }
    }
}

/// Hard contact: the solve, the constraints that are closed at first, and what they average.
type Constraints<'a> = (&'a mut HardSolve, (&'a [bool], &'a [Share]));

/// Buffers; they grow and stay.
#[derive(Default)]
pub(super) struct Nodal {
    pub islands: Vec<Island>,
    /// One per gear of the scene.
    pub gears: Vec<GearNodes>,
    /// Torque (force along the slide) of the points at hubs of gears that move as one but for a field.
    pub torque: Vec<f64>,
    pub active: Vec<NodalActive>,
    /// One per active point: entries of gears without a field.
    pub rows: Vec<Row>,
    /// One per island.
    pub solved: Vec<Solved>,
    /// Points of all islands.
    pub found: NodalPoints,
    numbers: Vec<u32>,
    guess: Vec<f64>,
    averages: Averages,
    velocities: Vec<Vec<f64>>,
    pub failed: bool,
}

impl SceneGear {
    /// What loads apply to the hub whatever its speed [N m] or [N].
    pub(super) fn applied(&self, t: f64) -> f64 {
        let value = |l: &Load| match l {
            Load::Applied(p) => p.value(t),
            Load::Viscous(_) => 0.0,
        };
        self.loads.iter().map(value).sum()
    }

    /// Its rate.
    pub(super) fn applied_rate(&self, t: f64) -> f64 {
        let slope = |l: &Load| match l {
            Load::Applied(p) => p.slope(t),
            Load::Viscous(_) => 0.0,
        };
        self.loads.iter().map(slope).sum()
    }
}

/// Islands of the meshes that have a gear with a field.
pub(super) fn islands(gears: &[SceneGear], meshes: &[SceneMesh]) -> Vec<Island> {
    let compliant = |g: usize| {
        gears[g]
            .model
            .displacement()
            .is_some_and(|f| f.is_compliant())
    };
    let mut islands: Vec<Island> = Vec::new();
    for (m, mesh) in meshes.iter().enumerate().filter(|(_, m)| m.nodal) {
        let mut own = Island {
            meshes: vec![m],
            compliant: mesh.gears.into_iter().filter(|&g| compliant(g)).collect(),
        };
        let (joined, apart) = islands
            .into_iter()
            .partition(|i| i.compliant.iter().any(|g| own.compliant.contains(g)));
        islands = apart;
        for other in joined {
            let other: Island = other;
            own.meshes.extend(other.meshes);
            for g in other.compliant {
                if !own.compliant.contains(&g) {
                    own.compliant.push(g);
                }
            }
        }
        own.meshes.sort_unstable();
        islands.push(own);
    }
    islands
}

impl Nodal {
    pub(super) fn new(gears: &[SceneGear], meshes: &[SceneMesh]) -> Self {
        let islands = islands(gears, meshes);
        Nodal {
            gears: vec![GearNodes::default(); gears.len()],
            torque: vec![0.0; gears.len()],
            velocities: vec![vec![]; gears.len()],
            solved: islands
                .iter()
                .map(|i| Solved {
                    hard: i
                        .meshes
                        .iter()
                        .any(|m| meshes[*m].hard)
                        .then(HardSolve::default),
                    ..Solved::default()
                })
                .collect(),
            islands,
            ..Nodal::default()
        }
    }

    /// Finds points, solves each island and distributes the forces.
    pub(super) fn evaluate(&mut self, gears: &[SceneGear], meshes: &[SceneMesh], at: At<'_>) {
        self.active.clear();
        self.torque.fill(0.0);
        self.failed = false;
        self.found.points.clear();
        self.found.partners.clear();
        for (g, nodes) in gears.iter().zip(&mut self.gears) {
            if g.model.displacement().is_some() {
                let load = if g.model.hub().coordinates() > 0 {
                    g.applied(at.t)
                } else {
                    0.0
                };
                nodes.begin(load);
            }
        }
        for i in 0..self.islands.len() {
            let start = self.active.len();
            self.solve(i, gears, meshes, at);
            self.distribute(start, gears, meshes, at);
            self.solved[i].points = start..self.active.len();
        }
    }

    /// Points of an island.
    fn find(
        &mut self,
        island: usize,
        gap_bound: &mut GapBound,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: At<'_>,
    ) {
        for &m in &self.islands[island].meshes {
            let mesh = &meshes[m];
            let (a, b) = parties(gears, mesh, at);
            let first = self.found.points.len();
            let Ok([of_a, of_b]) = self.gears.get_disjoint_mut(mesh.gears) else {
                continue;
            };
            let side = |party, nodes, k: usize| NodalParty {
                party,
                field: gears[mesh.gears[k]].model.displacement(),
                nodes,
            };
            let sides = [side(a, of_a, 0), side(b, of_b, 1)];
            if let Some(points) = mesh.search.points() {
                points.nodal_points(sides, gap_bound, &mut self.found);
            }
            for p in &mut self.found.points[first..] {
                p.mesh = m as u32;
            }
        }
    }

    /// Solves for the points that may touch; these become active.
    fn solve(&mut self, island: usize, gears: &[SceneGear], meshes: &[SceneMesh], at: At<'_>) {
        let mut solved = std::mem::take(&mut self.solved[island]);
        solved.springs.clear();
        solved.blocks.clear();
        let start = self.active.len();
        let begin = self.found.points.len();
        let mut gap_bound = GapBound {
            depth: 0.0,
            least: 0.0,
        };
        loop {
            self.active.truncate(start);
            self.found.points.truncate(begin);
            self.find(island, &mut gap_bound, gears, meshes, at);
            if gap_bound.depth <= 0.0 {
                break;
            }
            if let Some(mut hard) = solved.hard.take() {
                self.solve_hard(begin, island, &mut solved, &mut hard, gears, meshes, at);
                solved.hard = Some(hard);
                break;
            }
            let beside = gap_bound.gap();
            let found = self.found.points.iter().enumerate().skip(begin);
            let near = found.filter(|(_, p)| p.gap0 <= beside);
            self.active.extend(near.map(|(point, p)| NodalActive {
                point,
                direction: p.normal,
                effective_radii: [0.0; 2],
                gap: p.gap0,
                rate: 0.0,
                force: LawForce::default(),
                elastic: (p.gap0, 0.0),
            }));
            let rise = self.solve_active(start, island, &mut solved, None, (gears, meshes), at);
            if rise <= beside || self.failed {
                break;
            }
            gap_bound.least = 2.0 * rise;
        }
        self.solved[island] = solved;
    }

    /// Hard contact: one constraint per slave node whose averaged gap may close; the points that it averages become
    /// active.
    #[allow(clippy::too_many_arguments)]
    fn solve_hard(
        &mut self,
        begin: usize,
        island: usize,
        solved: &mut Solved,
        hard: &mut HardSolve,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: At<'_>,
    ) {
        // Averages: per slave node (gear, slot) the sums of phi A and of phi A g.
        let mut b = std::mem::take(&mut self.averages);
        b.nodes.clear();
        b.entries.clear();
        for (i, p) in self.found.points.iter().enumerate().skip(begin) {
            let [slave, _] = p.sides();
            let gear = meshes[p.mesh as usize].gears[slave];
            for (&slot, &w) in p.slots[slave].iter().zip(&p.weights[slave]) {
                if w <= 0.0 || p.stiffness <= 0.0 {
                    continue;
                }
                let same = |n: &(usize, u32, f64, f64)| (n.0, n.1) == (gear, slot);
                let k = b.nodes.iter().rposition(same).unwrap_or_else(|| {
                    b.nodes.push((gear, slot, 0.0, 0.0));
                    b.nodes.len() - 1
                });
                let share = w * p.stiffness;
                b.nodes[k].2 += share;
                b.nodes[k].3 += share * p.gap0;
                b.entries.push((k, i, share));
            }
        }
        let average = |n: &(usize, u32, f64, f64)| n.3 / n.2;
        let depth = b.nodes.iter().fold(0.0_f64, |d, n| d.max(-average(n)));
        let start = self.active.len();
        let mut gap_bound = GapBound { depth, least: 0.0 };
        loop {
            if depth <= 0.0 {
                break;
            }
            self.active.truncate(start);
            let beside = gap_bound.gap();
            b.number.clear();
            b.closed.clear();
            for n in &b.nodes {
                b.number
                    .push((average(n) <= beside).then_some(b.closed.len() as u32));
                if average(n) <= beside {
                    b.closed.push(self.gears[n.0].was_pressed(n.1));
                }
            }
            if !b.closed.contains(&true) {
                b.closed.clear();
                let chosen = b.nodes.iter().filter(|n| average(n) <= beside);
                b.closed.extend(chosen.map(|n| average(n) < 0.0));
            }
            // Entries come point by point.
            b.shares.clear();
            let mut last = usize::MAX;
            for &(k, i, share) in &b.entries {
                let Some(number) = b.number[k] else { continue };
                if i != last {
                    last = i;
                    let p = &self.found.points[i];
                    self.active.push(NodalActive {
                        point: i,
                        direction: p.normal,
                        effective_radii: [0.0; 2],
                        gap: p.gap0,
                        rate: 0.0,
                        force: LawForce::default(),
                        elastic: (p.gap0, 0.0),
                    });
                }
                let point = (self.active.len() - 1 - start) as u32;
                b.shares.push((number, point, share / b.nodes[k].2));
            }
            let law = Some((&mut *hard, (b.closed.as_slice(), b.shares.as_slice())));
            let rise = self.solve_active(start, island, solved, law, (gears, meshes), at);
            if rise <= beside || self.failed || b.closed.len() == b.nodes.len() {
                break;
            }
            gap_bound.least = 2.0 * rise;
        }
        self.averages = b;
    }

    /// Solves for the active points from `start` on; returns by how much nodes rise outwards at most, both flanks
    /// together.
    fn solve_active(
        &mut self,
        start: usize,
        island: usize,
        solved: &mut Solved,
        hard: Option<Constraints<'_>>,
        (gears, meshes): (&[SceneGear], &[SceneMesh]),
        at: At<'_>,
    ) -> f64 {
        for &g in &self.islands[island].compliant {
            self.gears[g].index.fill(UNUSED);
        }
        for a in &self.active[start..] {
            let p = &self.found.points[a.point];
            for (k, &g) in meshes[p.mesh as usize].gears.iter().enumerate() {
                for &slot in p.slots[k].iter().filter(|s| **s != UNUSED) {
                    self.gears[g].index[slot as usize] = 0;
                }
            }
        }
        solved.blocks.clear();
        self.numbers.clear();
        self.guess.clear();
        for &g in &self.islands[island].compliant {
            let nodes = &mut self.gears[g];
            let begin = self.numbers.len();
            for slot in 0..nodes.nodes.len() {
                if nodes.index[slot] != UNUSED {
                    nodes.index[slot] = self.numbers.len() as u32;
                    self.numbers.push(nodes.nodes[slot]);
                    self.guess.push(nodes.before(slot as u32));
                }
            }
            let len = self.numbers.len() - begin;
            solved.blocks.push(Block { start: begin, len });
        }
        let compliant = &self.islands[island].compliant;
        let (blocks, numbers) = (&solved.blocks, &self.numbers);
        solved.solve.set_nodes(blocks, numbers, |mut out| {
            for (&g, b) in compliant.iter().zip(blocks) {
                let (block, rest) = out.split_at_mut(b.len * b.len);
                if let Some(field) = gears[g].model.displacement() {
                    field.compliance(&numbers[b.start..][..b.len], block);
                }
                out = rest;
            }
        });
        self.rates(start, gears, meshes, at);
        solved.springs.clear();
        for a in &self.active[start..] {
            let p = &self.found.points[a.point];
            let mesh = &meshes[p.mesh as usize];
            let (mut nodes, mut weights) = ([0; 8], [0.0; 8]);
            for k in 0..2 {
                if !self.islands[island].compliant.contains(&mesh.gears[k]) {
                    continue;
                }
                let index = &self.gears[mesh.gears[k]].index;
                for c in 0..4 {
                    nodes[4 * k + c] = index[p.slots[k][c] as usize];
                    weights[4 * k + c] = p.weights[k][c];
                }
            }
            solved.springs.push(Spring {
                nodes,
                weights,
                gap0: p.gap0,
                rate: a.rate,
                stiffness: p.stiffness,
                law: mesh.law.shared(p.share),
                gap: p.gap0,
                force: LawForce::default(),
                elastic: (p.gap0, 0.0),
            });
        }
        let result = match hard {
            None => solved.solve.solve(&mut solved.springs, &self.guess),
            Some((hard, (closed, shares))) => hard.solve(
                &solved.blocks,
                solved.solve.compliance(),
                &mut solved.springs,
                (closed.len(), shares),
                closed,
            ),
        };
        let mut rises = 0.0;
        match result {
            Ok(u) => {
                for &g in &self.islands[island].compliant {
                    let nodes = &mut self.gears[g];
                    let mut rise = 0.0_f64;
                    for (&i, out) in nodes.index.iter().zip(&mut nodes.residual) {
                        *out = if i == UNUSED { 0.0 } else { u[i as usize] };
                        rise = rise.max(*out);
                    }
                    rises += rise;
                }
            }
            Err(_) => self.failed = true,
        }
        for (a, s) in self.active[start..].iter_mut().zip(&solved.springs) {
            (a.gap, a.force, a.elastic) = (s.gap, s.force, s.elastic);
            if self.failed {
                a.force.n = f64::NAN;
            }
        }
        rises
    }

    /// Gap rates before residual compliance, where a damper asks for them.
    fn rates(&mut self, start: usize, gears: &[SceneGear], meshes: &[SceneMesh], at: At<'_>) {
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
    fn distribute(&mut self, start: usize, gears: &[SceneGear], meshes: &[SceneMesh], at: At<'_>) {
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
    pub(super) fn add_forces(&self, gears: &[SceneGear], f: &mut [f64]) {
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
fn rows_of(
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

impl Scene {
    /// The contacts of a scene that has gears with fields.
    pub(super) fn evaluate_with_fields(&mut self, at: At<'_>) {
        self.work.active.clear();
        self.work.candidates.clear();
        for m in 0..self.meshes.len() {
            if !self.meshes[m].nodal {
                self.evaluate_mesh(at, m, false);
            }
        }
        self.work.nodal.evaluate(&self.gears, &self.meshes, at);
    }

    /// Flank nodes of a gear with a field that carried a force in the last evaluation.
    pub fn pressed_nodes(&self, gear: usize) -> Vec<u32> {
        let nodes = &self.work.nodal.gears[gear];
        let pressed = nodes.nodes.iter().zip(&nodes.force);
        let pressed = pressed.filter(|(_, f)| **f != 0.0);
        pressed.map(|(node, _)| *node).collect()
    }

    /// Prescribed part of the gap rate of a point [m/s].
    pub(super) fn nodal_drift(&self, a: &NodalActive, at: At<'_>) -> f64 {
        let p = &self.work.nodal.found.points[a.point];
        let mesh = &self.meshes[p.mesh as usize];
        let (effective_radii, mut drift) = rows_of(
            &self.gears,
            mesh,
            a,
            &self.work.nodal.found,
            at,
            &mut Row::default(),
        );
        for (effective_radius, &g) in effective_radii.iter().zip(&mesh.gears) {
            let hub = self.gears[g].model.hub();
            if hub.coordinates() == 0 {
                drift += effective_radius * hub.speed(at.t, &[]);
            }
        }
        drift
    }
}
