//! Hard contact: one constraint per slave node whose averaged gap may close.

use super::islands::{IslandSolution, Nodal, NodalActive};
use crate::contact::nodal::{GapBound, HardSolve};
use crate::scene::members::{SceneGear, SceneMesh};
use gearbench_integrators::system::StateView;

impl Nodal {
    /// Solves the hard contact with one constraint per slave node whose averaged gap may close; the averaged points
    /// become active.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn solve_hard(
        &mut self,
        begin: usize,
        island: usize,
        solved: &mut IslandSolution,
        hard: &mut HardSolve,
        gears: &[SceneGear],
        meshes: &[SceneMesh],
        at: StateView<'_>,
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
                    self.active.push(NodalActive::new(i, p));
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
}
