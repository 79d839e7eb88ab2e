//! Exact solutions, difference checks and refusals of the gear models and the assembled scene.

mod force;
mod kinematics;
mod rows;
mod tangents;
