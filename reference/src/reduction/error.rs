//! Errors of a reduction.

use crate::element::ElementError;
use crate::limits::TooMuchMemory;
use crate::modes::ModesError;
use crate::solve::SolveError;

/// A gear that cannot be reduced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum ReductionError {
    #[error("flanks: {0}")]
    Flanks(String),
    #[error(transparent)]
    Element(#[from] ElementError),
    #[error("stiffness matrix: {0}")]
    Solve(#[from] SolveError),
    #[error(transparent)]
    Modes(#[from] ModesError),
    #[error(
        "the lowest mode of the free gear holds {share:.3e} of its inertia, not all of it: the mesh is in pieces, \
         or its bore does not hold it"
    )]
    NotRigid { share: f64 },
    #[error(transparent)]
    TooLarge(#[from] TooMuchMemory),
    #[error("{0}")]
    Mismatch(String),
}
