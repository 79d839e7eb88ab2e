//! Hard contact without penalty: gaps that do not become negative.
//!
//! One multiplier per slave node, its force `lambda_k`, and the gap there averaged with the node's shape function over
//! the areas `A_p` of the points (mortar; of points at nodes the gap itself):
//!
//! ```text
//! G_k = sum_p c_kp g_p,    c_kp = phi_k(p) A_p / sum_p phi_k(p) A_p,    N_p = sum_k c_kp lambda_k
//! 0 <= lambda _|_ G >= 0,    G = G_0 + C lambda,    C = W R W^T,    W_k = sum_p c_kp w_p
//! ```
//!
//! With compliant slave nodes `C` is positive definite and the forces are unique (R. W. Cottle, J.-S. Pang,
//! R. E. Stone, *The Linear Complementarity Problem*, 1992). Closed nodes are found by the primal-dual active set, and,
//! should that cycle, one by one (C. L. Lawson, R. J. Hanson, *Solving Least Squares Problems*, 1974, ch. 23). As
//! everywhere the result is that of the final set, wherever the search began.

use super::compliance::Block;
use super::spring::Spring;
use crate::cholesky::{backward, cholesky, dot, forward};
use gearbench_integrators::system::Singular;

/// Number of changes of the set of closed nodes after which nodes are added one by one.
const MOST_CHANGES: usize = 30;
/// Relative gap or force below which rounding may have decided whether a node is closed.
const DOUBT: f64 = 1e-12;

/// Entry of the constraint matrix `c`: constraint, point, weight.
pub type Share = (u32, u32, f64);

/// Solve of the linear complementarity problem, with its buffers.
#[derive(Clone, Debug, Default)]
pub struct HardSolve {
    m: usize,
    /// Gaps `G_0` and `G` [m], multipliers `lambda` [N].
    gap0: Vec<f64>,
    gap: Vec<f64>,
    force: Vec<f64>,
    /// Rows of `W` and of `W R`, by constraint.
    rows: Vec<f64>,
    responses: Vec<f64>,
    /// Compliance `C` between constraints, row-major [m/N].
    c: Vec<f64>,
    shares: Vec<Share>,
    closed: Vec<bool>,
    /// Indices of the closed constraints, their part of `C`, and a right-hand side.
    set: Vec<usize>,
    small: Vec<f64>,
    rhs: Vec<f64>,
    u: Vec<f64>,
}

impl HardSolve {
    /// Solves for the forces of the points and returns the residual displacements by node. `shares` are the entries of
    /// `c` for `m` constraints, `compliance` is `R` of each block, `closed` is the initial set of closed constraints.
    ///
    /// # Errors
    /// [`Singular`] where `C` is not positive definite.
    pub fn solve(
        &mut self,
        blocks: &[Block],
        compliance: &[f64],
        springs: &mut [Spring],
        (m, shares): (usize, &[Share]),
        closed: &[bool],
    ) -> Result<&[f64], Singular> {
        let n: usize = blocks.iter().map(|b| b.len).sum();
        self.m = m;
        self.shares.clear();
        self.shares.extend_from_slice(shares);
        self.take_rows(n, blocks, compliance, springs);
        for begin in [closed, &[]] {
            self.closed.clear();
            self.closed.extend_from_slice(begin);
            if begin.is_empty() {
                self.closed.extend(self.gap0.iter().map(|g| *g < 0.0));
            }
            if !self.change_sets()? {
                self.one_by_one()?;
            }
            if !self.is_doubtful() {
                break;
            }
        }
        self.u.clear();
        self.u.resize(n, 0.0);
        for k in 0..m {
            for (u, y) in self.u.iter_mut().zip(&self.responses[k * n..][..n]) {
                *u -= self.force[k] * y;
            }
        }
        for s in springs.iter_mut() {
            s.gap = s.gap0 - s.along(&self.u);
            s.force = Default::default();
        }
        for &(k, p, c) in &self.shares {
            springs[p as usize].force.n += c * self.force[k as usize];
        }
        for s in springs.iter_mut() {
            s.elastic = (s.gap, s.force.n);
        }
        Ok(&self.u)
    }

    /// Returns the forces of the constraints [N].
    pub fn forces(&self) -> &[f64] {
        &self.force
    }

    /// Returns the gaps of the constraints [m].
    pub fn gaps(&self) -> &[f64] {
        &self.gap
    }

    /// Converts changes `h` of the gaps before residual compliance into changes of the forces, point by point.
    ///
    /// # Errors
    /// [`Singular`] where `C` is not positive definite.
    pub fn tangent(&mut self, h: &mut [f64]) -> Result<(), Singular> {
        self.take_set();
        self.rhs.clear();
        self.rhs.resize(self.m, 0.0);
        for &(k, p, c) in &self.shares {
            self.rhs[k as usize] -= c * h[p as usize];
        }
        let set = &self.set;
        let mut x: Vec<f64> = set.iter().map(|&k| self.rhs[k]).collect();
        cholesky(&mut self.small, set.len())?;
        forward(&self.small, &mut x);
        backward(&self.small, &mut x);
        self.rhs.fill(0.0);
        for (&k, x) in set.iter().zip(&x) {
            self.rhs[k] = *x;
        }
        h.fill(0.0);
        for &(k, p, c) in &self.shares {
            h[p as usize] += c * self.rhs[k as usize];
        }
        Ok(())
    }

    /// Computes `G_0`, `W`, `W R` and `C`.
    fn take_rows(&mut self, n: usize, blocks: &[Block], compliance: &[f64], springs: &[Spring]) {
        let m = self.m;
        self.gap0.clear();
        self.gap0.resize(m, 0.0);
        self.rows.clear();
        self.rows.resize(m * n, 0.0);
        for &(k, p, c) in &self.shares {
            let s = &springs[p as usize];
            self.gap0[k as usize] += c * s.gap0;
            s.add(c, &mut self.rows[k as usize * n..][..n]);
        }
        self.responses.clear();
        self.responses.resize(m * n, 0.0);
        for k in 0..m {
            let mut begin = 0;
            for b in blocks {
                let row = &self.rows[k * n + b.start..][..b.len];
                for (i, y) in self.responses[k * n + b.start..][..b.len]
                    .iter_mut()
                    .enumerate()
                {
                    *y = dot(row, &compliance[begin + i * b.len..][..b.len]);
                }
                begin += b.len * b.len;
            }
        }
        self.c.clear();
        for k in 0..m {
            for l in 0..m {
                let (row, response) = (&self.rows[k * n..][..n], &self.responses[l * n..][..n]);
                self.c.push(dot(row, response));
            }
        }
    }

    /// Copies the closed part of `C` into `small`.
    fn take_set(&mut self) {
        self.set.clear();
        self.set.extend((0..self.m).filter(|k| self.closed[*k]));
        self.small.clear();
        for &k in &self.set {
            for &l in &self.set {
                self.small.push(self.c[k * self.m + l]);
            }
        }
    }

    /// Computes the forces that close the closed constraints, and all gaps.
    fn close(&mut self) -> Result<(), Singular> {
        self.take_set();
        self.rhs.clear();
        self.rhs.extend(self.set.iter().map(|&k| -self.gap0[k]));
        cholesky(&mut self.small, self.set.len())?;
        forward(&self.small, &mut self.rhs);
        backward(&self.small, &mut self.rhs);
        self.force.clear();
        self.force.resize(self.m, 0.0);
        for (&k, x) in self.set.iter().zip(&self.rhs) {
            self.force[k] = *x;
        }
        self.gap.clear();
        for k in 0..self.m {
            let way = dot(&self.c[k * self.m..][..self.m], &self.force);
            self.gap.push(if self.closed[k] {
                0.0
            } else {
                self.gap0[k] + way
            });
        }
        Ok(())
    }

    /// Runs the primal-dual active-set method; returns false where the set does not converge.
    fn change_sets(&mut self) -> Result<bool, Singular> {
        for _ in 0..MOST_CHANGES {
            self.close()?;
            let mut settled = true;
            for k in 0..self.m {
                let now = if self.closed[k] {
                    self.force[k] > 0.0
                } else {
                    self.gap[k] < 0.0
                };
                settled &= now == self.closed[k];
                self.closed[k] = now;
            }
            if settled {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Closes the deepest constraint, one at a time, and opens constraints with tensile forces.
    fn one_by_one(&mut self) -> Result<(), Singular> {
        self.closed.fill(false);
        let mut held = vec![0.0; self.m];
        self.close()?;
        for _ in 0..100 * (self.m + 1) {
            let open = (0..self.m).filter(|k| !self.closed[*k]);
            let deepest = open.min_by(|a, b| self.gap[*a].total_cmp(&self.gap[*b]));
            let largest = self.gap0.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
            let Some(k) = deepest.filter(|k| self.gap[*k] < -DOUBT * largest) else {
                return Ok(());
            };
            self.closed[k] = true;
            loop {
                self.close()?;
                // As far towards the new forces as none pulls.
                let (mut part, mut first) = (1.0, None);
                for k in 0..self.m {
                    if self.closed[k] && self.force[k] <= 0.0 {
                        let reach = held[k] / (held[k] - self.force[k]);
                        if reach < part || first.is_none() {
                            (part, first) = (reach.min(part), Some(k));
                        }
                    }
                }
                for (h, f) in held.iter_mut().zip(&self.force) {
                    *h += part * (f - *h);
                }
                let Some(k) = first else { break };
                self.closed[k] = false;
                held[k] = 0.0;
            }
        }
        Err(Singular)
    }

    /// Returns true if rounding may have decided on a constraint.
    fn is_doubtful(&self) -> bool {
        let deepest = self.gap0.iter().fold(0.0_f64, |m, g| m.max(-g));
        let strongest = self.force.iter().fold(0.0_f64, |m, f| m.max(*f));
        (0..self.m).any(|k| {
            if self.closed[k] {
                self.force[k] < DOUBT * strongest
            } else {
                self.gap[k] < DOUBT * deepest
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Law;

    /// Builds points on separate nodes of a smooth body, with and without neighbours that rise under load.
    fn problem(m: usize, coupling: f64) -> (Vec<f64>, Vec<Spring>) {
        let distance = |i: usize, j: usize| (i as f64 - j as f64).abs();
        let mut r = Vec::new();
        for i in 0..m {
            for j in 0..m {
                let d = distance(i, j);
                r.push(1e-9 * (-0.7 * d).exp() * (coupling * d).cos());
            }
        }
        let springs = (0..m).map(|i| {
            let (mut nodes, mut weights) = ([0; 8], [0.0; 8]);
            (nodes[0], weights[0]) = (i as u32, 1.0);
            let x = i as f64 - 0.45 * m as f64;
            let gap0 = 1e-6 * (0.15 * x * x - 1.0 + 0.3 * (7.0 * x).sin());
            Spring::new((nodes, weights), (gap0, 0.0), 1.0, Law::elastic())
        });
        (r, springs.collect())
    }

    #[test]
    fn forces_push_and_gaps_stay_open() {
        for (m, coupling) in [(1, 0.0), (8, 0.0), (15, 0.0), (15, 1.0)] {
            let (r, springs) = problem(m, coupling);
            let blocks = [Block { start: 0, len: m }];
            let shares: Vec<Share> = (0..m as u32).map(|k| (k, k, 1.0)).collect();
            let run = |begin: &[bool], single: bool| {
                let mut solve = HardSolve::default();
                let mut s = springs.clone();
                let all = (m, shares.as_slice());
                solve.solve(&blocks, &r, &mut s, all, begin).unwrap();
                if single {
                    solve.one_by_one().unwrap();
                }
                (solve.forces().to_vec(), solve.gaps().to_vec())
            };
            let (forces, gaps) = run(&[], false);
            assert!(forces.iter().all(|f| *f >= 0.0) && gaps.iter().all(|g| *g >= 0.0));
            assert!(forces.iter().zip(&gaps).all(|(f, g)| f * g == 0.0));
            assert!(forces.iter().any(|f| *f > 0.0));
            for k in 0..m {
                let way: f64 = (0..m).map(|l| r[k * m + l] * forces[l]).sum();
                assert!((springs[k].gap0 + way - gaps[k]).abs() < 1e-18);
            }
            // From any set, and node by node.
            for pattern in 0..8 {
                let begin: Vec<bool> = (0..m).map(|k| (k * 7 + pattern) % 3 == 0).collect();
                assert_eq!(run(&begin, false).0, forces, "{m} {coupling}");
            }
            let single = run(&[], true).0;
            for (a, b) in forces.iter().zip(&single) {
                assert!((a - b).abs() < 1e-9, "{a} {b}");
            }
        }
    }

    #[test]
    fn the_tangent_is_the_derivative() {
        let (r, springs) = problem(12, 0.0);
        let blocks = [Block { start: 0, len: 12 }];
        // Averages over neighbours.
        let mut shares: Vec<Share> = vec![];
        for k in 0..6_u32 {
            shares.extend([(k, 2 * k, 0.4), (k, 2 * k + 1, 0.6)]);
        }
        let run = |h: f64| {
            let mut s = springs.clone();
            (s.iter_mut().enumerate()).for_each(|(i, s)| s.gap0 += h * (i as f64).cos());
            let mut solve = HardSolve::default();
            solve.solve(&blocks, &r, &mut s, (6, &shares), &[]).unwrap();
            (solve, s)
        };
        let (mut solve, _) = run(0.0);
        let mut dn: Vec<f64> = (0..12).map(|i| (i as f64).cos()).collect();
        solve.tangent(&mut dn).unwrap();
        let (above, below) = (run(1e-12).1, run(-1e-12).1);
        for i in 0..12 {
            let slope = (above[i].force.n - below[i].force.n) / 2e-12;
            assert!((slope - dn[i]).abs() < 1e-3 * 1e9, "{slope:e} {:e}", dn[i]);
        }
    }
}
