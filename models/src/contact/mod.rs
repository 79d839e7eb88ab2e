//! Contact: candidate points, gaps, rows, laws and the contact solve.

pub mod candidate;
pub mod flank_points;
pub mod law;
pub mod lines_of_action;
pub mod nodal;
pub mod row;
pub mod search;
pub mod solve;
