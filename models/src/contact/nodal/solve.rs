//! Contact with residual compliance, solved for on the nodes.
//!
//! The potential `u^T R^-1 u / 2 + sum_p phi(g_p)`, `g_p = g0_p - w_p . u`, is strictly convex. For a linear law and a
//! set of closed points its minimum is that of one small linear system,
//!
//! ```text
//! (R^-1 + S) u = -f0,    S = sum k_p w_p w_p^T,    f0 = -sum k_p g0_p w_p
//! ```
//!
//! and the closed points are found by iteration: a point is closed where its gap is negative. The inverse of `R` is
//! kept while the nodes stay the same. Where `R` is all but singular, `R = C C^T`, `u = C y` and
//! `(I + C^T S C) y = -C^T f0` take its place. Other laws take Newton's method on `y` with a line search on the norm of
//! the gradient `y + C^T F`.
//!
//! Dampers use the rate of the gap before residual compliance and act on the points that the elastic law alone
//! closes; a damped point does not pull. The elastic part is kept: energies belong to it.
//!
//! Where the iteration begins does not show in the result: that is of the final set alone, and where rounding could
//! decide on that set the search for it begins afresh.

use crate::cholesky::{
    append_inverse, backward, cholesky, cholesky_padded, dot, forward, padded, solve_padded,
};
use crate::law::{Law, LawForce};
use gearbench_integrators::system::Singular;

/// Mark of what a gear without a field does not have.
pub const UNUSED: u32 = u32::MAX;

/// Changes of the set of closed points after which Newton's method with a line search takes over.
const MOST_CHANGES: usize = 30;
/// Newton iterations before the solve is given up.
const MOST_ITERATIONS: usize = 100;
/// Relative gap below which rounding could have decided whether a point is closed.
const DOUBT: f64 = 1e-12;
/// Relative pivot below which a direction of the compliance is none.
const RANK: f64 = 1e-13;
/// Relative pivot of the compliance from which on its inverse serves.
const REGULAR: f64 = 1e-8;

/// A point of the solve.
#[derive(Clone, Copy, Debug)]
pub struct Spring {
    /// Solved nodes; those it does not lie on have no weight.
    pub nodes: [u32; 8],
    /// Their weights.
    pub weights: [f64; 8],
    /// Gap before residual compliance [m].
    pub gap0: f64,
    /// Its rate [m/s].
    pub rate: f64,
    /// Stiffness of the law.
    pub stiffness: f64,
    /// Its law, with the damper of the point.
    pub law: Law,
    /// Result: gap with residual compliance [m].
    pub gap: f64,
    /// Result: normal force and derivatives; zero where it is open.
    pub force: LawForce,
    /// Result: gap [m] and normal force [N] of the elastic law alone.
    pub elastic: (f64, f64),
}

impl Spring {
    /// `w . u`.
    #[inline]
    pub fn along(&self, u: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (&i, w) in self.nodes.iter().zip(&self.weights) {
            sum += w * u[i as usize];
        }
        sum
    }

    /// `f += x w`.
    #[inline]
    pub fn add(&self, x: f64, f: &mut [f64]) {
        for (&i, w) in self.nodes.iter().zip(&self.weights) {
            f[i as usize] += x * w;
        }
    }
}

/// Nodes of one gear in the solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Its first node.
    pub start: usize,
    /// Its number of nodes.
    pub len: usize,
}

/// What acts: the elastic law alone, or with dampers on the points that it closes.
#[derive(Clone, Copy, PartialEq)]
enum Stage {
    Elastic,
    Damped,
}

/// The solve and its buffers.
#[derive(Clone, Debug, Default)]
pub struct NodalSolve {
    blocks: Vec<Block>,
    numbers: Vec<u32>,
    n: usize,
    /// `R` of the blocks, one `len x len` matrix after the other.
    compliance: Vec<f64>,
    /// Their inverses, rows padded, where all are regular.
    inverse: Vec<f64>,
    regular: bool,
    /// Whether `root` is that of the present nodes.
    rooted: bool,
    /// Lower triangles `C` of the blocks, one `len x len` matrix after the other.
    root: Vec<f64>,
    /// `S`, then `S C`; full rows.
    stiffness: Vec<f64>,
    /// `I + C^T S C` and its factor.
    small: Vec<f64>,
    closed: Vec<bool>,
    y: Vec<f64>,
    trial: Vec<f64>,
    nodal: Vec<f64>,
    /// Residual displacements [m].
    u: Vec<f64>,
}

impl NodalSolve {
    /// The compliance changes: what [`Self::set_nodes`] keeps is of no use any more.
    pub fn forget(&mut self) {
        self.n = 0;
        self.numbers.clear();
        self.blocks.clear();
    }

    /// Takes the nodes: their `numbers`, by which they are known again, block by block. `fill` writes `R` of each block,
    /// one row-major matrix after the other.
    pub fn set_nodes(&mut self, blocks: &[Block], numbers: &[u32], fill: impl FnOnce(&mut [f64])) {
        if self.n > 0 && self.blocks == blocks && self.numbers == numbers {
            return;
        }
        self.blocks.clear();
        self.blocks.extend_from_slice(blocks);
        self.numbers.clear();
        self.numbers.extend_from_slice(numbers);
        self.n = numbers.len();
        self.compliance.clear();
        let size = blocks.iter().map(|b| b.len * b.len).sum();
        self.compliance.resize(size, 0.0);
        fill(&mut self.compliance);
        if self.n == 0 {
            // One node that does not give way: points without weights need no case of their own.
            self.blocks.push(Block { start: 0, len: 1 });
            self.compliance.push(0.0);
            self.n = 1;
        }
        self.rooted = false;
        self.regular = true;
        self.inverse.clear();
        let mut begin = 0;
        for b in &self.blocks {
            let r = &self.compliance[begin..][..b.len * b.len];
            begin += b.len * b.len;
            let stride = padded(b.len);
            self.small.clear();
            self.small.resize(b.len * stride, 0.0);
            let mut largest = 0.0_f64;
            for (i, line) in r.chunks_exact(b.len.max(1)).enumerate() {
                self.small[i * stride..][..b.len].copy_from_slice(line);
                largest = largest.max(line[i]);
            }
            self.regular &= cholesky_padded(&mut self.small, b.len).is_ok();
            let pivot = |i: usize| self.small[i * stride + i].powi(2);
            self.regular &= (0..b.len).all(|i| pivot(i) >= REGULAR * largest);
            if !self.regular {
                break;
            }
            append_inverse(&self.small, b.len, &mut self.stiffness, &mut self.inverse);
        }
    }

    /// `C`, where it is not there yet.
    fn take_root(&mut self) {
        if self.rooted {
            return;
        }
        self.rooted = true;
        self.root.clear();
        self.root.extend_from_slice(&self.compliance);
        let mut begin = 0;
        for b in &self.blocks {
            root_of(&mut self.root[begin..][..b.len * b.len], b.len);
            begin += b.len * b.len;
        }
    }

    /// Solves for gaps and forces of the points and for the residual displacements, returned by node. `guess` are
    /// displacements near those sought, or zeros.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite or Newton's method stalls.
    pub fn solve(&mut self, springs: &mut [Spring], guess: &[f64]) -> Result<&[f64], Singular> {
        self.u.clear();
        self.u.extend_from_slice(guess);
        self.u.resize(self.n, 0.0);
        self.stage(springs, Stage::Elastic)?;
        for s in springs.iter_mut() {
            s.elastic = (s.gap, s.force.n);
        }
        if springs.iter().any(|s| s.law.is_dissipative()) {
            self.stage(springs, Stage::Damped)?;
        }
        Ok(&self.u)
    }

    /// `R` of the nodes, block by block.
    #[must_use]
    pub fn compliance(&self) -> &[f64] {
        &self.compliance
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.n
    }

    fn stage(&mut self, springs: &mut [Spring], stage: Stage) -> Result<(), Singular> {
        let linear = springs.iter().all(|s| s.law.exponent() == 1.0);
        if linear {
            for attempt in 0..2 {
                self.closed.clear();
                let mut here = Gathered::default();
                for s in springs.iter() {
                    let gap = s.gap0 - here.along(s, &self.u);
                    self.closed.push(pushes(s, gap, stage));
                }
                if !self.closed_points(springs, stage)? {
                    break;
                }
                let doubtful = attempt == 0 && self.is_doubtful(springs, stage);
                if !doubtful {
                    return Ok(());
                }
                self.u.fill(0.0);
            }
        }
        self.newton(springs, stage)
    }

    /// Whether a point is so near to opening or closing that rounding may have decided.
    fn is_doubtful(&self, springs: &[Spring], stage: Stage) -> bool {
        let depth = springs.iter().fold(0.0_f64, |d, s| d.max(-s.gap0));
        springs.iter().any(|s| {
            let x = match stage {
                Stage::Elastic => s.gap,
                Stage::Damped => s.gap - law_push(s) / s.stiffness,
            };
            x.abs() < DOUBT * depth
        })
    }

    /// Iterates on the set of closed points of a linear law; false where it does not settle.
    fn closed_points(&mut self, springs: &mut [Spring], stage: Stage) -> Result<bool, Singular> {
        for _ in 0..MOST_CHANGES {
            let closed = std::mem::take(&mut self.closed);
            let pushing = springs.iter().zip(&closed).filter(|(_, closed)| **closed);
            let pushing = pushing.map(|(s, _)| {
                let push = match stage {
                    Stage::Elastic => 0.0,
                    Stage::Damped => law_push(s),
                };
                (s, s.stiffness, push - s.stiffness * s.gap0)
            });
            let solved = if self.regular {
                self.solve_regular(pushing)
            } else {
                self.solve_rooted(pushing)
            };
            self.closed = closed;
            solved?;
            let mut here = Gathered::default();
            let mut settled = true;
            for (s, closed) in springs.iter_mut().zip(&mut self.closed) {
                s.gap = s.gap0 - here.along(s, &self.u);
                let now = pushes(s, s.gap, stage);
                settled &= now == *closed;
                *closed = now;
            }
            if settled {
                for s in springs {
                    s.force = force_at(s, s.gap, stage);
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Displacements of closed points by the inverse of the compliance.
    fn solve_regular<'a>(
        &mut self,
        points: impl Iterator<Item = (&'a Spring, f64, f64)>,
    ) -> Result<(), Singular> {
        let stride = padded(self.n);
        self.small.clear();
        self.small.resize(self.n * stride, 0.0);
        let mut lines = self.inverse.as_slice();
        for b in &self.blocks {
            for i in b.start..b.start + b.len {
                let (line, rest) = lines.split_at(padded(b.len));
                self.small[i * stride + b.start..][..b.len].copy_from_slice(&line[..b.len]);
                lines = rest;
            }
        }
        self.u.clear();
        self.u.resize(self.n, 0.0);
        add_points(points, stride, &mut self.small, &mut self.u);
        for u in &mut self.u {
            *u = -*u;
        }
        cholesky_padded(&mut self.small, self.n)?;
        solve_padded(&self.small, &mut self.u);
        Ok(())
    }

    /// The same by its root.
    fn solve_rooted<'a>(
        &mut self,
        points: impl Iterator<Item = (&'a Spring, f64, f64)>,
    ) -> Result<(), Singular> {
        self.take_root();
        self.assemble(points);
        self.factorise()?;
        self.y.clear();
        self.y.resize(self.n, 0.0);
        self.times_root_transposed();
        for y in &mut self.y {
            *y = -*y;
        }
        forward(&self.small, &mut self.y);
        backward(&self.small, &mut self.y);
        self.displace();
        Ok(())
    }

    /// Newton's method from `y = 0`.
    fn newton(&mut self, springs: &mut [Spring], stage: Stage) -> Result<(), Singular> {
        self.take_root();
        self.y.clear();
        self.y.resize(self.n, 0.0);
        let mut norm = self.gradient(springs, stage);
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
                norm = self.gradient(springs, stage);
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

    /// Gaps, forces and, in `trial`, the gradient at `y`; returns its norm.
    fn gradient(&mut self, springs: &mut [Spring], stage: Stage) -> f64 {
        self.displace();
        self.nodal.clear();
        self.nodal.resize(self.n, 0.0);
        for s in springs.iter_mut() {
            s.gap = s.gap0 - s.along(&self.u);
            s.force = force_at(s, s.gap, stage);
            s.add(s.force.n, &mut self.nodal);
        }
        let y = std::mem::take(&mut self.y);
        self.y = std::mem::take(&mut self.trial);
        self.y.clear();
        self.y.resize(self.n, 0.0);
        self.times_root_transposed();
        self.trial = std::mem::replace(&mut self.y, y);
        for (g, y) in self.trial.iter_mut().zip(&self.y) {
            *g += y;
        }
        dot(&self.trial, &self.trial).sqrt()
    }

    /// `I + C^T S C` and its factor at the forces of the points.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite.
    pub fn linearise(&mut self, springs: &[Spring]) -> Result<(), Singular> {
        self.take_root();
        let closed = springs.iter().filter(|s| s.force.dn_dg != 0.0);
        self.assemble(closed.map(|s| (s, -s.force.dn_dg, 0.0)));
        self.factorise()
    }

    /// `x <- (I + R S)^-1 R x` with the last factor: how nodes give way, inwards, when forces on them grow by `x`.
    pub fn apply_compliance(&mut self, x: &mut [f64]) {
        self.nodal.clear();
        self.nodal.extend_from_slice(x);
        self.y.clear();
        self.y.resize(self.n, 0.0);
        self.times_root_transposed();
        forward(&self.small, &mut self.y);
        backward(&self.small, &mut self.y);
        self.displace();
        x.copy_from_slice(&self.u);
    }

    /// `S` and, in `nodal`, `f0`, from points with stiffness and force without displacement.
    fn assemble<'a>(&mut self, points: impl Iterator<Item = (&'a Spring, f64, f64)>) {
        let n = self.n;
        self.stiffness.clear();
        self.stiffness.resize(n * n, 0.0);
        self.nodal.clear();
        self.nodal.resize(n, 0.0);
        add_points(points, n, &mut self.stiffness, &mut self.nodal);
    }

    /// `small = I + C^T S C`, factorised.
    fn factorise(&mut self) -> Result<(), Singular> {
        let n = self.n;
        self.small.clear();
        self.small.resize(n * n, 0.0);
        // Rows of S C in place: column j of C begins at row j, so columns to the left are still needed last.
        let mut begin = 0;
        for b in &self.blocks {
            let root = &self.root[begin..][..b.len * b.len];
            for row in self.stiffness.chunks_exact_mut(n) {
                let part = &mut row[b.start..][..b.len];
                for j in 0..b.len {
                    let mut sum = 0.0;
                    for i in j..b.len {
                        sum += part[i] * root[i * b.len + j];
                    }
                    part[j] = sum;
                }
            }
            begin += b.len * b.len;
        }
        let mut begin = 0;
        for b in &self.blocks {
            let root = &self.root[begin..][..b.len * b.len];
            for i in 0..b.len {
                let line = &self.stiffness[(b.start + i) * n..][..n];
                for j in 0..=i {
                    let c = root[i * b.len + j];
                    let row = &mut self.small[(b.start + j) * n..][..=b.start + j];
                    for (x, y) in row.iter_mut().zip(line) {
                        *x += c * y;
                    }
                }
            }
            begin += b.len * b.len;
        }
        for i in 0..n {
            self.small[i * n + i] += 1.0;
        }
        cholesky(&mut self.small, n)
    }

    /// `y += C^T nodal`.
    fn times_root_transposed(&mut self) {
        let mut begin = 0;
        for b in &self.blocks {
            let y = &mut self.y[b.start..][..b.len];
            for i in 0..b.len {
                let f = self.nodal[b.start + i];
                let row = &self.root[begin + i * b.len..][..=i];
                for (y, c) in y.iter_mut().zip(row) {
                    *y += c * f;
                }
            }
            begin += b.len * b.len;
        }
    }

    /// `u = C y`.
    fn displace(&mut self) {
        self.u.clear();
        self.u.resize(self.n, 0.0);
        let mut begin = 0;
        for b in &self.blocks {
            let y = &self.y[b.start..][..b.len];
            for i in 0..b.len {
                self.u[b.start + i] = dot(&self.root[begin + i * b.len..][..=i], y);
            }
            begin += b.len * b.len;
        }
    }
}

/// Displacements at the nodes of a point, kept for its neighbours on the same faces.
#[derive(Default)]
struct Gathered {
    nodes: [u32; 8],
    u: [f64; 8],
    filled: bool,
}

impl Gathered {
    /// `w . u` of a point.
    #[inline]
    fn along(&mut self, s: &Spring, u: &[f64]) -> f64 {
        if !self.filled || self.nodes != s.nodes {
            self.nodes = s.nodes;
            self.u = s.nodes.map(|i| u[i as usize]);
            self.filled = true;
        }
        let mut pairs = [0.0; 4];
        for j in 0..4 {
            pairs[j] = s.weights[j] * self.u[j] + s.weights[4 + j] * self.u[4 + j];
        }
        (pairs[0] + pairs[2]) + (pairs[1] + pairs[3])
    }
}

/// Adds stiffness `k w w^T` and force `f w` of points to a matrix and a vector, face by face.
#[inline]
fn add_points<'a>(
    points: impl Iterator<Item = (&'a Spring, f64, f64)>,
    stride: usize,
    matrix: &mut [f64],
    vector: &mut [f64],
) {
    let (mut nodes, mut filled) = ([0; 8], false);
    let (mut s, mut f) = ([[0.0; 8]; 8], [0.0; 8]);
    let mut flush = |nodes: &[u32; 8], s: &mut [[f64; 8]; 8], f: &mut [f64; 8]| {
        for i in 0..8 {
            let at = nodes[i] as usize;
            let row = &mut matrix[at * stride..][..stride];
            for j in 0..8 {
                row[nodes[j] as usize] += s[i][j];
            }
            vector[at] += f[i];
        }
        *s = [[0.0; 8]; 8];
        *f = [0.0; 8];
    };
    for (spring, k, force) in points {
        if nodes != spring.nodes {
            if filled {
                flush(&nodes, &mut s, &mut f);
            }
            nodes = spring.nodes;
        }
        filled = true;
        let w = &spring.weights;
        for i in 0..8 {
            let kw = k * w[i];
            for j in 0..8 {
                s[i][j] += kw * w[j];
            }
            f[i] += force * w[i];
        }
    }
    if filled {
        flush(&nodes, &mut s, &mut f);
    }
}

/// What the damper of a point pushes.
#[inline]
fn law_push(s: &Spring) -> f64 {
    s.law.smooth(0.0, s.rate, 0.0, s.stiffness).n
}

/// Whether a point with a linear law pushes at a gap.
#[inline]
fn pushes(s: &Spring, gap: f64, stage: Stage) -> bool {
    match stage {
        Stage::Elastic => gap < 0.0,
        Stage::Damped => s.elastic.1 > 0.0 && law_push(s) - s.stiffness * gap > 0.0,
    }
}

/// Force of a point at a gap; zero where it is open or would pull.
#[inline]
fn force_at(s: &Spring, gap: f64, stage: Stage) -> LawForce {
    let force = match stage {
        Stage::Elastic if gap >= 0.0 => return LawForce::default(),
        Stage::Elastic => s.law.smooth(gap, 0.0, 0.0, s.stiffness),
        Stage::Damped if s.elastic.1 == 0.0 => return LawForce::default(),
        Stage::Damped => s.law.smooth(gap, s.rate, 0.0, s.stiffness),
    };
    if force.n < 0.0 {
        LawForce::default()
    } else {
        force
    }
}

/// `C` with `R = C C^T` in place; directions in which `R` has nothing but rounding are left out.
fn root_of(r: &mut [f64], n: usize) {
    let largest = (0..n).fold(0.0_f64, |m, i| m.max(r[i * n + i]));
    for j in 0..n {
        let row = r[j * n..][..j].iter();
        let pivot = r[j * n + j] - row.map(|x| x * x).sum::<f64>();
        let root = if pivot > RANK * largest {
            pivot.sqrt()
        } else {
            0.0
        };
        r[j * n + j] = root;
        for i in j + 1..n {
            r[j * n + i] = 0.0;
            let (above, below) = r.split_at_mut(i * n);
            let x = below[j] - dot(&below[..j], &above[j * n..][..j]);
            below[j] = if root > 0.0 { x / root } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests;
