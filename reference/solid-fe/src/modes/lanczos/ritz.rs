//! Ritz pairs of the basis: convergence, restarts, and the last step of inverse iteration.

use super::{Lanczos, TOLERANCE};
use crate::modes::dense::{adjoint_product, eigen, product, residuals};
use crate::modes::{Modes, ModesError, Symmetric};
use crate::solve::{Cholesky, Scalar};
use faer::{Mat, MatRef, Par};

/// Ritz values `theta`, descending, with vectors and estimated residuals.
pub(super) struct Ritz<T: Scalar> {
    pub(super) theta: Vec<f64>,
    vectors: Mat<T>,
    residuals: Vec<f64>,
}

impl<T: Scalar> Lanczos<T> {
    pub(super) fn ritz(&self) -> Result<Ritz<T>, ModesError> {
        let m = self.size;
        let (values, vectors) = eigen(self.projected.as_ref().submatrix(0, 0, m, m))?;
        let descending = Mat::from_fn(m, m, |i, j| vectors[(i, m - 1 - j)]);
        let theta: Vec<f64> = values.into_iter().rev().collect();
        let last = descending.subrows(m - self.block, self.block);
        let rest = product(self.coupling.as_ref(), last);
        let norm = |j: usize| {
            (0..self.block)
                .map(|i| rest[(i, j)].modulus2())
                .sum::<f64>()
                .sqrt()
        };
        let residuals = (0..m).map(norm).collect();
        Ok(Ritz {
            theta,
            vectors: descending,
            residuals,
        })
    }

    /// Leading Ritz pairs that have all converged.
    pub(super) fn converged(&self, ritz: &Ritz<T>) -> usize {
        let fine = |(t, r): &(&f64, &f64)| **t > 0.0 && **r <= TOLERANCE * **t;
        ritz.theta
            .iter()
            .zip(&ritz.residuals)
            .take_while(fine)
            .count()
    }

    /// Replaces the basis by its leading Ritz vectors; the last block stays.
    pub(super) fn restart(&mut self, ritz: &Ritz<T>, keep: usize) {
        let kept = self.combined(ritz.vectors.as_ref().subcols(0, keep));
        let last = self.basis.subcols(self.size, self.block).to_owned();
        self.basis.as_mut().subcols_mut(0, keep).copy_from(&kept);
        self.basis
            .as_mut()
            .subcols_mut(keep, self.block)
            .copy_from(&last);
        for j in 0..keep {
            for i in 0..keep {
                self.projected[(i, j)] = T::real(if i == j { ritz.theta[j] } else { 0.0 });
            }
        }
        self.size = keep;
        self.restarted = true;
        self.report.restarts += 1;
    }

    pub(super) fn combined(&self, coefficients: MatRef<'_, T>) -> Mat<T> {
        product(self.basis.subcols(0, self.size), coefficients)
    }

    /// The lowest `count` modes, improved once more, with their true residuals.
    pub fn modes(
        &self,
        factor: &Cholesky<T>,
        stiffness: &Symmetric<T>,
        count: usize,
    ) -> Result<Modes<T>, ModesError> {
        let mut report = self.report;
        if count == 0 {
            return Ok(Modes {
                omega2: Vec::new(),
                vectors: Mat::zeros(self.mass.size(), 0),
                residuals: Vec::new(),
                report,
            });
        }
        let ritz = self.ritz()?;
        let count = count.min(ritz.theta.len());
        let mut x = self.combined(ritz.vectors.as_ref().subcols(0, count));
        // (K - sigma M) y = M x: then y^H (K - sigma M) y = y^H M x.
        let mut mx = Mat::zeros(x.nrows(), count);
        self.mass.apply(x.as_ref(), mx.as_mut());
        for j in 0..count {
            // Scaled so that y is about x.
            let scale = T::real(1.0 / ritz.theta[j]);
            for i in 0..mx.nrows() {
                mx[(i, j)] *= scale;
            }
        }
        x.copy_from(&mx);
        const TOGETHER: usize = 32;
        let mut first = 0;
        while first < count {
            let width = TOGETHER.min(count - first);
            factor.solve_many(x.as_mut().subcols_mut(first, width), Par::Seq);
            report.solves += width;
            first += width;
        }
        let elastic = adjoint_product(x.as_ref(), mx.as_ref());
        self.mass.apply(x.as_ref(), mx.as_mut());
        let inertial = adjoint_product(x.as_ref(), mx.as_ref());
        // Both are nearly diagonal: orthonormalise by the inertial one, then diagonalise the elastic one.
        let (lambda, u) = eigen(inertial.as_ref())?;
        let to_unit = Mat::from_fn(count, count, |i, j| {
            u[(i, j)] * T::real(1.0 / lambda[j].sqrt())
        });
        let half = product(elastic.as_ref(), to_unit.as_ref());
        let small = adjoint_product(to_unit.as_ref(), half.as_ref());
        let (shifted, s) = eigen(small.as_ref())?;
        let rotation = product(to_unit.as_ref(), s.as_ref());
        let vectors = product(x.as_ref(), rotation.as_ref());
        let omega2: Vec<f64> = shifted.iter().map(|l| l + self.shift).collect();
        let residuals = residuals(stiffness, &self.mass, &omega2, vectors.as_ref(), self.shift);
        Ok(Modes {
            omega2,
            vectors,
            residuals,
            report,
        })
    }
}
