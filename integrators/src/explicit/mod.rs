//! Explicit methods.

pub mod runge_kutta;
pub mod semi_implicit_euler;
pub mod tsit45;
pub mod velocity_verlet;
