//! Implicit methods: the generalised-alpha family and the implicit solvers of diffsol.

pub mod diffsol_methods;
pub mod generalised_alpha;
