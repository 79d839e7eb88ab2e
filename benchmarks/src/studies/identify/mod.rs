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
//!
//! An impact is over before the bodies have given way, so that what fits it is too stiff for gears that run under load:
//! there compliances of finite elements at rest are fitted in its place (the stiffness of a tooth pair, which is
//! all that they tell), or both at once.

pub(crate) mod arguments;
pub(crate) mod command;
mod levenberg_marquardt;
mod plan;
mod run;
mod summary;

pub use plan::{Identification, Identified, IdentifyError, StaticTarget, Target, apply};
pub use run::identify;
