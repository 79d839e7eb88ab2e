//! Contacts of gears with displacement fields at a state: points, one solve per island, forces on nodes and hubs.
//!
//! An island holds the meshes that residual compliance couples: an idler that has some joins both of its meshes.
//!
//! | module | owns |
//! |---|---|
//! | `islands` | what is solved together, and the buffers |
//! | `solve` | points that may touch, and the solve of an island |
//! | `hard` | the same without a penalty: one constraint per slave node |
//! | `dissipative` | dashpots and friction of an island |
//! | `forces` | gap rates, forces on nodes and hubs |
//! | `tangent` | how the forces answer to the coordinates |

mod dissipative;
mod forces;
mod hard;
mod islands;
mod solve;
mod tangent;

pub(super) use forces::{line_rows, rows_of};
pub(super) use islands::{Nodal, NodalActive, islands};
pub(super) use tangent::{Entry, ReducedTangent};
