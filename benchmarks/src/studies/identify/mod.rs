//! Identification: stiffness, tooth mass and touch time fitted to the force history of a reference impact.
//!
//! The residuals are the differences of the contact force on the reference's own time grid, so the fit
//! minimises the relative L2 error that reports show. The touch time is fitted as the initial gap: a
//! faceted finite-element flank touches later than the exact involute. What is fitted:
//!
//! | model | parameters |
//! |---|---|
//! | `rigid` | stiffness of a tooth pair per width, gap |
//! | `movable-teeth` | stiffness of a tooth pair per width, tooth stiffness, tooth mass, gap |

pub(crate) mod arguments;
pub(crate) mod command;
mod levenberg_marquardt;
mod plan;
mod run;
mod summary;

pub use plan::{Identification, Identified, IdentifyError, apply};
pub use run::identify;
