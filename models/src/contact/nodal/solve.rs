//! Node-based solve of contact with residual compliance.
//!
//! The potential `u^T R^-1 u / 2 + sum_p phi(g_p)`, `g_p = g0_p - w_p . u`, is strictly convex. For a linear law and a
//! set of closed points its minimum is that of one small linear system,
//!
//! ```text
//! (R^-1 + S) u = -f0,    S = sum k_p w_p w_p^T,    f0 = -sum k_p g0_p w_p
//! ```
//!
//! and the closed points are found by iteration: a point is closed where its gap is negative. The inverse of `R` is
//! kept while the nodes stay the same. Points of any other law that are fewer than nodes are solved for
//! [by their gaps](PointBasedSolve). Where `R` is all but singular, `R = C C^T`, `u = C y` and
//! `(I + C^T S C) y = -C^T f0` take its place. Other laws take Newton's method on `y` with a line search on the norm of
//! the gradient `y + C^T F`.
//!
//! Here acts the elastic law alone, to which energies belong; dashpots and friction have a solve of their own
//! ([`DissipativeSolve`](super::DissipativeSolve)), which begins where this one ends.
//!
//! Where the iteration begins does not show in the result: that is of the final set alone, and where rounding could
//! decide on that set the search for it begins afresh.

use super::compliance::{Block, Compliance};
use super::point_based::PointBasedSolve;
use super::spring::{CachedDisplacements, Spring, add_points, deepest, elastic_at};
use crate::cholesky::{BandedMatrix, backward, cholesky, dot, forward, padded};
use gearbench_integrators::system::Singular;

/// Number of changes of the set of closed points after which Newton's method with a line search is used.
const MOST_CHANGES: usize = 30;

/// Largest number of Newton iterations.
const MOST_ITERATIONS: usize = 100;

/// Relative gap below which rounding may have decided whether a point is closed.
const DOUBT: f64 = 1e-12;

/// Solve for gaps, elastic forces and residual displacements, with its buffers.
#[derive(Clone, Debug, Default)]
pub struct NodalSolve {
    compliance: Compliance,
    /// Matrix `S`, then `S C`; full rows.
    stiffness: Vec<f64>,
    /// Matrix `I + C^T S C` and its factor.
    small: Vec<f64>,
    /// Matrix `R^-1 + S` and its factor.
    regular: BandedMatrix,
    closed: Vec<bool>,
    y: Vec<f64>,
    trial: Vec<f64>,
    nodal: Vec<f64>,
    /// Residual displacements [m].
    u: Vec<f64>,
    point_based: PointBasedSolve,
    /// True if the last solve was point-based.
    by_points: bool,
}

impl NodalSolve {
    /// Invalidates the data stored by [`Self::set_nodes`] after a change of the compliance.
    pub fn forget(&mut self) {
        self.compliance.forget();
    }

    /// Sets the nodes by their `numbers`, block by block. `fill` writes `R` of a block, row-major, if its nodes differ
    /// from the previous ones.
    pub fn set_nodes(
        &mut self,
        blocks: &[Block],
        numbers: &[u32],
        fill: impl FnMut(usize, &mut [f64]),
    ) {
        self.compliance.set(blocks, numbers, fill);
    }

    /// Solves for gaps and elastic forces of the points and returns the residual displacements by node. `guess` has
    /// approximate displacements, or zeros.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite or Newton's method stalls.
    pub fn solve(&mut self, springs: &mut [Spring], guess: &[f64]) -> Result<&[f64], Singular> {
        self.u.clear();
        self.u.extend_from_slice(guess);
        self.u.resize(self.compliance.n, 0.0);
        self.find(springs)?;
        for s in springs.iter_mut() {
            s.elastic = (s.gap, s.force.n);
            s.elastic_stiffness = -s.force.dn_dg;
        }
        Ok(&self.u)
    }

    /// Returns the residual displacements under the elastic forces of the last solve, by node.
    pub fn displacements(&self) -> &[f64] {
        &self.u
    }

    /// Returns `R` of the nodes, block by block.
    pub fn compliance(&self) -> &[f64] {
        &self.compliance.matrix
    }

    /// Returns the number of nodes.
    pub fn nodes(&self) -> usize {
        self.compliance.n
    }

    /// Returns true if the last solve was point-based.
    pub fn is_by_points(&self) -> bool {
        self.by_points
    }

    /// Returns the point-based solve, for mobilities and dashpots of its points.
    pub fn point_based(&mut self) -> &mut PointBasedSolve {
        &mut self.point_based
    }

    /// Solves for gaps and forces of points without dashpots on bodies with a retardation time, at the end of an impulse
    /// whose mobility the [point-based solve](Self::point_based) has. Returns false where another solve is needed.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite.
    pub fn solve_retarded(&mut self, springs: &mut [Spring]) -> Result<bool, Singular> {
        let compliance = (&*self.compliance.blocks, &*self.compliance.matrix);
        let n = self.compliance.n;
        self.by_points = self.point_based.press_retarded(springs, compliance, n)?;
        Ok(self.by_points)
    }

    /// Returns true if the points are solved for by their gaps: nonlinear laws, and fewer points than nodes.
    pub fn suits_points(&self, springs: &[Spring]) -> bool {
        springs.len() < self.compliance.n && !springs.iter().all(|s| s.law.is_linear_elastic())
    }

    /// Computes the residual displacements under the present forces of the points, after a [point-based](Self::point_based)
    /// solve.
    pub fn displaced(&self, springs: &[Spring], u: &mut Vec<f64>) {
        self.point_based.displace(springs, self.compliance.n, u);
    }

    fn find(&mut self, springs: &mut [Spring]) -> Result<(), Singular> {
        let linear = springs.iter().all(|s| s.law.is_linear_elastic());
        self.by_points = false;
        if self.suits_points(springs) {
            let compliance = (&*self.compliance.blocks, &*self.compliance.matrix);
            self.by_points = self
                .point_based
                .press(springs, compliance, self.compliance.n)?;
            if self.by_points {
                self.point_based
                    .displace(springs, self.compliance.n, &mut self.u);
                return Ok(());
            }
        }
        if linear {
            for attempt in 0..2 {
                self.closed.clear();
                let mut here = CachedDisplacements::default();
                for s in springs.iter() {
                    let gap = s.gap0 - here.along(s, &self.u);
                    self.closed.push(gap < 0.0);
                }
                if !self.closed_points(springs)? {
                    break;
                }
                if attempt > 0 || !is_doubtful(springs) {
                    return Ok(());
                }
                self.u.fill(0.0);
            }
        }
        self.newton(springs)
    }

    /// Iterates on the set of closed points of a linear law; returns false where it does not converge.
    fn closed_points(&mut self, springs: &mut [Spring]) -> Result<bool, Singular> {
        for _ in 0..MOST_CHANGES {
            let closed = std::mem::take(&mut self.closed);
            let pushing = springs.iter().zip(&closed).filter(|(_, closed)| **closed);
            let pushing = pushing.map(|(s, _)| (s, s.stiffness, -s.stiffness * s.gap0));
            let solved = if self.compliance.take_inverse() {
                self.solve_regular(pushing)
            } else {
                self.solve_rooted(pushing)
            };
            self.closed = closed;
            solved?;
            let mut here = CachedDisplacements::default();
            let mut settled = true;
            for (s, closed) in springs.iter_mut().zip(&mut self.closed) {
                s.gap = s.gap0 - here.along(s, &self.u);
                let now = s.gap < 0.0;
                settled &= now == *closed;
                *closed = now;
            }
            if settled {
                for s in springs {
                    s.force = elastic_at(s, s.gap);
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Solves for the displacements of closed points with the inverse of the compliance.
    fn solve_regular<'a>(
        &mut self,
        points: impl Iterator<Item = (&'a Spring, f64, f64)> + Clone,
    ) -> Result<(), Singular> {
        let (n, blocks) = (self.compliance.n, &self.compliance.blocks);
        let of_blocks = blocks.iter().filter(|b| b.len > 0);
        let of_blocks = of_blocks.map(|b| (b.start, b.start + b.len - 1));
        let of_points = points.clone().filter_map(|(s, ..)| s.span());
        self.regular.reset(n, of_blocks.chain(of_points));
        let mut lines = self.compliance.inverse.as_slice();
        for b in &self.compliance.blocks {
            for i in 0..b.len {
                let (line, rest) = lines.split_at(padded(b.len));
                let (places, entries) = self.regular.parts();
                if let Some(place) = places.of(b.start + i, b.start + i) {
                    entries[place..][..b.len - i].copy_from_slice(&line[i..b.len]);
                }
                lines = rest;
            }
        }
        self.u.clear();
        self.u.resize(n, 0.0);
        let (places, entries) = self.regular.parts();
        add_points(points, |i, j| places.of(i, j), entries, &mut self.u);
        for u in &mut self.u {
            *u = -*u;
        }
        self.regular.factorise()?;
        self.regular.solve(&mut self.u);
        Ok(())
    }

    /// Solves for the displacements of closed points with the root of the compliance, where it is nearly singular.
    fn solve_rooted<'a>(
        &mut self,
        points: impl Iterator<Item = (&'a Spring, f64, f64)>,
    ) -> Result<(), Singular> {
        self.compliance.take_root();
        self.assemble(points);
        self.factorise()?;
        self.y.clear();
        self.y.resize(self.compliance.n, 0.0);
        (self.compliance).add_root_transposed(&self.nodal, &mut self.y);
        for y in &mut self.y {
            *y = -*y;
        }
        forward(&self.small, &mut self.y);
        backward(&self.small, &mut self.y);
        self.compliance.displace(&self.y, &mut self.u);
        Ok(())
    }

    /// Runs Newton's method from `y = 0`.
    fn newton(&mut self, springs: &mut [Spring]) -> Result<(), Singular> {
        self.compliance.take_root();
        self.y.clear();
        self.y.resize(self.compliance.n, 0.0);
        let mut norm = self.gradient(springs);
        let first = norm;
        for _ in 0..MOST_ITERATIONS {
            if norm <= 1e-15 * first {
                return Ok(());
            }
            self.linearise(springs)?;
            let mut step = std::mem::take(&mut self.trial);
            forward(&self.small, &mut step);
            backward(&self.small, &mut step);
            let mut length = 1.0;
            let old = norm;
            loop {
                for (y, d) in self.y.iter_mut().zip(&step) {
                    *y -= length * d;
                }
                let full = std::mem::take(&mut step);
                norm = self.gradient(springs);
                step = full;
                if norm < old || length < 1e-9 {
                    break;
                }
                for (y, d) in self.y.iter_mut().zip(&step) {
                    *y += length * d;
                }
                length *= 0.5;
            }
            if norm.is_nan() {
                return Err(Singular);
            }
            // Rounding ends the descent.
            if norm >= old {
                return if norm <= 1e-10 * first {
                    Ok(())
                } else {
                    Err(Singular)
                };
            }
        }
        Err(Singular)
    }

    /// Computes gaps, forces and, in `trial`, the gradient at `y`; returns its norm.
    fn gradient(&mut self, springs: &mut [Spring]) -> f64 {
        self.compliance.displace(&self.y, &mut self.u);
        self.nodal.clear();
        self.nodal.resize(self.compliance.n, 0.0);
        for s in springs.iter_mut() {
            s.gap = s.gap0 - s.along(&self.u);
            s.force = elastic_at(s, s.gap);
            s.add(s.force.n, &mut self.nodal);
        }
        self.trial.clear();
        self.trial.resize(self.compliance.n, 0.0);
        (self.compliance).add_root_transposed(&self.nodal, &mut self.trial);
        for (g, y) in self.trial.iter_mut().zip(&self.y) {
            *g += y;
        }
        dot(&self.trial, &self.trial).sqrt()
    }

    /// Assembles and factorises `I + C^T S C` at the forces of the points.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite.
    pub fn linearise(&mut self, springs: &[Spring]) -> Result<(), Singular> {
        self.compliance.take_root();
        let closed = springs.iter().filter(|s| s.force.dn_dg != 0.0);
        self.assemble(closed.map(|s| (s, -s.force.dn_dg, 0.0)));
        self.factorise()
    }

    /// Assembles and factorises `I + C^T S C` with the stiffness of each point that [supports](Spring::holding) its
    /// nodes.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite.
    pub fn linearise_holding(&mut self, springs: &[Spring]) -> Result<(), Singular> {
        self.compliance.take_root();
        let deepest = deepest(springs);
        let holding = springs.iter().map(|s| (s, s.holding(deepest), 0.0));
        self.assemble(holding.filter(|(_, k, _)| *k > 0.0));
        self.factorise()
    }

    /// Subtracts the quasi-static motion of the nodes from the rates of gaps, with the factor of
    /// [`Self::linearise_holding`].
    pub fn follow(&mut self, springs: &[Spring], rates: &mut [f64], nodes: &mut Vec<f64>) {
        nodes.clear();
        nodes.resize(self.compliance.n, 0.0);
        let deepest = deepest(springs);
        for (s, rate) in springs.iter().zip(&*rates) {
            s.add(s.holding(deepest) * rate, nodes);
        }
        self.apply_compliance(nodes);
        for (s, rate) in springs.iter().zip(rates) {
            *rate -= s.along(nodes);
        }
    }

    /// Applies the compliance in contact with the last factor, `x <- (I + R S)^-1 R x`: the inward displacement of the
    /// nodes under additional forces `x`.
    pub fn apply_compliance(&mut self, x: &mut [f64]) {
        self.nodal.clear();
        self.nodal.extend_from_slice(x);
        self.y.clear();
        self.y.resize(self.compliance.n, 0.0);
        (self.compliance).add_root_transposed(&self.nodal, &mut self.y);
        forward(&self.small, &mut self.y);
        backward(&self.small, &mut self.y);
        self.compliance.displace(&self.y, &mut self.trial);
        x.copy_from_slice(&self.trial);
    }

    /// Assembles `S` and, in `nodal`, `f0`, from points with stiffness and force at zero displacement.
    fn assemble<'a>(&mut self, points: impl Iterator<Item = (&'a Spring, f64, f64)>) {
        let n = self.compliance.n;
        self.stiffness.clear();
        self.stiffness.resize(n * n, 0.0);
        self.nodal.clear();
        self.nodal.resize(n, 0.0);
        add_points(
            points,
            |i, j| Some(i * n + j),
            &mut self.stiffness,
            &mut self.nodal,
        );
    }

    /// Assembles and factorises `small = I + C^T S C`.
    fn factorise(&mut self) -> Result<(), Singular> {
        (self.compliance).congruence(&mut self.stiffness, &mut self.small);
        cholesky(&mut self.small, self.compliance.n)
    }
}

/// Returns true if a point is so close to opening or closing that rounding may have decided.
fn is_doubtful(springs: &[Spring]) -> bool {
    let depth = springs.iter().fold(0.0_f64, |d, s| d.max(-s.gap0));
    springs.iter().any(|s| s.gap.abs() < DOUBT * depth)
}

#[cfg(test)]
mod tests;
