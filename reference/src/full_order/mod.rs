//! The full-order gear model `fe`: all nodal displacements, in the same scenes as every other model.
//!
//! | module | owns |
//! |---|---|
//! | `frame` | the frame on the hub: where undeformed points are |
//! | [`body`] | mesh, stiffness and mass, prepared |
//! | `gear`, `kinematics`, `large` | the gear model: coordinates, forces, energy; where its nodes are and how they move; coupled masses |
//! | `lines` | its flanks as lines, for contact on half-spaces |
//! | `frame_pose`, `held`, `floating`, `border` | hubs that move in several directions: where they stand, what they hold, forces and mass, corrections |
//! | `correction` | Newton corrections: factor kept per step size, flexibility of the nodes in contact |
//! | `table` | the line in the table of models |

pub mod body;
mod border;
mod correction;
mod floating;
mod frame;
mod frame_pose;
mod gear;
mod kinematics;
mod large;
mod lines;
pub(crate) mod table;
mod tied_nodes;

#[cfg(test)]
mod tests;

pub use gear::FullOrder;
pub use table::FullOrderParameters;
