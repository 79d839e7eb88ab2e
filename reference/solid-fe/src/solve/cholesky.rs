//! Factor `P A P^T = L L^T` of a sparse positive definite matrix: analysis once, numbers as often as needed.

use super::{Scalar, SolveError, Symbolic, sweep};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky as sparse;
use faer::{Conj, MatMut, Par, Side};
use std::sync::Arc;

/// Number of stored entries above which two threads factorise faster than one.
const PARALLEL_FROM: usize = 4_000_000;

/// Cholesky factor of a sparse positive definite matrix.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use gearbench_solid_fe::solve::Cholesky;
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
    /// Buffers of a solve: the permuted unknowns, and those of one supernode.
    permuted: Vec<f64>,
    block: Vec<f64>,
}

impl<T: Scalar> Cholesky<T> {
    /// Factorises the matrix whose lower triangle is given, with the better of the orders.
    pub fn new(a: SparseColMatRef<'_, usize, T>) -> Result<Self, SolveError> {
        let symbolic = Arc::new(Symbolic::new(a.symbolic())?);
        Self::with_symbolic(a, symbolic, None)
    }

    /// Factorises a matrix whose pattern has been analysed before.
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
            permuted: Vec::new(),
            block: Vec::new(),
        };
        factor.refactor(a)?;
        Ok(factor)
    }

    /// Replaces the factor by that of another matrix of the same pattern.
    /// After an error the factor is unusable until a matrix has been factorised.
    pub fn refactor(&mut self, a: SparseColMatRef<'_, usize, T>) -> Result<(), SolveError> {
        if !self.symbolic.fits(a.symbolic()) {
            return Err(SolveError::OtherPattern);
        }
        let unknowns = a.ncols();
        if unknowns == 0 {
            return Ok(());
        }
        let inner = self.symbolic.inner();
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

    /// Returns the number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.symbolic.unknowns()
    }

    /// Non-zeros of the factor.
    pub fn factor_nonzeros(&self) -> usize {
        self.symbolic.factor_nonzeros()
    }

    /// Memory of the factor's numbers [bytes].
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(self.values.as_slice())
    }

    /// Solves in place for all columns of `x`, unknowns x right-hand sides.
    ///
    /// # Panics
    /// If `x` has another number of rows than the matrix.
    pub fn solve_many(&self, x: MatMut<'_, T>, par: Par) {
        self.solve_many_in(x, par, &mut SolveMemory::default());
    }

    /// Solves for several right-hand sides in reused memory: new pages for every block of right-hand sides cost as
    /// much as the solution of a block.
    ///
    /// # Panics
    /// If `x` has another number of rows than the matrix.
    pub fn solve_many_in(&self, x: MatMut<'_, T>, par: Par, memory: &mut SolveMemory) {
        assert_eq!(x.nrows(), self.unknowns(), "rows of the right-hand sides");
        if x.nrows() == 0 || x.ncols() == 0 {
            return;
        }
        let inner = self.symbolic.inner();
        let needed = inner.solve_in_place_scratch::<T>(x.ncols(), par);
        let memory = memory.at_least(needed);
        sparse::LltRef::new(inner, &self.values).solve_in_place_with_conj(
            Conj::No,
            x,
            par,
            MemStack::new(memory),
        );
    }
}

/// Memory of solutions for several right-hand sides, which grows as needed and is reused.
#[derive(Default)]
pub struct SolveMemory {
    /// Its requirement in bytes and alignment, and the memory.
    held: Option<([usize; 2], MemBuffer)>,
}

impl std::fmt::Debug for SolveMemory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let held = self.held.as_ref().map(|(needed, _)| needed);
        f.debug_struct("SolveMemory").field("held", &held).finish()
    }
}

impl SolveMemory {
    fn at_least(&mut self, needed: StackReq) -> &mut MemBuffer {
        let wanted = [needed.size_bytes(), needed.align_bytes()];
        let kept = self.held.take();
        let kept = kept.filter(|(held, _)| held[0] >= wanted[0] && held[1] >= wanted[1]);
        let (_, memory) = self
            .held
            .insert(kept.unwrap_or_else(|| (wanted, MemBuffer::new(needed))));
        memory
    }
}

impl Cholesky<f64> {
    /// Solves in place for one right-hand side, without allocation after the first call.
    ///
    /// # Panics
    /// If `x` has another length than the matrix has rows.
    pub fn solve(&mut self, x: &mut [f64]) {
        let unknowns = self.unknowns();
        assert_eq!(x.len(), unknowns, "length of the right-hand side");
        let Some(supernodes) = self.symbolic.supernodes() else {
            return;
        };
        self.permuted.resize(unknowns, 0.0);
        self.block.resize(self.symbolic.widest, 0.0);
        let (forward, inverse) = self.symbolic.order();
        for (p, &i) in self.permuted.iter_mut().zip(forward) {
            *p = x[i];
        }
        let (permuted, block) = (&mut self.permuted, &mut self.block);
        sweep::forward(supernodes, &self.values, permuted, block);
        sweep::backward(supernodes, &self.values, permuted, block);
        for (x, &i) in x.iter_mut().zip(inverse) {
            *x = permuted[i];
        }
    }
}
