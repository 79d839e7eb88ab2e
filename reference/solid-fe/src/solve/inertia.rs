//! Inertia of a symmetric matrix: how many eigenvalues are negative.
//!
//! Sylvester: in `A = L D L^T` with unit lower triangle L, D has as many negative entries as A has negative
//! eigenvalues. For `A = K - sigma M` with M positive definite that is the number of eigenvalues of
//! `K phi = lambda M phi` below sigma: a count that no iteration can miss.

use super::{Scalar, SolveError, Symbolic};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{LdltError, LdltRegularization};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::{Par, Side};

/// Number of negative eigenvalues of the matrix whose lower triangle is given.
/// `symbolic` is the analysis of its pattern.
///
/// The factorisation does not pivot: it serves shifts that are not eigenvalues of a leading block to rounding,
/// which a shift in a gap of the spectrum practically never is.
pub fn negative_eigenvalues<T: Scalar>(
    a: SparseColMatRef<'_, usize, T>,
    symbolic: &Symbolic,
) -> Result<usize, SolveError> {
    if !symbolic.fits(a.symbolic()) {
        return Err(SolveError::OtherPattern);
    }
    let unknowns = a.ncols();
    if unknowns == 0 {
        return Ok(0);
    }
    let inner = symbolic.inner();
    let mut values = vec![T::real(0.0); inner.len_val()];
    let scratch = inner.factorize_numeric_ldlt_scratch::<T>(Par::Seq, Default::default());
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| SolveError::TooLarge { unknowns })?;
    inner
        .factorize_numeric_ldlt(
            &mut values,
            a,
            Side::Lower,
            LdltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .map_err(|LdltError::ZeroPivot { index }| SolveError::ZeroPivot {
            unknown: symbolic.original_unknown(index),
        })?;
    let SymbolicCholeskyRaw::Supernodal(supernodes) = inner.raw() else {
        return Ok(0);
    };
    let factor = SupernodalLdltRef::new(supernodes, &values);
    let mut negative = 0;
    for s in 0..supernodes.n_supernodes() {
        let block = factor.supernode(s).val();
        for j in 0..block.ncols() {
            negative += usize::from(faer::traits::math_utils::real(&block[(j, j)]) < 0.0);
        }
    }
    Ok(negative)
}
