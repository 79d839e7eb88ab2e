//! The cheapest adequate model, resolution, integrator and step for a scene, without finite-element transients.
//!
//! A requirement is a metric and a tolerance. A **hierarchy** of models is refined on a short **window** of the scene:
//! rigid gears (stiffness of the norm, of analytic tooth compliance, of static solves of the elastic gears), movable teeth,
//! quasi-static compliance, elastic gears with more and more modes, on half-spaces, and with twice the elements. Differences
//! between levels estimate the error of the top one; the refinement of modes ends where two of them in a row lie well below
//! the tolerance, the mesh is refined once. All other levels are held against the top one, and of the adequate ones every integrator is taken to the longest step that keeps the
//! tolerance. The cheapest of all that is left is the choice.
//!
//! | module | owns |
//! |---|---|
//! | [`problem`] | the scene and what its elastic gears are made of |
//! | [`requirement`] | metrics by their names, and the error in them |
//! | [`level`] | the hierarchy of models |
//! | [`detail`] | its levels of contact and mesh |
//! | [`plan`] | what could be run: levels, integrators, steps |
//! | `damping` | what damps models without modes: the damping ratio of the mesh mode of the elastic ones |
//! | `statics` | the stiffness of rigid gears from static solves of the elastic ones |
//! | `pilot` | a rigid run through the scene: the window, and how errors grow beyond it |
//! | [`trial`] | a model on the window: its history, its cost |
//! | `refinement` | more and more modes, and what the top level is still off |
//! | `selection` | the cheapest adequate candidate |
//! | `domain` | what the choice has been validated on |
//! | `reason` | the reason in plain words |
//! | [`run`] | the answer |
//! | `record`, `summary` | the answer as a record and on the terminal |
//! | `chosen` | the scene file with the choice written in |
//! | `held` | what was chosen against the references of the scene |

pub(crate) mod arguments;
mod chosen;
pub(crate) mod command;
mod damping;
pub mod detail;
mod domain;
mod held;
pub mod level;
mod pilot;
pub mod plan;
pub mod problem;
mod reason;
mod record;
pub(crate) mod refinement;
pub mod requirement;
pub mod run;
mod selection;
mod statics;
mod summary;
#[cfg(test)]
mod tests;
pub mod trial;
