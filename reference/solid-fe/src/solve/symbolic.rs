//! Analysis of a pattern: order of elimination, fill, supernodes.

use super::SolveError;
use super::ordering::{self, Order};
use crate::limits;
use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{
    self as sparse, CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw,
    SymmetricOrdering, supernodal::SymbolicSupernodalCholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Supernodes are merged while the zeros this stores stay below the fraction: (columns, fraction).
/// Wider merges than faer's: our matrices come in blocks of three columns, and wide blocks sweep faster.
const RELAXATION: &[(usize, f64)] = &[(12, 0.6), (24, 0.3), (48, 0.12), (usize::MAX, 0.03)];

/// Memory per stored number of a factor, including that of its computation [bytes].
const FACTOR_BYTES: f64 = 14.0;

/// Analysis of a pattern: order, fill, supernodes. Serves every matrix of the pattern, real or complex.
#[derive(Debug)]
pub struct Symbolic {
    inner: SymbolicCholesky<usize>,
    fingerprint: u64,
    pub(super) widest: usize,
    nonzeros: usize,
}

impl Symbolic {
    /// Analyses the pattern of a lower triangle, with the better of the orders.
    pub fn new(pattern: SymbolicSparseColMatRef<'_, usize>) -> Result<Self, SolveError> {
        let (rows, columns) = (pattern.nrows(), pattern.ncols());
        if rows != columns {
            return Err(SolveError::NotSquare { rows, columns });
        }
        Self::ordered(pattern, &ordering::best(pattern))
    }

    pub(super) fn ordered(
        pattern: SymbolicSparseColMatRef<'_, usize>,
        order: &Order,
    ) -> Result<Self, SolveError> {
        let unknowns = pattern.ncols();
        let inner = sparse::factorize_symbolic_cholesky(
            pattern,
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(
                &order.forward,
                &order.inverse,
                unknowns,
            )),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                supernodal_params: SymbolicSupernodalParams {
                    relax: Some(RELAXATION),
                },
                ..Default::default()
            },
        )
        .map_err(|_| SolveError::TooLarge { unknowns })?;
        let bytes = FACTOR_BYTES * inner.len_val() as f64;
        let what = format!("the factor of a matrix of {unknowns} unknowns");
        limits::check(what, bytes, "use fewer elements")?;
        let widest = match inner.raw() {
            SymbolicCholeskyRaw::Supernodal(s) => (0..s.n_supernodes())
                .map(|i| s.supernode_end()[i] - s.supernode_begin()[i] + s.nnz_per_super()[i])
                .max()
                .unwrap_or(0),
            SymbolicCholeskyRaw::Simplicial(_) => 0,
        };
        Ok(Self {
            inner,
            fingerprint: fingerprint(pattern),
            widest,
            nonzeros: order.nonzeros,
        })
    }

    /// Returns the number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.inner.nrows()
    }

    /// Non-zeros of the factor, without the zeros stored to widen blocks.
    pub fn factor_nonzeros(&self) -> usize {
        self.nonzeros
    }

    /// Numbers stored for the factor, with the zeros that widen the blocks.
    pub fn stored(&self) -> usize {
        self.inner.len_val()
    }

    /// Returns true if a matrix has the analysed pattern.
    pub fn fits(&self, pattern: SymbolicSparseColMatRef<'_, usize>) -> bool {
        pattern.ncols() == self.unknowns() && fingerprint(pattern) == self.fingerprint
    }

    pub(super) fn inner(&self) -> &SymbolicCholesky<usize> {
        &self.inner
    }

    /// Order of elimination: entry i is the unknown eliminated as the i-th, and its inverse.
    pub(super) fn order(&self) -> (&[usize], &[usize]) {
        // A custom order is always given to the analysis.
        self.inner.perm().map_or((&[], &[]), PermRef::arrays)
    }

    /// Returns the supernodes of the factor, which the analysis always computes.
    pub(super) fn supernodes(&self) -> Option<&SymbolicSupernodalCholesky<usize>> {
        match self.inner.raw() {
            SymbolicCholeskyRaw::Supernodal(s) => Some(s),
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    pub(super) fn original_unknown(&self, pivot: usize) -> usize {
        self.order().0.get(pivot).copied().unwrap_or(pivot)
    }
}

/// 64 bits of a pattern; they live no longer than the process.
fn fingerprint(pattern: SymbolicSparseColMatRef<'_, usize>) -> u64 {
    let mut hash = DefaultHasher::new();
    for j in 0..pattern.ncols() {
        pattern.row_idx_of_col_raw(j).hash(&mut hash);
    }
    hash.finish()
}
