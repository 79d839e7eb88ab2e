//! Point-based (dual) solve for contacts with fewer points than nodes: residual compliance and dashpots point by
//! point.
//!
//! With the compliance between points `C_pr = w_p . R w_r` the gaps under elastic forces solve
//!
//! ```text
//! g_p - g0_p - sum_r C_pr n_r(g_r) = 0
//! ```
//!
//! and with the mobility `Y_pr` (velocity of the gap of one point by a force at another, over the half kick) the forces
//! with dashpots
//!
//! ```text
//! N_p = n_p(g_p, r_p),   g = g0 + C N,   r = D (r* + Y N),   D = (I + C K)^-1
//! ```
//!
//! which [`DissipativeSolve`](super::DissipativeSolve) solves over the nodes; `D` and `K` are defined there. Newton's
//! method on either has as many unknowns as there are points. Its start depends only on the present points.
//!
//! Bodies that are damped in proportion to their stiffness, without dashpots at points, have the first problem again: the
//! gap that the law sees is `s = g0 + beta b0 + (C + beta Y) N` with the rate `b0` before the forces act
//! ([`retarded`]). One solve gives the forces; the elastic gap under the same state then follows from one linear step,
//! whose error is of second order in the damping. Only the small force along the path uses it.

use super::compliance::Block;
use super::descent::{Descent, norm_of};
use super::spring::{Spring, deepest, elastic_at};
use crate::law::{SeenBy, retarded};
use gearbench_integrators::dense_solve::Lu;
use gearbench_integrators::system::Singular;

/// Fraction of an approach taken by the law of a point, as initial guess of the solve by gaps.
const LAW_PART: f64 = 0.2;

/// Rounding of gaps relative to the deepest.
const ROUNDING: f64 = 4e-16;

/// Residual of the gaps, relative to the deepest, at which a solve ends that no longer reduces it.
const ENDS: f64 = 1e-12;

/// Largest number of Newton iterations.
const MOST_ITERATIONS: usize = 50;

/// Point-based solves with their buffers.
#[derive(Clone, Debug, Default)]
pub struct PointBasedSolve {
    /// Products `R w_r` of each point.
    columns: Vec<f64>,
    /// Columns of the mobility.
    line: Vec<f64>,
    /// Compliance `C` between points, row-major [m/N].
    compliance: Vec<f64>,
    /// Mobility `Y`, then `D Y`, row-major [m/s/N]; to be set before a solve with dashpots.
    pub mobility: Vec<f64>,
    /// Mobility `Y` where `mobility` has become `D Y` and flanks have a retardation time; empty otherwise.
    before: Vec<f64>,
    /// Gaps that the laws see without forces [m], and their change by the forces, row-major [m/N], of a solve by gaps.
    unloaded: Vec<f64>,
    response: Vec<f64>,
    /// Gaps [m], later forces [N].
    gaps: Vec<f64>,
    residual: Vec<f64>,
    matrix: Vec<f64>,
    step: Vec<f64>,
    descent: Descent,
    factor: Lu,
}

/// Adds `A w` of a point to `out`, with the blocks of `A`.
fn add_column(blocks: &[Block], matrix: &[f64], s: &Spring, out: &mut [f64]) {
    let mut begin = 0;
    for b in blocks {
        let of_block = &matrix[begin..][..b.len * b.len];
        begin += b.len * b.len;
        for (&node, w) in s.nodes.iter().zip(s.weights) {
            let Some(local) = (node as usize).checked_sub(b.start).filter(|l| *l < b.len) else {
                continue;
            };
            if w == 0.0 {
                continue;
            }
            let row = &of_block[local * b.len..][..b.len];
            for (x, a) in out[b.start..][..b.len].iter_mut().zip(row) {
                *x += w * a;
            }
        }
    }
}

/// Computes `W^T A W`, row-major, and the columns `A W`.
fn between(
    springs: &[Spring],
    (blocks, matrix): (&[Block], &[f64]),
    n: usize,
    columns: &mut Vec<f64>,
    out: &mut Vec<f64>,
) {
    columns.clear();
    columns.resize(springs.len() * n, 0.0);
    for (s, column) in springs.iter().zip(columns.chunks_exact_mut(n)) {
        add_column(blocks, matrix, s, column);
    }
    out.clear();
    for s in springs {
        out.extend(columns.chunks_exact(n).map(|column| s.along(column)));
    }
}

/// Adds the product `A x` with a square matrix to `y`.
fn add_product(a: &[f64], x: impl Iterator<Item = f64> + Clone, y: &mut [f64]) {
    let n = y.len().max(1);
    for (y, row) in y.iter_mut().zip(a.chunks_exact(n)) {
        *y += row.iter().zip(x.clone()).map(|(a, x)| a * x).sum::<f64>();
    }
}

impl PointBasedSolve {
    /// Solves for gaps and elastic forces of the points with the compliance of `n` nodes; returns false where Newton's
    /// method does not converge.
    pub(super) fn press(
        &mut self,
        springs: &mut [Spring],
        compliance: (&[Block], &[f64]),
        n: usize,
    ) -> Result<bool, Singular> {
        between(
            springs,
            compliance,
            n,
            &mut self.columns,
            &mut self.compliance,
        );
        self.unloaded.clear();
        self.unloaded.extend(springs.iter().map(|s| s.gap0));
        self.response.clone_from(&self.compliance);
        self.settle(springs)
    }

    /// Solves for gaps and forces of the points at the end of an impulse, where their laws have no dashpots and bodies
    /// follow with a retardation time; [`Self::mobility`] is that of the points. Returns false where Newton's method does
    /// not converge or the change of a gap by the retardation is bounded.
    pub(super) fn press_retarded(
        &mut self,
        springs: &mut [Spring],
        compliance: (&[Block], &[f64]),
        n: usize,
    ) -> Result<bool, Singular> {
        let points = springs.len();
        between(
            springs,
            compliance,
            n,
            &mut self.columns,
            &mut self.compliance,
        );
        // A gap without overlap has no retardation.
        let time = |s: &Spring| if s.gap0 < 0.0 { s.retardation } else { 0.0 };
        self.unloaded.clear();
        self.unloaded
            .extend(springs.iter().map(|s| s.gap0 + time(s) * s.rate_before));
        self.response.clear();
        let rows = self.compliance.chunks_exact(points);
        for (s, (c, y)) in springs
            .iter()
            .zip(rows.zip(self.mobility.chunks_exact(points)))
        {
            self.response
                .extend(c.iter().zip(y).map(|(c, y)| c + time(s) * y));
        }
        if !self.settle(springs)? {
            return Ok(false);
        }
        // Gaps under compliance, and what they lack to the elastic gaps.
        self.step.clear();
        for (i, (s, seen)) in springs.iter().zip(&self.gaps).enumerate() {
            let under = |matrix: &[f64]| -> f64 {
                let row = matrix[i * points..][..points].iter();
                row.zip(&*springs).map(|(a, s)| a * s.force.n).sum()
            };
            let gap = s.gap0 + under(&self.compliance);
            let before = s.rate_before + under(&self.mobility);
            let (_, by) = retarded(gap, [s.gap0, before], s.retardation);
            if s.gap0 < 0.0 && by.rate != s.retardation {
                return Ok(false);
            }
            self.residual[i] = gap;
            self.step.push(gap - seen);
        }
        self.linearise(springs, |s| -s.force.dn_dg, false)?;
        self.factor.solve(&mut self.step);
        for (i, s) in springs.iter_mut().enumerate() {
            let (gap, change) = (self.residual[i], self.step[i]);
            s.elastic = (
                s.gap + change,
                (s.force.n + s.force.dn_dg * change).max(0.0),
            );
            s.elastic_stiffness = -s.force.dn_dg;
            s.seen_by = SeenBy {
                gap: 1.0,
                rate: time(s),
            };
            s.gap = gap;
        }
        Ok(true)
    }

    /// Runs Newton's method on the gaps that the laws see.
    fn settle(&mut self, springs: &mut [Spring]) -> Result<bool, Singular> {
        self.gaps.clear();
        (self.gaps).extend(self.unloaded.iter().map(|gap| LAW_PART * gap.min(0.0)));
        let largest = (self.unloaded.iter()).fold(0.0_f64, |d, gap| d.max(gap.abs()));
        let mut norm = self.yield_to(springs);
        for _ in 0..MOST_ITERATIONS {
            if norm.is_nan() {
                return Err(Singular);
            }
            if norm <= ROUNDING * largest {
                return Ok(true);
            }
            self.step.clear();
            self.step.extend_from_slice(&self.residual);
            self.linearise(springs, |s| -s.force.dn_dg, true)?;
            self.factor.solve(&mut self.step);
            let before = norm;
            let mut length = 1.0;
            self.move_gaps(-length);
            norm = self.yield_to(springs);
            if norm >= before && before <= ENDS * largest {
                // Rounding ends the descent.
                return Ok(true);
            }
            while norm >= before && length > 1e-3 {
                length *= 0.5;
                self.move_gaps(length);
                norm = self.yield_to(springs);
            }
            if norm >= before {
                break;
            }
        }
        Ok(false)
    }

    fn move_gaps(&mut self, by: f64) {
        for (g, d) in self.gaps.iter_mut().zip(&self.step) {
            *g += by * d;
        }
    }

    /// Computes the elastic forces at the gaps, the residual of the gaps, and its norm.
    fn yield_to(&mut self, springs: &mut [Spring]) -> f64 {
        self.residual.clear();
        for ((s, gap), unloaded) in springs.iter_mut().zip(&self.gaps).zip(&self.unloaded) {
            s.gap = *gap;
            s.force = elastic_at(s, *gap);
            self.residual.push(unloaded - gap);
        }
        let forces = springs.iter().map(|s| s.force.n);
        add_product(&self.response, forces, &mut self.residual);
        self.residual.iter_mut().for_each(|x| *x = -*x);
        norm_of(&self.residual)
    }

    /// Computes the factor of `I + A K`, with the response of the gaps in a solve as `A` or with `C`.
    fn linearise(
        &mut self,
        springs: &[Spring],
        k: impl Fn(&Spring) -> f64,
        response: bool,
    ) -> Result<(), Singular> {
        let points = springs.len();
        self.matrix.clear();
        let a = if response {
            &self.response
        } else {
            &self.compliance
        };
        for (i, row) in a.chunks_exact(points).enumerate() {
            self.matrix
                .extend(row.iter().zip(springs).map(|(c, s)| c * k(s)));
            self.matrix[i * points + i] += 1.0;
        }
        self.factor.set(&mut self.matrix, points)
    }

    /// Computes the residual displacements `u = -R F` under the forces of the points.
    pub(super) fn displace(&self, springs: &[Spring], n: usize, u: &mut Vec<f64>) {
        u.clear();
        u.resize(n, 0.0);
        for (s, column) in springs.iter().zip(self.columns.chunks_exact(n)) {
            for (u, r) in u.iter_mut().zip(column) {
                *u -= r * s.force.n;
            }
        }
    }

    /// Computes the mobility between points, whose compliance is known from the solve by gaps, from that of `n` nodes.
    pub fn set_mobility(&mut self, springs: &[Spring], mobility: (&[Block], &[f64]), n: usize) {
        between(springs, mobility, n, &mut self.line, &mut self.mobility);
    }

    /// Computes forces with dashpots of points after the elastic solve, from rates before residual compliance. With
    /// `follows` the rates become those with quasi-statically following nodes. The mobility is overwritten.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite or the iteration does not end.
    pub fn damp(&mut self, springs: &mut [Spring], follows: bool) -> Result<(), Singular> {
        let points = springs.len();
        self.before.clear();
        if follows {
            if springs.iter().any(|s| s.retardation > 0.0) {
                self.before.extend_from_slice(&self.mobility);
            }
            let deepest = deepest(springs);
            self.linearise(springs, |s| s.holding(deepest), false)?;
            self.step.clear();
            self.step.extend(springs.iter().map(|s| s.rate));
            self.factor.solve(&mut self.step);
            for (s, rate) in springs.iter_mut().zip(&self.step) {
                s.rate = *rate;
            }
            // Columns of Y, which is symmetric, are its rows: they become rows of (D Y)^T.
            for row in self.mobility.chunks_exact_mut(points) {
                self.factor.solve(row);
            }
            for i in 0..points {
                for j in 0..i {
                    self.mobility.swap(i * points + j, j * points + i);
                }
            }
        }
        self.gaps.clear();
        self.gaps.extend(springs.iter().map(|s| s.force.n));
        let linear = springs.iter().all(|s| s.law.is_piecewise_linear());
        self.descent.begin(linear);
        let mut norm = self.push(springs);
        for _ in 0..MOST_ITERATIONS {
            if !norm.is_finite() {
                return Err(Singular);
            }
            if self.descent.ends(norm, norm_of(&self.gaps), springs) {
                return Ok(());
            }
            self.matrix.clear();
            let rows = self.compliance.chunks_exact(points);
            for (i, (c, y)) in rows.zip(self.mobility.chunks_exact(points)).enumerate() {
                let (slopes, retarded) = (&springs[i].force, springs[i].retarded_damping());
                let (damped, before) = match self.before.get(i * points..(i + 1) * points) {
                    None => (retarded - slopes.dn_dgdot, None),
                    Some(before) => (-slopes.dn_dgdot, Some(before)),
                };
                let entries = c.iter().zip(y);
                (self.matrix).extend(entries.map(|(c, y)| -slopes.dn_dg * c + damped * y));
                let row = &mut self.matrix[i * points..];
                for (x, y) in row.iter_mut().zip(before.into_iter().flatten()) {
                    *x += retarded * y;
                }
                row[i] += 1.0;
            }
            self.factor.set(&mut self.matrix, points)?;
            self.step.clear();
            self.step.extend_from_slice(&self.residual);
            self.factor.solve(&mut self.step);
            let mut length = 1.0;
            self.move_gaps(length);
            norm = self.push(springs);
            while self.descent.halves(length, norm) {
                length *= 0.5;
                self.move_gaps(-length);
                norm = self.push(springs);
            }
        }
        Err(Singular)
    }

    /// Computes gaps and forces of the points under the forces in `gaps`, and the residual of the forces and its norm.
    fn push(&mut self, springs: &mut [Spring]) -> f64 {
        let (points, forces) = (springs.len(), &self.gaps);
        self.residual.clear();
        let rows = self.compliance.chunks_exact(points);
        for (i, (c, y)) in rows.zip(self.mobility.chunks_exact(points)).enumerate() {
            let sum = |row: &[f64]| -> f64 { row.iter().zip(forces).map(|(a, f)| a * f).sum() };
            let s = &mut springs[i];
            let answer = sum(y);
            let before = match self.before.get(i * points..(i + 1) * points) {
                None => answer,
                Some(row) => sum(row),
            };
            s.press(s.gap0 + sum(c), s.rate + answer, s.rate_before + before);
            self.residual.push(s.force.n - forces[i]);
        }
        norm_of(&self.residual)
    }
}
