//! Tsitouras 5(4) of diffsol: an explicit Runge-Kutta method whose error constants lie below those of
//! Dormand-Prince. Ch. Tsitouras, *Comput. Math. Appl.* 62 (2011) 770. See [`crate::diffsol_adapter`].

use crate::method::{MethodInfo, Stepping};

/// Declared properties of Tsitouras 5(4).
pub static INFO: MethodInfo = MethodInfo {
    id: "tsit45",
    name: "Tsitouras 5(4)",
    order: 5,
    implicit: false,
    stepping: Stepping::Adaptive,
    tolerance_slope: 1.0,
    // It gains a little: the sixth-order term of its stability polynomial lies below 1/720.
    dissipative: false,
    linear_part: false,
    dense_matrices: false,
    parameters: &[],
    citation: "Tsitouras, Comput. Math. Appl. 62 (2011) 770; diffsol",
};
