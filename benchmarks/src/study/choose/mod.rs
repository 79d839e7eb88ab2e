//! The cheapest adequate model, integrator and step for a scene, without finite elements.

pub mod draw;
