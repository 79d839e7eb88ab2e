//! Identification: constants of models fitted to references.
//!
//! | module | owns |
//! |---|---|
//! | `plan` | data sets, user options, result |
//! | `parameters` | parameters with starting values and bounds |
//! | [`estimate`] | the mathematics: fit, intervals under correlated errors, identifiability |
//! | `run` | the model on the data, and the record of the fit |
//! | `explanation` | combinations that are not determined, in words |
//! | [`write`] | the calibration file |
//! | `scene_update` | constants in the scene file itself |
//!
//! Residuals are the differences of the contact force on the data's own times over the size of the data, so that the fit
//! minimises the relative L2 error that reports show, and of the static compliance over a mesh cycle likewise. Several
//! data sets are fitted at once, each under its own speeds and loads. A reference without a contact force is fitted by
//! all of its speeds, angles and torques, each a data set of its own. By default are fitted:
//!
//! | model | parameters |
//! |---|---|
//! | `rigid` | stiffness of a tooth pair per width, gap |
//! | `movable-teeth` | stiffness of a tooth pair per width, tooth stiffness, tooth mass, gap |
//!
//! On request also dampers, the course of the stiffness along the path of contact as a parabola, and constants of single
//! gears in the place of what all have (`pinion.tooth_mass_kg`), and numbers of the scene by their path, see
//! `parameters`.
//!
//! The gap is the touch time: a faceted finite-element flank touches later than the exact involute. Where the clock of
//! data is not that of the scene its offset can be fitted in the place of the gap.
//!
//! An impact is over before the bodies have given way, so that what fits it is too stiff for gears that run under load:
//! there compliances of finite elements at rest are fitted in its place (the stiffness of a tooth pair, which is
//! all that they tell), or both at once.

pub(crate) mod arguments;
pub(crate) mod command;
#[cfg(test)]
mod course_tests;
pub mod estimate;
mod explanation;
mod fit_parameters;
mod parameters;
mod plan;
mod run;
mod scene_update;
#[cfg(test)]
mod sensitivity_tests;
mod summary;
#[cfg(test)]
mod tests;
mod write;

pub use fit_parameters::{Clock, FitParameters};
pub use parameters::{CLOCK, CLOCK_SCALE, FitOptions, Parameter};
pub use plan::{
    Data, DataSet, FitPlan, Identification, IdentifyError, StaticTarget, apply, default_method,
};
pub use run::{histories, identify, modelled};
