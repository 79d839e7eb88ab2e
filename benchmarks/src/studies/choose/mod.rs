//! The cheapest adequate model, resolution, integrator and step for a scene, without finite-element transients.
//!
//! A requirement is a metric and a tolerance. A **hierarchy** of models is refined on a short **window** of the scene:
//! rigid gears (stiffness of the norm, of analytic tooth compliance, of static solves of the elastic gears), movable
//! teeth, quasi-static compliance, elastic gears with more and more modes, on half-spaces, and with twice the elements.
//! Differences between levels estimate the error of the top level. The refinement of modes ends where two successive
//! differences are well below the tolerance; the mesh is refined once. All other levels are compared with the top
//! level. On each adequate level every integrator runs at the longest step that keeps the tolerance. The cheapest of
//! these candidates is the choice.
//!
//! | module | owns |
//! |---|---|
//! | [`problem`] | the scene with its elastic gears |
//! | [`requirement`] | metrics by their names, and the error in them |
//! | [`level`] | the hierarchy of models |
//! | [`detail`] | its levels of contact and mesh |
//! | [`plan`] | candidates: levels, integrators, steps |
//! | `damping` | damping of models without modes: the damping ratio of the mesh mode of the elastic gears |
//! | `statics` | the stiffness of rigid gears from static solves of the elastic gears |
//! | `pilot` | a rigid run through the scene: the window, and the growth of errors beyond it |
//! | [`trial`] | a model on the window: its history, its cost |
//! | `refinement` | refinement of modes and mesh, and the error of the top level |
//! | `selection` | the cheapest adequate candidate |
//! | `domain` | the range in which the choice has been validated |
//! | `reasons` | the reason in words |
//! | [`run`] | the result of the choice |
//! | `record`, `summary` | the result as a record and on the terminal |
//! | `chosen_scene` | the scene file of the choice |
//! | `reference_comparison` | comparison of the choice with the references of the scene |

pub(crate) mod arguments;
mod chosen_scene;
pub(crate) mod command;
mod damping;
pub mod detail;
mod domain;
pub mod level;
mod pilot;
pub mod plan;
pub mod problem;
mod reasons;
mod record;
mod reference_comparison;
pub(crate) mod refinement;
pub mod requirement;
pub mod run;
mod selection;
mod statics;
mod summary;
#[cfg(test)]
mod tests;
pub mod trial;
