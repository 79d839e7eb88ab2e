//! What a reduction declines.

use crate::element::ElementError;
use crate::modes::ModesError;
use crate::solve::SolveError;

/// A gear that cannot be reduced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReductionError {
    /// Flanks that are none, or that do not fit the mesh.
    #[error("flanks: {0}")]
    Flanks(String),
    /// An element that cannot be integrated.
    #[error(transparent)]
    Element(#[from] ElementError),
    /// A stiffness that cannot be factorised.
    #[error("stiffness matrix: {0}")]
    Solve(#[from] SolveError),
    /// Modes that cannot be found, or a sector that makes no gear.
    #[error(transparent)]
    Modes(#[from] ModesError),
    /// The lowest mode of a free gear is not its rigid motion.
    #[error(
        "the lowest mode of the free gear holds {share:.3e} of its inertia, not all of it: the mesh is in pieces, \
         or its bore does not hold it"
    )]
    NotRigid {
        /// Part of the inertia that the lowest mode holds.
        share: f64,
    },
    /// Data that do not belong together.
    #[error("{0}")]
    Mismatch(String),
}
