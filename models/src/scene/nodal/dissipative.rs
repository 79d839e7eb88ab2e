//! Dashpots and friction of an island: its ports, and their response to forces.

use super::islands::{Island, IslandSolution, Nodal};
use crate::contact::nodal::{Block, DissipativeSolve, NodalSolve, PortPoint, Spring, deepest};
use crate::scene::members::{SceneGear, SceneMesh};
use gearbench_integrators::system::Singular;

impl Nodal {
    /// Computes forces with dashpots and friction from the elastic ones, and the residual displacements of the nodes.
    pub(super) fn dissipate<'a>(
        &mut self,
        start: usize,
        island: &Island,
        kicked: bool,
        solved: &'a mut IslandSolution,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
    ) -> Result<&'a [f64], Singular> {
        if kicked && self.damp_points(start, island, solved, gears, meshes)? {
            return Ok(&solved.outward);
        }
        let giving = if kicked {
            &island.fields
        } else {
            &island.compliant
        };
        let hubs: &[usize] = if kicked { &island.hubs } else { &[] };
        let IslandSolution {
            solve,
            springs,
            blocks,
            dissipative,
            mobile,
            outward,
            ..
        } = solved;
        // Nodes gear by gear, outwards and, where it is asked for, along the profile; then hubs.
        let ports = &mut dissipative.ports;
        let mut numbers = std::mem::take(&mut self.ports);
        numbers.clear();
        ports.blocks.clear();
        for (&g, b) in giving.iter().zip(&*blocks) {
            let start = numbers.len();
            let nodes = &self.numbers[b.start..][..b.len];
            numbers.extend_from_slice(nodes);
            if let Some(further) = along_profile(&gears[g], island) {
                numbers.extend(nodes.iter().map(|node| node + further));
            }
            let len = numbers.len() - start;
            ports.blocks.push(Block { start, len });
        }
        let of_numbers = numbers.len().max(1);
        if numbers.is_empty() {
            // Port of a contact without nodes.
            ports.blocks.clear();
            ports.blocks.push(Block { start: 0, len: 1 });
        }
        let of_hub = |i: usize| Block {
            start: of_numbers + i,
            len: 1,
        };
        ports.blocks.extend((0..hubs.len()).map(of_hub));
        ports.n = of_numbers + hubs.len();
        let squares: usize = ports.blocks.iter().map(|b| b.len * b.len).sum();
        let of_nodes = squares - hubs.len();
        let same = mobile.0 == numbers;
        if numbers.len() == self.numbers.len() {
            ports.compliance.clear();
            ports.compliance.extend_from_slice(solve.compliance());
            ports.compliance.resize(squares, 0.0);
        } else if !same || ports.compliance.len() != squares {
            ports.compliance.clear();
            ports.compliance.resize(squares, 0.0);
            let each = giving.iter().zip(&ports.blocks);
            fill(each, &mut ports.compliance, |g, b, out| {
                if let Some(field) = gears[g].model.displacement() {
                    field.compliance(&numbers[b.start..][..b.len], out);
                }
            });
        }
        if !kicked {
            ports.mobility.clear();
            mobile.1 = 0;
        } else if mobile.1 != self.impulse.stamp || !same || ports.mobility.len() != squares {
            mobile.1 = self.impulse.stamp;
            ports.mobility.clear();
            ports.mobility.resize(squares, 0.0);
            let each = giving.iter().zip(&ports.blocks);
            fill(each, &mut ports.mobility, |g, b, out| {
                if let Some(field) = gears[g].model.displacement() {
                    let weights = &self.impulse.weights[gears[g].range()];
                    field.add_mobility(weights, &numbers[b.start..][..b.len], out);
                }
            });
            for (out, &g) in ports.mobility[of_nodes..].iter_mut().zip(hubs) {
                *out = self.impulse.weights[gears[g].offset];
            }
        }
        if !same {
            mobile.0.clone_from(&numbers);
        }
        self.ports = numbers;
        // Where the nodes of a gear stand among the ports, and how far behind them they come along the profile.
        let place = |g: usize| {
            let i = giving.iter().position(|&of| of == g)?;
            let (from, to) = (blocks[i], ports.blocks[i]);
            let further = if to.len > from.len { from.len } else { 0 };
            Some((to.start - from.start, further))
        };
        dissipative.points.clear();
        for (a, s) in self.active[start..].iter().zip(&*springs) {
            let mut point = PortPoint::default();
            let of_mesh = meshes[self.found.points[a.point].mesh as usize].gears;
            for (k, g) in of_mesh.into_iter().enumerate() {
                if let Some((shift, further)) = place(g) {
                    for c in 4 * k..4 * k + 4 {
                        let (port, weight) = (s.nodes[c] as usize + shift, s.weights[c]);
                        (point.normal.ports[c], point.normal.weights[c]) = (port as u32, weight);
                        if further > 0 && s.friction.is_some() {
                            point.sliding.ports[c] = (port + further) as u32;
                            point.sliding.weights[c] = weight;
                        }
                    }
                }
                if let Some(hub) = hubs.iter().position(|&h| h == g) {
                    let port = (of_numbers + hub) as u32;
                    (point.normal.ports[8 + k], point.sliding.ports[8 + k]) = (port, port);
                    point.normal.weights[8 + k] = -a.effective_radii[k];
                    point.sliding.weights[8 + k] = -a.sliding.effective_radii[k];
                }
            }
            dissipative.points.push(point);
        }
        dissipative.ports.following.clear();
        if !island.compliant.is_empty() && island.damped {
            let ports = &mut dissipative.ports;
            let to = ports.blocks.iter().zip(&*blocks);
            ports.of_nodes.clear();
            (ports.of_nodes)
                .extend(to.flat_map(|(to, from)| (0..from.len).map(|i| (to.start + i) as u32)));
            follow(solve, springs, dissipative)?;
        }
        dissipative.solve(springs)?;
        let (ports, u) = dissipative.displacements();
        outward.clear();
        for (b, from) in ports.blocks.iter().zip(&*blocks) {
            outward.extend_from_slice(&u[b.start..][..from.len]);
        }
        Ok(outward)
    }

    /// Computes forces with dashpots point by point, for few points without friction at the end of an impulse; returns
    /// false for other contacts.
    fn damp_points(
        &mut self,
        start: usize,
        island: &Island,
        solved: &mut IslandSolution,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
    ) -> Result<bool, Singular> {
        let n = solved.solve.nodes();
        if island.slides || self.numbers.len() != n || !solved.solve.is_by_points() {
            return Ok(false);
        }
        self.set_mobility(start, island, solved, gears, meshes);
        solved.solve.point_based().damp(
            &mut solved.springs,
            island.damped && !island.compliant.is_empty(),
        )?;
        let IslandSolution {
            solve,
            springs,
            outward,
            ..
        } = solved;
        solve.displaced(springs, outward);
        Ok(true)
    }

    /// Computes the forces at the end of an impulse in one solve, for points without dashpots and friction on bodies with
    /// a retardation time; returns false for other contacts, and where that solve does not apply.
    pub(super) fn press_retarded(
        &mut self,
        start: usize,
        island: &Island,
        solved: &mut IslandSolution,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
    ) -> bool {
        let own_dampers = island.damped || island.slides;
        let by_points = self.numbers.len() == solved.solve.nodes()
            && solved.solve.suits_points(&solved.springs);
        if own_dampers || !by_points {
            return false;
        }
        self.set_mobility(start, island, solved, gears, meshes);
        let IslandSolution {
            solve,
            springs,
            outward,
            ..
        } = solved;
        // A solve that fails is repeated by the other one, which reports it.
        let solved = matches!(solve.solve_retarded(springs), Ok(true));
        if solved {
            solve.displaced(springs, outward);
        }
        solved
    }

    /// Computes the mobility between the points of an island at the end of the present impulse.
    fn set_mobility(
        &mut self,
        start: usize,
        island: &Island,
        solved: &mut IslandSolution,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
    ) {
        let n = solved.solve.nodes();
        let point_based = solved.solve.point_based();
        let (numbers, mobility) = (&mut solved.mobile, &mut solved.dissipative.ports.mobility);
        if numbers.1 != self.impulse.stamp || numbers.0 != self.numbers {
            numbers.1 = self.impulse.stamp;
            numbers.0.clone_from(&self.numbers);
            mobility.clear();
            mobility.resize(solved.blocks.iter().map(|b| b.len * b.len).sum(), 0.0);
            let each = island.fields.iter().zip(&solved.blocks);
            fill(each, mobility, |g, b, out| {
                if let Some(field) = gears[g].model.displacement() {
                    let weights = &self.impulse.weights[gears[g].range()];
                    field.add_mobility(weights, &self.numbers[b.start..][..b.len], out);
                }
            });
        }
        point_based.set_mobility(&solved.springs, (&solved.blocks, mobility), n);
        // Hubs follow as well.
        let active = &self.active[start..];
        let points = active.len();
        for (i, a) in active.iter().enumerate() {
            let of_a = meshes[self.found.points[a.point].mesh as usize].gears;
            for (j, b) in active.iter().enumerate() {
                let of_b = meshes[self.found.points[b.point].mesh as usize].gears;
                for (k, g) in of_a.into_iter().enumerate() {
                    let Some(l) = of_b.into_iter().position(|other| other == g) else {
                        continue;
                    };
                    if island.hubs.contains(&g) {
                        point_based.mobility[i * points + j] += a.effective_radii[k]
                            * b.effective_radii[l]
                            * self.impulse.weights[gears[g].offset];
                    }
                }
            }
        }
    }
}

/// Calls `f` for each gear with its block of a matrix.
fn fill<'a>(
    each: impl Iterator<Item = (&'a usize, &'a Block)>,
    mut matrix: &mut [f64],
    mut f: impl FnMut(usize, &Block, &mut [f64]),
) {
    for (&g, b) in each {
        let (block, rest) = matrix.split_at_mut(b.len * b.len);
        f(g, b, block);
        matrix = rest;
    }
}

/// Returns the offset of node numbers of a gear for the direction along its profile, where friction needs it and it is
/// available.
pub(super) fn along_profile(gear: &SceneGear, island: &Island) -> Option<u32> {
    let field = gear.model.displacement().filter(|_| island.slides)?;
    field.along_profile()
}

/// Subtracts the motion of following nodes from the rates, and computes their response to the motion of ports, where
/// rates depend on forces.
fn follow(
    solve: &mut NodalSolve,
    springs: &mut [Spring],
    dissipative: &mut DissipativeSolve,
) -> Result<(), Singular> {
    let DissipativeSolve { ports, points, .. } = dissipative;
    solve.linearise_holding(springs)?;
    let mut rates: Vec<f64> = springs.iter().map(|s| s.rate).collect();
    let mut column = Vec::new();
    solve.follow(springs, &mut rates, &mut column);
    let deepest = deepest(springs);
    let (nodes, n) = (solve.nodes(), ports.n);
    if !ports.mobility.is_empty() {
        // Columns of W K P^T, port by port.
        let mut columns = vec![0.0; nodes * n];
        for (s, p) in springs.iter().zip(points) {
            let k = s.holding(deepest);
            for (&port, w) in p.normal.ports.iter().zip(p.normal.weights) {
                if k * w != 0.0 {
                    s.add(k * w, &mut columns[port as usize * nodes..][..nodes]);
                }
            }
        }
        ports.following.resize(nodes * n, 0.0);
        for (port, column) in columns.chunks_exact_mut(nodes).enumerate() {
            if column.iter().all(|x| *x == 0.0) {
                continue;
            }
            solve.apply_compliance(column);
            for (node, x) in column.iter().enumerate() {
                ports.following[node * n + port] = *x;
            }
        }
    }
    for (s, rate) in springs.iter_mut().zip(rates) {
        s.rate = rate;
    }
    Ok(())
}
