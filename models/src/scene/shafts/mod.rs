//! Shafts in an assembled scene: links between hubs, springs where a shaft is elastic, constraints where it is rigid.
//!
//! A link measures how a piece of a shaft deforms, `d = r . q + p(t)`, linear in the motions of two hubs; driven hubs make
//! `p`. An elastic piece exerts `-(k d + c d') r`. A rigid one has `r . q'' = 0`: the forces of a scene are taken less what
//! violates that,
//!
//! ```text
//! f <- f - C (C^T M^-1 C)^-1 C^T M^-1 f,    C = [r_1 ..]
//! ```
//!
//! so that every method that adds accelerations keeps the links to rounding, and no stiffness enters. Newton corrections
//! take both kinds as low-rank terms: with `z = A^-1 r` the links' forces `y` solve `(1/kappa + r . z) y = -r . x`,
//! `kappa = c_k k + c_d c`, or infinite.
//!
//! A stage without teeth is such a link as well, between two hubs that turn in a ratio (`spec::StageSpec`).
//!
//! Motions are those of the hubs in their directions, linear: tilts are small, rotations arbitrary. The shaft is round
//! and its axes do not rotate with it. Its mass is lumped at the nodes (`beam::lump`).
//!
//! | module | owns |
//! |---|---|
//! | `beam` | elements as modes of deformation |
//! | `plan` | shafts as nodes and elements |
//! | `consistency` | what members of a shaft have in common; refusals |
//! | `links` | links from elements, their forces, energies and damping |
//! | `guides` | links of one hub to the ground, with friction |
//! | `link_forces` | links in a scene: forces, tangents, corrections, what is reported |

mod beam;
mod consistency;
mod guides;
mod link_forces;
mod links;
mod plan;

pub(super) use beam::DeformationKind;
pub(super) use guides::{CELLS, Guided, guides};
pub(super) use link_forces::ShaftWork;
pub(super) use links::{Link, Origin, Shafts};
pub(super) use plan::{Plan, ShaftBody};
