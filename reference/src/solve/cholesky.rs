//! Factor `P A P^T = L L^T` of a sparse positive definite matrix: analysis once, numbers as often as needed.

use super::ordering::{self, Ordering};
use super::{SolveError, sweep};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    self as sparse, CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw,
    SymmetricOrdering, supernodal::SymbolicSupernodalCholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use std::sync::Arc;

/// Numbers a matrix may consist of: `f64`, or [`faer::c64`] for Hermitian matrices.
pub trait Scalar:
    faer::traits::ComplexField<Real = f64>
    + Copy
    + Send
    + Sync
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::AddAssign
    + std::ops::SubAssign
    + std::ops::MulAssign
{
    /// A real number.
    fn real(x: f64) -> Self;
    /// A complex number; a real type takes its real part.
    fn complex(re: f64, im: f64) -> Self;
    /// Real and imaginary part.
    fn parts(self) -> [f64; 2];
    /// The complex conjugate.
    #[must_use]
    fn conjugate(self) -> Self;
    /// Square of the modulus.
    fn modulus2(self) -> f64;
}

impl Scalar for f64 {
    fn real(x: f64) -> Self {
        x
    }
    fn complex(re: f64, _: f64) -> Self {
        re
    }
    fn parts(self) -> [f64; 2] {
        [self, 0.0]
    }
    fn conjugate(self) -> Self {
        self
    }
    fn modulus2(self) -> f64 {
        self * self
    }
}

impl Scalar for faer::c64 {
    fn real(x: f64) -> Self {
        Self::new(x, 0.0)
    }
    fn complex(re: f64, im: f64) -> Self {
        Self::new(re, im)
    }
    fn parts(self) -> [f64; 2] {
        [self.re, self.im]
    }
    fn conjugate(self) -> Self {
        self.conj()
    }
    fn modulus2(self) -> f64 {
        self.norm_sqr()
    }
}

/// Supernodes are merged while the zeros this stores stay below the fraction: (columns, fraction).
/// Wider merges than faer's: our matrices come in blocks of three columns, and wide blocks sweep faster.
const RELAXATION: &[(usize, f64)] = &[(12, 0.6), (24, 0.3), (48, 0.12), (usize::MAX, 0.03)];

/// From this many stored entries on, two threads factorise faster than one.
const PARALLEL_FROM: usize = 4_000_000;

/// How to order and factorise.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Order of elimination.
    pub ordering: Ordering,
    /// Threads of the factorisation; `None`: one for small matrices, all for large ones.
    pub par: Option<Par>,
}

/// Analysis of a pattern: order, fill, supernodes. Serves every matrix of the pattern, real or complex.
#[derive(Debug)]
pub struct Symbolic {
    inner: SymbolicCholesky<usize>,
    fingerprint: u64,
    widest: usize,
    nonzeros: usize,
    flops: f64,
    ordering: Ordering,
}

impl Symbolic {
    /// Analyses the pattern of a lower triangle.
    ///
    /// # Errors
    /// A matrix that is not square, or a factor too large for the memory.
    pub fn new(
        pattern: SymbolicSparseColMatRef<'_, usize>,
        ordering: Ordering,
    ) -> Result<Self, SolveError> {
        let unknowns = pattern.ncols();
        if pattern.nrows() != unknowns {
            return Err(SolveError::NotSquare {
                rows: pattern.nrows(),
                columns: unknowns,
            });
        }
        let order = ordering::order(pattern, ordering);
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
            flops: order.flops,
            ordering: order.chosen,
        })
    }

    /// Unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.inner.nrows()
    }

    /// Non-zeros of the factor, without the zeros stored to widen blocks.
    #[must_use]
    pub fn factor_nonzeros(&self) -> usize {
        self.nonzeros
    }

    /// Numbers stored for the factor, with the zeros that widen the blocks.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.inner.len_val()
    }

    /// Multiplications and additions of a factorisation of real numbers.
    #[must_use]
    pub fn flops(&self) -> f64 {
        self.flops
    }

    /// The order that was chosen.
    #[must_use]
    pub fn ordering(&self) -> Ordering {
        self.ordering
    }

    /// Whether a matrix has the pattern that was analysed.
    #[must_use]
    pub fn fits(&self, pattern: SymbolicSparseColMatRef<'_, usize>) -> bool {
        pattern.ncols() == self.unknowns() && fingerprint(pattern) == self.fingerprint
    }

    pub(super) fn inner(&self) -> &SymbolicCholesky<usize> {
        &self.inner
    }

    /// Order of elimination: entry i is the unknown eliminated as the i-th, and its inverse.
    fn order(&self) -> (&[usize], &[usize]) {
        // A custom order is always given to the analysis.
        self.inner.perm().map_or((&[], &[]), PermRef::arrays)
    }

    /// Supernodes of the factor; the analysis always asks for them.
    fn supernodes(&self) -> Option<&SymbolicSupernodalCholesky<usize>> {
        match self.inner.raw() {
            SymbolicCholeskyRaw::Supernodal(s) => Some(s),
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    pub(super) fn original_unknown(&self, pivot: usize) -> usize {
        self.order().0.get(pivot).copied().unwrap_or(pivot)
    }
}

/// 64 bits of a pattern (FNV-1a over whole words).
fn fingerprint(pattern: SymbolicSparseColMatRef<'_, usize>) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |x: usize| hash = (hash ^ x as u64).wrapping_mul(0x0100_0000_01b3);
    for j in 0..pattern.ncols() {
        add(usize::MAX);
        for i in pattern.row_idx_of_col_raw(j) {
            add(*i);
        }
    }
    hash
}

/// Buffers of a solve, to be kept between solves.
#[derive(Clone, Debug, Default)]
pub struct SolveWorkspace {
    permuted: Vec<f64>,
    block: Vec<f64>,
}

/// Cholesky factor of a sparse positive definite matrix.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use gearbench_reference::solve::Cholesky;
///
/// // A chain of three springs, held at one end: lower triangle only.
/// let k = [(0, 0, 2.0), (1, 0, -1.0), (1, 1, 2.0), (2, 1, -1.0), (2, 2, 1.0)].map(|(i, j, v)| Triplet::new(i, j, v));
/// let k = SparseColMat::<usize, f64>::try_new_from_triplets(3, 3, &k).unwrap();
/// let mut factor = Cholesky::new(k.as_ref()).unwrap();
/// let mut x = [0.0, 0.0, 1.0];
/// factor.solve(&mut x);
/// assert!((x[2] - 3.0).abs() < 1e-14);
/// ```
#[derive(Clone, Debug)]
pub struct Cholesky<T = f64> {
    symbolic: Arc<Symbolic>,
    values: Vec<T>,
    par: Par,
    workspace: SolveWorkspace,
}

impl<T: Scalar> Cholesky<T> {
    /// Factorises the matrix whose lower triangle is given, with the better of the orders.
    ///
    /// # Errors
    /// A matrix that is not square or not positive definite, or a factor too large for the memory.
    pub fn new(a: SparseColMatRef<'_, usize, T>) -> Result<Self, SolveError> {
        Self::with_options(a, &Options::default())
    }

    /// Factorises with a stated order and number of threads.
    ///
    /// # Errors
    /// As [`Cholesky::new`].
    pub fn with_options(
        a: SparseColMatRef<'_, usize, T>,
        options: &Options,
    ) -> Result<Self, SolveError> {
        let symbolic = Arc::new(Symbolic::new(a.symbolic(), options.ordering)?);
        Self::with_symbolic(a, symbolic, options.par)
    }

    /// Factorises a matrix whose pattern has been analysed before.
    ///
    /// # Errors
    /// Another pattern, or a matrix that is not positive definite.
    pub fn with_symbolic(
        a: SparseColMatRef<'_, usize, T>,
        symbolic: Arc<Symbolic>,
        par: Option<Par>,
    ) -> Result<Self, SolveError> {
        let par = par.unwrap_or(if symbolic.stored() < PARALLEL_FROM {
            Par::Seq
        } else {
            Par::rayon(0)
        });
        let mut factor = Self {
            values: vec![T::real(0.0); symbolic.stored()],
            symbolic,
            par,
            workspace: SolveWorkspace::default(),
        };
        factor.refactor(a)?;
        Ok(factor)
    }

    /// Replaces the factor by that of another matrix of the same pattern.
    /// After an error the factor is unusable until a matrix has been factorised.
    ///
    /// # Errors
    /// Another pattern, or a matrix that is not positive definite.
    pub fn refactor(&mut self, a: SparseColMatRef<'_, usize, T>) -> Result<(), SolveError> {
        if !self.symbolic.fits(a.symbolic()) {
            return Err(SolveError::OtherPattern);
        }
        let unknowns = a.ncols();
        if unknowns == 0 {
            return Ok(());
        }
        let inner = &self.symbolic.inner;
        let scratch = inner.factorize_numeric_llt_scratch::<T>(self.par, Default::default());
        let mut memory =
            MemBuffer::try_new(scratch).map_err(|_| SolveError::TooLarge { unknowns })?;
        inner
            .factorize_numeric_llt(
                &mut self.values,
                a,
                Side::Lower,
                LltRegularization::default(),
                self.par,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(
                |LltError::NonPositivePivot { index }| SolveError::NotPositiveDefinite {
                    unknown: self.symbolic.original_unknown(index),
                },
            )?;
        Ok(())
    }

    /// The analysis, to be shared with factors of other matrices of the pattern.
    #[must_use]
    pub fn symbolic(&self) -> &Arc<Symbolic> {
        &self.symbolic
    }

    /// Unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.symbolic.unknowns()
    }

    /// Non-zeros of the factor.
    #[must_use]
    pub fn factor_nonzeros(&self) -> usize {
        self.symbolic.nonzeros
    }

    /// Memory of the factor's numbers [bytes].
    #[must_use]
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(self.values.as_slice())
    }

    /// Solves in place for all columns of `x`, unknowns x right-hand sides.
    ///
    /// # Panics
    /// If `x` has another number of rows than the matrix.
    pub fn solve_many(&self, x: MatMut<'_, T>, par: Par) {
        assert_eq!(x.nrows(), self.unknowns(), "rows of the right-hand sides");
        if x.nrows() == 0 || x.ncols() == 0 {
            return;
        }
        let inner = &self.symbolic.inner;
        let mut memory = MemBuffer::new(inner.solve_in_place_scratch::<T>(x.ncols(), par));
        sparse::LltRef::new(inner, &self.values).solve_in_place_with_conj(
            Conj::No,
            x,
            par,
            MemStack::new(&mut memory),
        );
    }
}

impl Cholesky<f64> {
    /// Solves in place for one right-hand side. Nothing is allocated after the first call.
    ///
    /// # Panics
    /// If `x` has another length than the matrix has rows.
    pub fn solve(&mut self, x: &mut [f64]) {
        let mut workspace = std::mem::take(&mut self.workspace);
        self.solve_with(x, &mut workspace);
        self.workspace = workspace;
    }

    /// Solves in place for one right-hand side with buffers of the caller: the factor stays shared.
    ///
    /// # Panics
    /// If `x` has another length than the matrix has rows.
    pub fn solve_with(&self, x: &mut [f64], workspace: &mut SolveWorkspace) {
        let unknowns = self.unknowns();
        assert_eq!(x.len(), unknowns, "length of the right-hand side");
        let Some(supernodes) = self.symbolic.supernodes() else {
            return;
        };
        workspace.permuted.resize(unknowns, 0.0);
        workspace.block.resize(self.symbolic.widest, 0.0);
        let (forward, inverse) = self.symbolic.order();
        for (p, &i) in workspace.permuted.iter_mut().zip(forward) {
            *p = x[i];
        }
        sweep::forward(
            supernodes,
            &self.values,
            &mut workspace.permuted,
            &mut workspace.block,
        );
        sweep::backward(
            supernodes,
            &self.values,
            &mut workspace.permuted,
            &mut workspace.block,
        );
        for (x, &i) in x.iter_mut().zip(inverse) {
            *x = workspace.permuted[i];
        }
    }
}
