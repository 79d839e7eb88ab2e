//! Contact: candidate points and gaps of tooth pairs on lines of action and of points of flanks; contacts on nodes.
//!
//! | module | owns |
//! |---|---|
//! | [`Search`] | which of both a mesh has |
//! | [`pairs`] | tooth pairs on the lines of action; lines of elastic flanks on half-spaces |
//! | [`points`] | points of one flank against the surface of the other |
//! | [`nodal`] | contact of gears whose flank nodes stand off the rigid flank |

mod candidate;
mod clearance;
mod gear_state;
pub mod nodal;
pub mod pairs;
pub mod points;
mod search;

pub use candidate::Candidate;
pub use clearance::{Clearance, LineClearance};
pub use gear_state::{CandidateSelection, GearState, SearchWork, ZoneChange};
pub use search::Search;
