//! Implicit methods.

pub mod diffsol_methods;
pub mod generalised_alpha;
