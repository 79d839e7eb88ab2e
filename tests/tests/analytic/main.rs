//! Exact solutions, difference checks and refusals of the gear models and the assembled scene.
//! Observed figures are printed: `cargo test --release -p gearbench-tests -- --nocapture`.
#![allow(clippy::print_stdout)]

mod backlash_damping;
mod bearings;
mod flank_points;
mod flight;
mod floating;
mod force;
mod free_flight;
mod friction;
mod guides;
mod history_errors;
mod internal_gears;
mod kinematics;
mod loaded_start;
mod modifications;
mod mounts;
mod movable_teeth;
mod nodal;
mod one_line;
mod pin_starts;
mod planets;
mod rattle;
mod records;
mod refusals;
mod rows;
mod run_ups;
mod running;
mod shafts;
mod small_signals;
mod space;
mod statics;
mod steering;
mod tangents;
mod tooth_springs;
mod torque_paths;
mod touch_speed;
mod trains;
mod zones;
