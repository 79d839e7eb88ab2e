//! Elastic coupling of pairs on one line of action through the common body.
//!
//! The stiffness `k(s)` of a pair is that of the pair alone; a force on another pair of the same slice, `r`, opens its
//! gap by `c_pr N_r`, the deflection of tooth roots, rim and disc that both share:
//!
//! ```text
//! g_p = g0_p + sum over r != p of c_pr N_r(g_r),    N = k d^n
//! V = sum W(g_p) + sum over p < r of c_pr N_p N_r,  F = -dV/dq
//! ```
//!
//! with elastic forces, so that the forces are those of one potential; a damper receives the rate of `g0`. The change
//! of the compliance along the path, `N_p N_r c_pr'(s) / 2` for each of both pairs, is added to the parametric term.

use super::lines::LinesOfAction;
use crate::contact::candidate::Candidate;
use gearbench_integrators::dense_solve::solve_in_place;

/// Largest number of pairs on a line that are in contact at once.
pub const MOST_ON_LINE: usize = 6;
const MOST: usize = MOST_ON_LINE;

/// Largest number of Newton corrections of the gaps.
const MAX_ITERATIONS: usize = 40;

impl LinesOfAction {
    /// Returns true if pairs are coupled through a common body.
    pub fn couples(&self) -> bool {
        self.stiffness.coupled_pitches() > 0
    }

    /// Returns true if two candidates belong to one slice and flank side.
    pub fn on_one_line(&self, a: &Candidate, b: &Candidate) -> bool {
        a.slot / self.pairs == b.slot / self.pairs
    }

    /// Returns the compliance between two candidates [m/N] and its derivative by the mean of both displacements along
    /// the normal [1/N]; `None` where they have no common body.
    #[inline]
    pub fn compliance(&self, a: &Candidate, b: &Candidate) -> Option<(f64, f64)> {
        if a.slot == b.slot || !self.on_one_line(a, b) {
            return None;
        }
        let teeth = [a, b].map(|c| c.points[0].tooth.index);
        self.between(a.slot / self.pairs, teeth, [a.s, b.s])
    }

    /// Returns the compliance between two pairs of a line, from their teeth of the first gear and their path
    /// coordinates.
    #[inline]
    pub(super) fn between(&self, l: usize, teeth: [i64; 2], s: [f64; 2]) -> Option<(f64, f64)> {
        let pitches = teeth[0].abs_diff(teeth[1]) as usize;
        let (c, slope) = self.stiffness.coupling(pitches, 0.5 * (s[0] + s[1]));
        if c == 0.0 && slope == 0.0 {
            return None;
        }
        let weight = self.slices[self.lines[l].slice].weight;
        Some((c / weight, slope / (weight * self.helix_cos)))
    }

    /// Adds the elastic effect of neighbouring forces to the gaps of candidates. `closed` returns for a slot whether
    /// it follows its smooth branch (`Some(true)`), is open, or depends on its gap (`None`).
    pub(super) fn couple(&self, found: &mut [Candidate], closed: impl Fn(usize) -> Option<bool>) {
        if !self.couples() {
            return;
        }
        let mut rest = found;
        while let Some(first) = rest.first() {
            let index = first.slot / self.pairs;
            let n = rest.partition_point(|c| c.slot / self.pairs == index);
            let (group, others) = rest.split_at_mut(n);
            // One pair has no neighbour.
            if n > 1 {
                let group = &mut group[..n.min(MOST)];
                let mut line = Group::default();
                for c in &*group {
                    let tooth = c.points[0].tooth.index;
                    line.add(tooth, c.s, c.stiffness, c.gap, closed(c.slot));
                }
                self.settle(index, &mut line);
                for (c, gap) in group.iter_mut().zip(line.gap) {
                    c.gap = gap;
                }
            }
            rest = others;
        }
    }

    /// Computes the compliances between the pairs of a line; returns false where there are none.
    fn compliances(&self, l: usize, g: &Group, c: &mut [f64; MOST * MOST]) -> bool {
        let n = g.n;
        let mut coupled = false;
        for i in 0..n {
            for j in 0..i {
                let teeth = [g.tooth[i], g.tooth[j]];
                if let Some((value, _)) = self.between(l, teeth, [g.s[i], g.s[j]]) {
                    (c[i * n + j], c[j * n + i]) = (value, value);
                    coupled |= value != 0.0;
                }
            }
        }
        coupled
    }

    /// Adds the elastic effect of neighbouring forces to the gaps of pairs of a line.
    pub(super) fn settle(&self, l: usize, g: &mut Group) {
        let mut c = [0.0; MOST * MOST];
        if g.n < 2 || !self.compliances(l, g, &mut c) {
            return;
        }
        let settled =
            self.elastic.is_linear_elastic() && settle_two_loaded(g, &c) || self.iterate(g, &c);
        if !settled {
            // A stalled solve must not pass for a force.
            g.gap = [f64::NAN; MOST];
        }
    }

    /// Solves by a semismooth Newton method: `r = g - g0 - C N(g)`, `J = I - C dN/dg`. For a linear law it takes as
    /// many iterations as pairs open or close. Returns false where it stalls.
    fn iterate(&self, g: &mut Group, c: &[f64; MOST * MOST]) -> bool {
        let n = g.n;
        let gap0 = g.gap;
        let (mut force, mut slope) = ([0.0; MOST], [0.0; MOST]);
        let mut pressed = [false; MOST];
        for round in 0..MAX_ITERATIONS {
            let mut changed = round == 0;
            for i in 0..n {
                let opened: f64 = (0..n).map(|j| c[i * n + j] * force[j]).sum();
                let presses = g.closed[i].unwrap_or(gap0[i] + opened < 0.0);
                changed |= presses != pressed[i];
                pressed[i] = presses;
            }
            for i in 0..n {
                (force[i], slope[i]) = (0.0, 0.0);
                if pressed[i] {
                    let f = self.elastic.smooth(g.gap[i], 0.0, 0.0, g.stiffness[i]);
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
                rhs[i] = g.gap[i] - gap0[i] - opened;
                worst = worst.max(rhs[i].abs() / (gap0[i].abs() + opened.abs() + 1e-12));
            }
            if worst <= 1e-15 && !changed {
                return true;
            }
            if solve_in_place(&mut matrix[..n * n], &mut rhs[..n]).is_err() {
                return false;
            }
            let mut moved = 0.0_f64;
            for (gap, d) in g.gap.iter_mut().zip(&rhs[..n]) {
                *gap -= d;
                moved = moved.max(d.abs() / (gap.abs() + 1e-12));
            }
            if moved <= 1e-15 && !changed {
                return true;
            }
        }
        false
    }
}

/// Pairs of a line in the coupled solve.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Group {
    pub(super) n: usize,
    /// Tooth numbers of the first gear.
    tooth: [i64; MOST],
    /// Path coordinates [m].
    s: [f64; MOST],
    /// Stiffness of each pair, in [N/m] for a linear law.
    stiffness: [f64; MOST],
    /// Gap of each pair [m].
    pub(super) gap: [f64; MOST],
    /// State of each pair: on its smooth branch, open, or dependent on its gap (`None`).
    closed: [Option<bool>; MOST],
}

impl Group {
    /// Adds a pair; there is space for [`MOST_ON_LINE`].
    #[inline]
    pub(super) fn add(
        &mut self,
        tooth: i64,
        s: f64,
        stiffness: f64,
        gap: f64,
        closed: Option<bool>,
    ) {
        let i = self.n;
        if i < MOST {
            self.tooth[i] = tooth;
            self.s[i] = s;
            self.stiffness[i] = stiffness;
            self.gap[i] = gap;
            self.closed[i] = closed;
            self.n += 1;
        }
    }
}

/// Solves for the gaps of pairs with a linear law of which at most two are loaded, without a matrix: `g_1 + c k_2 g_2 =
/// g0_1`, `c k_1 g_1 + g_2 = g0_2`. It iterates until the loaded pairs are those that were assumed. Returns false,
/// without a change, where more are loaded.
fn settle_two_loaded(g: &mut Group, c: &[f64; MOST * MOST]) -> bool {
    let n = g.n;
    let gap0 = g.gap;
    let mut gap = gap0;
    let mut before = 0_u32;
    for round in 0..MAX_ITERATIONS {
        let (mut pressed, mut few, mut count) = (0_u32, [0; 2], 0);
        for i in 0..n {
            if g.closed[i].unwrap_or(gap[i] < 0.0) {
                pressed |= 1 << i;
                if count == 2 {
                    return false;
                }
                few[count] = i;
                count += 1;
            }
        }
        if round > 0 && pressed == before {
            g.gap = gap;
            return gap[..n].iter().all(|gap| gap.is_finite());
        }
        before = pressed;
        let [i, j] = few;
        let mut force = [0.0; 2];
        if count == 1 {
            force[0] = -g.stiffness[i] * gap0[i];
        } else if count == 2 {
            let c = c[i * n + j];
            let (a, b) = (c * g.stiffness[j], c * g.stiffness[i]);
            let determinant = 1.0 - a * b;
            force = [
                -g.stiffness[i] * (gap0[i] - a * gap0[j]) / determinant,
                -g.stiffness[j] * (gap0[j] - b * gap0[i]) / determinant,
            ];
        }
        for k in 0..n {
            // Nothing opens a pair by its own force.
            gap[k] = gap0[k] + c[k * n + i] * force[0] + c[k * n + j] * force[1];
        }
    }
    false
}
