//! Sparse symmetric solves: Cholesky factors `A = L L^T` of stiffness matrices, their orderings and sweeps.
//!
//! | part | owns |
//! |---|---|
//! | [`Cholesky`] | factor of a positive definite matrix; solves with one or many right-hand sides |
//! | `ordering` | the fill-reducing order: nested dissection or minimum degree on the graph of nodes |
//! | `negative_eigenvalues` | number of negative eigenvalues, by `L D L^T` |
//!
//! Matrices come as their lower triangle in compressed columns with sorted rows, one column per unknown.
//! The numeric factorisation is faer's supernodal one (columns of equal pattern kept as one dense block); the
//! order, the analysis of fill and the sweeps for a single right-hand side are our own.

mod cholesky;
mod inertia;
mod ordering;
mod scalar;
mod separator;
mod sweep;
mod symbolic;
#[cfg(test)]
mod tests;
mod union;

pub use cholesky::{Cholesky, SolveMemory};
pub(crate) use inertia::negative_eigenvalues;
pub use scalar::Scalar;
pub(crate) use symbolic::Symbolic;
pub use union::union;

/// A system that cannot be factorised.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum SolveError {
    #[error("a symmetric matrix must be square; this one has {rows} rows and {columns} columns")]
    NotSquare { rows: usize, columns: usize },
    #[error(
        "the matrix is not positive definite: the pivot of unknown {unknown} is not positive (a body that nothing \
         holds, a node without an element, or a distorted element gives that; hold the body or shift the matrix)"
    )]
    NotPositiveDefinite { unknown: usize },
    #[error(
        "the pivot of unknown {unknown} vanishes: move the shift away from the eigenvalue it hits"
    )]
    ZeroPivot { unknown: usize },
    #[error(
        "the matrix has another pattern of non-zeros than the one that was analysed: factorise it anew"
    )]
    OtherPattern,
    #[error("the factor of {unknowns} unknowns does not fit into memory")]
    TooLarge { unknowns: usize },
    #[error(transparent)]
    TooMuch(#[from] crate::limits::TooMuchMemory),
}
