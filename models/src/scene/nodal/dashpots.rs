//! Dashpots of an island: its ports, and what they do under forces.

use super::islands::{Island, Nodal, Solved};
use crate::contact::nodal::{Block, DashpotSolve, NodalSolve, Ported, Spring, deepest};
use crate::scene::members::{SceneGear, SceneMesh};
use gearbench_integrators::system::{HalfKick, Singular};

impl Nodal {
    /// The forces that follow are sought at the end of a half kick on coordinates with these inverse masses;
    /// `accelerations` without contact stand in [`Kick`](super::islands::Kick).
    pub(in crate::scene) fn begin_kick(&mut self, kick: &HalfKick<'_>, inverse_mass: &[f64]) {
        self.kick.set(kick, inverse_mass);
        self.kick.acts = true;
    }

    /// Forces with dashpots, from the elastic ones; the residual displacements of the nodes.
    pub(super) fn damp<'a>(
        &self,
        start: usize,
        island: &Island,
        kicked: bool,
        solved: &'a mut Solved,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
    ) -> Result<&'a [f64], Singular> {
        let Solved {
            solve,
            springs,
            blocks,
            dashpots,
            mobile,
            ..
        } = solved;
        let nodes = solve.nodes();
        let ports = &mut dashpots.ports;
        let hubs: &[usize] = if kicked { &island.hubs } else { &[] };
        ports.blocks.clear();
        ports.blocks.extend_from_slice(blocks);
        if self.numbers.is_empty() {
            // The node that stands for none.
            ports.blocks.clear();
            ports.blocks.push(Block { start: 0, len: 1 });
        }
        let of_hub = |i: usize| Block {
            start: nodes + i,
            len: 1,
        };
        ports.blocks.extend((0..hubs.len()).map(of_hub));
        ports.n = nodes + hubs.len();
        ports.compliance.clear();
        ports.compliance.extend_from_slice(solve.compliance());
        let of_nodes = ports.compliance.len();
        ports.compliance.resize(of_nodes + hubs.len(), 0.0);
        if !kicked {
            ports.mobility.clear();
            mobile.1 = 0;
        } else if mobile.1 != self.kick.stamp
            || mobile.0 != self.numbers
            || ports.mobility.len() != ports.compliance.len()
        {
            mobile.0.clone_from(&self.numbers);
            mobile.1 = self.kick.stamp;
            ports.mobility.clear();
            ports.mobility.resize(ports.compliance.len(), 0.0);
            let mut begin = 0;
            for (&g, b) in island.fields.iter().zip(&*blocks) {
                let out = &mut ports.mobility[begin..][..b.len * b.len];
                begin += out.len();
                if let Some(field) = gears[g].model.displacement() {
                    let weights = &self.kick.weights[gears[g].range()];
                    field.add_mobility(weights, &self.numbers[b.start..][..b.len], out);
                }
            }
            for (out, &g) in ports.mobility[of_nodes..].iter_mut().zip(hubs) {
                *out = self.kick.weights[gears[g].offset];
            }
        }
        dashpots.points.clear();
        for (a, s) in self.active[start..].iter().zip(&*springs) {
            let mut point = Ported::default();
            point.ports[..8].copy_from_slice(&s.nodes);
            point.weights[..8].copy_from_slice(&s.weights);
            let of_mesh = meshes[self.found.points[a.point].mesh as usize].gears;
            for (k, g) in of_mesh.into_iter().enumerate() {
                if let Some(hub) = hubs.iter().position(|&h| h == g) {
                    point.ports[8 + k] = (nodes + hub) as u32;
                    point.weights[8 + k] = -a.effective_radii[k];
                }
            }
            dashpots.points.push(point);
        }
        dashpots.ports.following.clear();
        if !island.compliant.is_empty() {
            follow(solve, springs, dashpots)?;
        }
        dashpots.solve(springs)?;
        Ok(&dashpots.displacements()[..nodes])
    }
}

/// Takes from the rates what the nodes follow, and tells what of the motion of ports they do, where rates answer.
fn follow(
    solve: &mut NodalSolve,
    springs: &mut [Spring],
    dashpots: &mut DashpotSolve,
) -> Result<(), Singular> {
    let DashpotSolve { ports, points, .. } = dashpots;
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
            for (&port, w) in p.ports.iter().zip(p.weights) {
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
