//! Pairs of one line of action that bend the same bodies.
//!
//! A pair's stiffness `k(s)` is that of the pair alone; a force on another pair of the same slice, `r`, opens its gap by
//! `c_pr N_r`, what tooth roots, rim and disc that both stand on give:
//!
//! ```text
//! g_p = g0_p + sum over r != p of c_pr N_r(g_r),    N = k d^n
//! V = sum W(g_p) + sum over p < r of c_pr N_p N_r,  F = -dV/dq
//! ```
//!
//! with elastic forces, so that the forces are those of one potential; a damper sees the rate of `g0`. What the
//! compliance changes by along the path, `N_p N_r c_pr'(s) / 2` for each of both pairs, joins the parametric term.

use super::lines::LinesOfAction;
use crate::contact::candidate::Candidate;
use gearbench_integrators::dense_solve::solve_in_place;

/// Pairs of a line that are solved for together: more are never in contact at once.
const MOST: usize = 6;

/// Corrections of the gaps before a pair's state is held to be settled.
const MAX_ITERATIONS: usize = 40;

impl LinesOfAction {
    /// Whether pairs bend one body.
    pub fn couples(&self) -> bool {
        self.stiffness.coupled_pitches() > 0
    }

    /// Whether two candidates belong to one slice and flank side.
    pub fn on_one_line(&self, a: &Candidate, b: &Candidate) -> bool {
        a.slot / self.pairs == b.slot / self.pairs
    }

    /// Compliance between two candidates [m/N] and its derivative by the mean of how far both have moved along the
    /// normal [1/N]; `None` where they share no body.
    #[inline]
    pub fn compliance(&self, a: &Candidate, b: &Candidate) -> Option<(f64, f64)> {
        if a.slot == b.slot || !self.on_one_line(a, b) {
            return None;
        }
        let pitches = a.points[0].tooth.index.abs_diff(b.points[0].tooth.index) as usize;
        let (c, slope) = self.stiffness.coupling(pitches, 0.5 * (a.s + b.s));
        if c == 0.0 && slope == 0.0 {
            return None;
        }
        let weight = self.slices[self.lines[a.slot / self.pairs].slice].weight;
        Some((c / weight, slope / (weight * self.helix_cos)))
    }

    /// Opens the gaps of candidates by what the forces of their neighbours give. `closed` says of a slot whether it
    /// follows its smooth branch (`Some(true)`), is open, or is told by its gap (`None`).
    pub(super) fn couple(&self, found: &mut [Candidate], closed: impl Fn(usize) -> Option<bool>) {
        if !self.couples() {
            return;
        }
        let mut rest = found;
        while let Some(first) = rest.first() {
            let line = first.slot / self.pairs;
            let n = rest.partition_point(|c| c.slot / self.pairs == line);
            let (group, others) = rest.split_at_mut(n);
            // One pair has no neighbour.
            if n > 1 {
                self.couple_line(&mut group[..n.min(MOST)], &closed);
            }
            rest = others;
        }
    }

    /// Semismooth Newton: `r = g - g0 - C N(g)`, `J = I - C dN/dg`; as many rounds as pairs open or close for a linear
    /// law.
    fn couple_line(&self, group: &mut [Candidate], closed: &impl Fn(usize) -> Option<bool>) {
        let n = group.len();
        let mut c = [0.0; MOST * MOST];
        let mut coupled = false;
        for i in 0..n {
            for j in 0..i {
                if let Some((value, _)) = self.compliance(&group[i], &group[j]) {
                    (c[i * n + j], c[j * n + i]) = (value, value);
                    coupled |= value != 0.0;
                }
            }
        }
        if !coupled {
            return;
        }
        let mut gap0 = [0.0; MOST];
        for (g, p) in gap0.iter_mut().zip(&*group) {
            *g = p.gap;
        }
        let (mut force, mut slope) = ([0.0; MOST], [0.0; MOST]);
        let mut pressed = [false; MOST];
        for round in 0..MAX_ITERATIONS {
            let mut changed = round == 0;
            for i in 0..n {
                let opened: f64 = (0..n).map(|j| c[i * n + j] * force[j]).sum();
                let presses = closed(group[i].slot).unwrap_or(gap0[i] + opened < 0.0);
                changed |= presses != pressed[i];
                pressed[i] = presses;
            }
            for i in 0..n {
                (force[i], slope[i]) = (0.0, 0.0);
                if pressed[i] {
                    let f = self
                        .elastic
                        .smooth(group[i].gap, 0.0, 0.0, group[i].stiffness);
                    (force[i], slope[i]) = (f.n, f.dn_dg);
                }
            }
            let (mut matrix, mut rhs) = ([0.0; MOST * MOST], [0.0; MOST]);
            let mut worst = 0.0_f64;
            for i in 0..n {
                let mut opened = 0.0;
                for j in 0..n {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    matrix[i * n + j] = unit - c[i * n + j] * slope[j];
                    opened += c[i * n + j] * force[j];
                }
                rhs[i] = group[i].gap - gap0[i] - opened;
                worst = worst.max(rhs[i].abs() / (gap0[i].abs() + opened.abs() + 1e-12));
            }
            if worst <= 1e-15 && !changed {
                return;
            }
            if solve_in_place(&mut matrix[..n * n], &mut rhs[..n]).is_err() {
                break;
            }
            let mut moved = 0.0_f64;
            for (p, d) in group.iter_mut().zip(&rhs) {
                p.gap -= d;
                moved = moved.max(d.abs() / (p.gap.abs() + 1e-12));
            }
            if moved <= 1e-15 && !changed {
                return;
            }
        }
        // A stalled solve must not pass for a force.
        for p in group {
            p.gap = f64::NAN;
        }
    }
}
