//! Exact solutions, difference checks and refusals of the gear models and the assembled scene.

mod force;
mod kinematics;
mod movable_teeth;
mod refusals;
mod rows;
mod tangents;
