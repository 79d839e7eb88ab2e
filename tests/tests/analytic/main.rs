//! Exact solutions, difference checks and refusals of the gear models and the assembled scene.

mod force;
mod friction;
mod kinematics;
mod mounts;
mod movable_teeth;
mod refusals;
mod rows;
mod tangents;
mod zones;
