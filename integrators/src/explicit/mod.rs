//! Explicit methods: semi-implicit Euler, velocity Verlet, Runge-Kutta.

pub mod runge_kutta;
pub mod semi_implicit_euler;
pub mod tsit45;
pub mod velocity_verlet;
