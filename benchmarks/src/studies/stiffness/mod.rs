//! Static mesh stiffness of the models of a scene, compared with ISO 6336 and the analytic tooth compliance.
//!
//! All rows go through the same equilibria ([`MeshCycle`](gearbench_reference::statics::MeshCycle)); the norm and the analytic curve are those of rigid gears
//! with that stiffness of a pair.

pub(crate) mod arguments;
pub(crate) mod command;
mod plan;
mod run;
mod summary;
