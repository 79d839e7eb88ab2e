//! Selection of the points that may touch, and the solve of an island.

use super::islands::{IslandSolution, Nodal, NodalActive};
use crate::contact::nodal::{Block, GapBound, HardSolve, NodalGearState, Share, Spring, UNUSED};
use crate::scene::members::{SceneGear, SceneMesh, gear_states};
use gearbench_integrators::system::StateView;

/// Hard contact: the solve, the initially closed constraints, and the shares of points in them.
pub(super) type Constraints<'a> = (&'a mut HardSolve, (&'a [bool], &'a [Share]));

impl Nodal {
    /// Finds points, solves each island and distributes the forces.
    pub(in crate::scene) fn evaluate(
        &mut self,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: StateView<'_>,
    ) {
        self.active.clear();
        self.torque.fill(0.0);
        self.failed = false;
        self.found.clear();
        self.hub_poses.clear();
        self.hub_poses.extend(gears.iter().map(|g| {
            let own = g.at(at);
            g.model.hub().hub.hub_pose(own.t, own.q)
        }));
        for (g, nodes) in gears.iter().zip(&mut self.gears) {
            if g.model.displacement().is_some() {
                let load = if g.model.hub().is_free() {
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

    /// Finds the points of an island.
    fn find(
        &mut self,
        island: usize,
        gap_bound: &mut GapBound,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: StateView<'_>,
    ) {
        for &m in &self.islands[island].meshes {
            let mesh = &meshes[m];
            let (a, b) = gear_states(gears, mesh, at);
            let first = self.found.points.len();
            let Ok([of_a, of_b]) = self.gears.get_disjoint_mut(mesh.gears) else {
                continue;
            };
            let side = |gear_state, nodes, k: usize| NodalGearState {
                gear_state,
                field: gears[mesh.gears[k]].model.displacement(),
                nodes,
            };
            let sides = [side(a, of_a, 0), side(b, of_b, 1)];
            mesh.search.nodal_points(sides, gap_bound, &mut self.found);
            for p in &mut self.found.points[first..] {
                p.mesh = m as u32;
            }
        }
    }

    /// Solves for the points that may touch; these become active.
    fn solve(
        &mut self,
        island: usize,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: StateView<'_>,
    ) {
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
            self.active
                .extend(near.map(|(point, p)| NodalActive::new(point, p)));
            let rise = self.solve_active(start, island, &mut solved, None, (gears, meshes), at);
            if rise <= beside || self.failed {
                break;
            }
            gap_bound.least = 2.0 * rise;
        }
        self.solved[island] = solved;
    }

    /// Solves for the active points from `start` on; returns the largest outward displacement of the nodes, both
    /// flanks together.
    pub(super) fn solve_active(
        &mut self,
        start: usize,
        island: usize,
        solved: &mut IslandSolution,
        hard: Option<Constraints<'_>>,
        (gears, meshes): (&[SceneGear], &[SceneMesh]),
        at: StateView<'_>,
    ) -> f64 {
        let here = std::mem::take(&mut self.islands[island]);
        // Gears whose nodes are displaced by the forces: by their compliance, and within a half-step impulse by their
        // masses.
        let kicked = self.impulse.acts && here.dissipates;
        let giving = if kicked {
            &here.fields
        } else {
            &here.compliant
        };
        self.giving.clear();
        self.giving.resize(gears.len(), false);
        for &g in giving {
            self.giving[g] = true;
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
        for &g in giving {
            let nodes = &mut self.gears[g];
            let begin = self.numbers.len();
            for slot in 0..nodes.nodes.len() {
                if nodes.index[slot] != UNUSED {
                    nodes.index[slot] = self.numbers.len() as u32;
                    self.numbers.push(nodes.nodes[slot]);
                    self.guess.push(nodes.expected(slot as u32));
                }
            }
            let len = self.numbers.len() - begin;
            solved.blocks.push(Block { start: begin, len });
        }
        let (blocks, numbers) = (&solved.blocks, &self.numbers);
        solved.solve.set_nodes(blocks, numbers, |k, block| {
            if let Some(field) = gears[giving[k]].model.displacement() {
                field.compliance(&numbers[blocks[k].start..][..blocks[k].len], block);
            }
        });
        let velocities = std::mem::take(&mut self.impulse.velocities);
        let v = if kicked { &velocities } else { at.v };
        let of_nodes = (giving.as_slice(), solved.blocks.as_slice());
        self.rates(start, of_nodes, gears, meshes, StateView { v, ..at });
        self.impulse.velocities = velocities;
        solved.springs.clear();
        for a in &self.active[start..] {
            let p = &self.found.points[a.point];
            let mesh = &meshes[p.mesh as usize];
            let (mut nodes, mut weights) = ([0; 8], [0.0; 8]);
            for k in 0..2 {
                if !self.giving[mesh.gears[k]] {
                    continue;
                }
                let index = &self.gears[mesh.gears[k]].index;
                for c in 0..4 {
                    nodes[4 * k + c] = index[p.slots[k][c] as usize];
                    weights[4 * k + c] = p.weights[k][c];
                }
            }
            let law = mesh.law.shared(p.share);
            let of = (p.gap0, a.rate);
            solved.springs.push(Spring {
                slip: a.sliding.speed,
                retardation: mesh.retardation,
                friction: mesh.friction.as_ref().map(|f| {
                    let place = (p.teeth[0], p.side(), p.x.z);
                    f.here(f.at(gears, mesh, at), place, at)
                }),
                ..Spring::new((nodes, weights), of, p.stiffness, law)
            });
        }
        let direct =
            hard.is_none() && kicked && self.press_retarded(start, &here, solved, gears, meshes);
        let result = match hard {
            _ if direct => Ok(&*solved.outward),
            None => solved.solve.solve(&mut solved.springs, &self.guess),
            Some((hard, (closed, shares))) => hard.solve(
                &solved.blocks,
                solved.solve.compliance(),
                &mut solved.springs,
                (closed.len(), shares),
                closed,
            ),
        };
        let result = match result {
            Ok(_) if here.dissipates && !direct => {
                self.dissipate(start, &here, kicked, solved, gears, meshes)
            }
            other => other,
        };
        let mut rises = 0.0;
        match result {
            Ok(u) => {
                for &g in giving {
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
            a.seen_by = s.seen_by;
            a.sliding.force = s.friction_force;
            if self.failed {
                a.force.n = f64::NAN;
            }
        }
        self.islands[island] = here;
        rises
    }
}
