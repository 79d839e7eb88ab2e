//! Shift-invert block Lanczos with thick restart.
//!
//! `A = (K - sigma M)^-1 M` is self-adjoint in the M inner product; its eigenvalues `theta = 1 / (omega^2 - sigma)`
//! are largest for the lowest modes. Each step applies A to the last block of an M-orthonormal basis V, first
//! removes what the last two blocks explain, then projects on the whole basis (full reorthogonalisation), so that
//! `T = V^H M A V` is known exactly. A basis that has grown too long is replaced by its best Ritz vectors (thick
//! restart: K. Wu, H. Simon, SIAM J. Matrix Anal. Appl. 22, 2000). The modes found take one more step of inverse
//! iteration with Rayleigh and Ritz, which takes out the rounding in the high frequencies.
//!
//! It runs on one thread: products and solves of a block are so short that two threads spin at each other's barriers for as
//! long as they gain. 200 modes of 39,240 unknowns take 6.0 s of one processor, on two 6.5 s and 8.5 s of both; beside
//! other work 8.7 s and 16.4 s (`cargo bench --bench cyclic_modes`).

mod ritz;

use super::dense::{adjoint_product, eigen, product};
use super::{ModesError, Symmetric};
use crate::solve::{Cholesky, Scalar};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, Par};
use std::sync::Arc;

/// Work done for a set of modes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Number of factorisations.
    pub factorisations: usize,
    /// Number of solved right-hand sides.
    pub solves: usize,
    /// Number of steps of the iteration, one block each.
    pub steps: usize,
    /// Number of restarts.
    pub restarts: usize,
    /// Largest size of the basis.
    pub subspace: usize,
    /// Modes, from the lowest, that an inertia count proved complete; 0 without a count.
    pub verified: usize,
    /// Memory of the factor [bytes].
    pub factor_bytes: usize,
}

/// Termination criterion of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// So many of the lowest.
    Count(usize),
    /// All modes up to this omega^2 [rad²/s²], and the next one above it.
    Above(f64),
}

/// Returns true if a problem is so small that a full decomposition is cheaper.
pub(super) fn is_small(n: usize, count: usize, block: usize) -> bool {
    n <= 150 || n <= capacity_for(count, block) + 2 * block
}

/// Longest basis for so many modes.
fn capacity_for(count: usize, block: usize) -> usize {
    count + (count / 2).max(5 * block).max(24)
}

/// A Gram matrix of a block whose smallest eigenvalue is this fraction of the largest loses three digits.
const WELL_CONDITIONED: f64 = 1e-6;

/// Residual of the inverse iteration relative to its eigenvalue at which a mode has converged.
const TOLERANCE: f64 = 1e-9;
/// Steps after which the search gives up.
const MAX_STEPS: usize = 2000;

/// State of an iteration; it can be continued to find more modes.
#[derive(Debug)]
pub struct Lanczos<T: Scalar> {
    mass: Arc<Symmetric<T>>,
    shift: f64,
    block: usize,
    /// Basis: `size` vectors that A has been applied to, then the last block.
    basis: Mat<T>,
    size: usize,
    /// M times the last block.
    mass_last: Mat<T>,
    /// `V^H M A V`, of which the leading `size` rows and columns count.
    projected: Mat<T>,
    /// Norms of the last block before it was normalised, as the triangle R of `W = V_last R`.
    coupling: Mat<T>,
    /// True if the last step was a restart: then the whole basis couples with the last block.
    restarted: bool,
    random: u64,
    /// Counters of the work.
    pub report: Report,
}

impl<T: Scalar> Lanczos<T> {
    /// Prepares an iteration with `block` vectors per step, without a solve.
    pub fn new(mass: Arc<Symmetric<T>>, shift: f64, block: usize) -> Self {
        let (n, block) = (mass.size(), block.max(1));
        let mut new = Self {
            mass,
            shift,
            block,
            basis: Mat::zeros(n, 0),
            size: 0,
            mass_last: Mat::zeros(n, block),
            projected: Mat::zeros(0, 0),
            coupling: Mat::zeros(block, block),
            restarted: true,
            random: 0x9e37_79b9_7f4a_7c15,
            report: Report::default(),
        };
        new.grow(block);
        new
    }

    /// Makes room for a basis of `capacity` vectors and a last block.
    fn grow(&mut self, capacity: usize) {
        let columns = capacity + self.block;
        if self.basis.ncols() < columns {
            self.basis
                .resize_with(self.basis.nrows(), columns, |_, _| T::real(0.0));
            self.projected
                .resize_with(columns, columns, |_, _| T::real(0.0));
        }
    }

    fn random(&mut self) -> f64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    fn randomise(&mut self, mut x: MatMut<'_, T>) {
        for j in 0..x.ncols() {
            for i in 0..x.nrows() {
                x[(i, j)] = T::real(self.random());
            }
        }
    }

    /// Iterates until the target is reached.
    pub fn run(&mut self, factor: &Cholesky<T>, target: Target) -> Result<usize, ModesError> {
        let n = self.mass.size();
        if self.size == 0 && self.report.steps == 0 {
            let mut w = Mat::zeros(n, self.block);
            self.randomise(w.as_mut());
            // One application of A takes the high frequencies out of the random start.
            self.mass.apply(w.as_ref(), self.mass_last.as_mut());
            w.copy_from(&self.mass_last);
            self.solve(factor, w.as_mut());
            self.normalise(w, 0)?;
        }
        let mut wanted = match target {
            Target::Count(count) => count,
            Target::Above(_) => self.size.max(self.block),
        };
        let mut capacity = capacity_for(wanted, self.block).min(n.saturating_sub(self.block));
        self.grow(capacity);
        let mut next_check = wanted;
        loop {
            if self.size >= next_check {
                let ritz = self.ritz()?;
                let converged = self.converged(&ritz);
                let enough = match target {
                    Target::Count(count) => converged >= count,
                    Target::Above(omega2) => {
                        converged > 0 && self.omega2(ritz.theta[converged - 1]) > omega2
                    }
                };
                if enough {
                    return Ok(converged);
                }
                if self.report.steps >= MAX_STEPS || self.size + self.block > n {
                    return Err(ModesError::NotConverged {
                        found: converged,
                        wanted,
                        steps: self.report.steps,
                    });
                }
                if let Target::Above(omega2) = target {
                    // The Ritz values give an estimate of their number.
                    let below = (ritz.theta.iter()).filter(|t| self.omega2(**t) <= omega2);
                    wanted = wanted.max(below.count() + 1);
                    capacity = capacity_for(wanted, self.block).min(n - self.block);
                    self.grow(capacity);
                }
                next_check = self.size + 2 * self.block;
                if self.size + self.block > capacity {
                    let keep = (wanted + (capacity - wanted) / 3).min(self.size - self.block);
                    self.restart(&ritz, keep.max(converged));
                    next_check = capacity.min(self.size + 4 * self.block);
                }
            }
            next_check = next_check.min(capacity.saturating_sub(self.block) + 1);
            if self.size + 2 * self.block > self.basis.ncols() {
                // Nearly all modes there are: no room for another block.
                return Err(ModesError::NotConverged {
                    found: self.found()?.len(),
                    wanted,
                    steps: self.report.steps,
                });
            }
            self.step(factor)?;
        }
    }

    /// Returns the squares of the angular frequencies computed so far without a gap, ascending [rad²/s²].
    pub fn found(&self) -> Result<Vec<f64>, ModesError> {
        if self.size == 0 {
            return Ok(Vec::new());
        }
        let ritz = self.ritz()?;
        let converged = self.converged(&ritz);
        Ok(ritz.theta[..converged]
            .iter()
            .map(|t| self.omega2(*t))
            .collect())
    }

    fn omega2(&self, theta: f64) -> f64 {
        self.shift + 1.0 / theta
    }

    fn solve(&mut self, factor: &Cholesky<T>, x: MatMut<'_, T>) {
        self.report.solves += x.ncols();
        factor.solve_many(x, Par::Seq);
    }

    /// Applies A to the last block and makes the new part the next block.
    fn step(&mut self, factor: &Cholesky<T>) -> Result<(), ModesError> {
        let mut w = self.mass_last.clone();
        self.solve(factor, w.as_mut());
        let (old, all) = (self.size, self.size + self.block);
        // What the neighbouring blocks explain first; the rest of the basis is then left with little.
        let near = if self.restarted {
            0
        } else {
            old.saturating_sub(self.block)
        };
        let mut h = Mat::zeros(all, self.block);
        for from in [near, 0] {
            let removed = self.remove(w.as_mut(), from, all);
            let mut rows = h.as_mut().subrows_mut(from, all - from);
            rows += &removed;
        }
        for j in 0..self.block {
            for i in 0..all {
                self.projected[(i, old + j)] = h[(i, j)];
                self.projected[(old + j, i)] = h[(i, j)].conjugate();
            }
        }
        let half = T::real(0.5);
        for j in 0..self.block {
            for i in 0..self.block {
                self.projected[(old + i, old + j)] =
                    half * (h[(old + i, j)] + h[(old + j, i)].conjugate());
            }
        }
        self.size = all;
        self.restarted = false;
        self.report.steps += 1;
        self.report.subspace = self.report.subspace.max(all);
        self.normalise(w, all)
    }

    /// Takes the part along basis vectors `from..to` out of `w`; returns the coefficients.
    fn remove(&self, mut w: MatMut<'_, T>, from: usize, to: usize) -> Mat<T> {
        let mut mw = Mat::zeros(w.nrows(), w.ncols());
        self.mass.apply(w.as_ref(), mw.as_mut());
        let v = self.basis.subcols(from, to - from);
        let h = adjoint_product(v, mw.as_ref());
        matmul(w.as_mut(), Accum::Add, v, &h, T::real(-1.0), Par::Seq);
        h
    }

    /// Makes `w` M-orthonormal and the last block, behind `size` vectors; keeps the triangle that it had.
    ///
    /// Orthonormal by the eigenvectors of its Gram matrix (A. Stathopoulos, K. Wu, SIAM J. Sci. Comput. 23, 2002),
    /// which is repeated until the Gram matrix is well conditioned.
    fn normalise(&mut self, mut w: Mat<T>, size: usize) -> Result<(), ModesError> {
        let (n, b) = (w.nrows(), self.block);
        let mut coupling = Mat::<T>::identity(b, b);
        let mut mw = Mat::zeros(n, b);
        let mut spare = Mat::zeros(n, b);
        let combine = |x: &mut Mat<T>, spare: &mut Mat<T>, by: &Mat<T>| {
            matmul(
                spare.as_mut(),
                Accum::Replace,
                &*x,
                by,
                T::real(1.0),
                Par::Seq,
            );
            std::mem::swap(x, spare);
        };
        self.mass.apply(w.as_ref(), mw.as_mut());
        for _ in 0..5 {
            let gram = adjoint_product(w.as_ref(), mw.as_ref());
            let (lambda, u) = eigen(gram.as_ref())?;
            let top = lambda[b - 1];
            if top.is_nan() || top <= 0.0 {
                return Err(ModesError::Matrix(
                    "the mass matrix is not positive definite",
                ));
            }
            let floor = 1e-26 * top;
            // W <- W U lambda^-1/2, R <- lambda^1/2 U^H R.
            let forward = Mat::from_fn(b, b, |i, j| {
                u[(i, j)] * T::real(1.0 / lambda[j].max(floor).sqrt())
            });
            let back = Mat::from_fn(b, b, |i, j| {
                u[(j, i)].conjugate() * T::real(lambda[i].max(0.0).sqrt())
            });
            combine(&mut w, &mut spare, &forward);
            combine(&mut mw, &mut spare, &forward);
            coupling = product(back.as_ref(), coupling.as_ref());
            if lambda[0] > 0.5 * top {
                break;
            }
            if lambda[0] <= WELL_CONDITIONED * top {
                // Small vectors have been blown up, and with them what rounding left along the basis. Where the
                // Krylov space is exhausted any other direction continues.
                for j in (0..b).filter(|&j| lambda[j] <= floor) {
                    self.randomise(w.as_mut().subcols_mut(j, 1));
                }
                if size > 0 {
                    self.remove(w.as_mut(), 0, size);
                }
                self.mass.apply(w.as_ref(), mw.as_mut());
            }
        }
        self.mass_last = mw;
        self.basis.as_mut().subcols_mut(size, b).copy_from(&w);
        self.coupling = coupling;
        Ok(())
    }
}
