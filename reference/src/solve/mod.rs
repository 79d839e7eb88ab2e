//! Sparse symmetric solves: Cholesky factors `A = L L^T` of stiffness matrices, their orderings and sweeps.
//!
//! | part | owns |
//! |---|---|
//! | [`Cholesky`] | factor of a positive definite matrix; solves with one or many right-hand sides |
//! | [`ordering`] | the fill-reducing order: nested dissection or minimum degree on the graph of nodes |
//! | [`negative_eigenvalues`] | number of negative eigenvalues, by `L D L^T` |
//!
//! Matrices come as their lower triangle in compressed columns with sorted rows, one column per unknown.
//! The numeric factorisation is faer's supernodal one (columns of equal pattern kept as one dense block); the
//! order, the analysis of fill and the sweeps for a single right-hand side are our own.

mod cholesky;
mod inertia;
pub mod ordering;
mod scalar;
mod separator;
mod sweep;
mod symbolic;
#[cfg(test)]
mod tests;

pub use cholesky::{Cholesky, Options, SolveWorkspace};
pub use inertia::negative_eigenvalues;
pub use scalar::Scalar;
pub use symbolic::Symbolic;

/// A system that cannot be factorised.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SolveError {
    /// The matrix has more rows than columns or the other way round.
    #[error("a symmetric matrix must be square; this one has {rows} rows and {columns} columns")]
    NotSquare {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// A pivot is not positive: the matrix is not positive definite.
    #[error(
        "the matrix is not positive definite: the pivot of unknown {unknown} is not positive (a body that nothing \
         holds, a node without an element, or a distorted element gives that; hold the body or shift the matrix)"
    )]
    NotPositiveDefinite {
        /// Unknown whose pivot failed, counted from 0.
        unknown: usize,
    },
    /// A pivot of the `L D L^T` factor is zero: the shift is an eigenvalue, to rounding.
    #[error(
        "the pivot of unknown {unknown} vanishes: move the shift away from the eigenvalue it hits"
    )]
    ZeroPivot {
        /// Unknown whose pivot failed, counted from 0.
        unknown: usize,
    },
    /// A matrix with another pattern than the one analysed.
    #[error(
        "the matrix has another pattern of non-zeros than the one that was analysed: factorise it anew"
    )]
    OtherPattern,
    /// The factor does not fit into memory or its indices overflow.
    #[error("the factor of {unknowns} unknowns does not fit into memory")]
    TooLarge {
        /// Unknowns.
        unknowns: usize,
    },
}
