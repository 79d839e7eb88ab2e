//! Implicit methods of diffsol in first-order form. See [`crate::diffsol_adapter`].
//!
//! The slope of the error over the tolerance follows from what the estimate measures. A method of order p
//! whose estimate is of order p in `h^(p+1)` takes `h ~ rtol^(1/(p+1))`, and its global error
//! `h^p ~ rtol^(p/(p+1))`: 2/3 for TR-BDF2, 3/4 for ESDIRK 3(4). BDF changes its order with the tolerance.

use crate::method::{MethodInfo, Stepping};

/// Declared properties of the backward differentiation formulas (NDF) of order one to five.
pub static BDF: MethodInfo = MethodInfo {
    id: "bdf",
    name: "BDF",
    order: 5,
    implicit: true,
    stepping: Stepping::Adaptive,
    tolerance_slope: 0.8,
    dissipative: true,
    linear_part: false,
    dense_matrices: true,
    parameters: &[],
    citation: "Shampine, Reichelt, SIAM J. Sci. Comput. 18 (1997) 1; diffsol",
};

/// Declared properties of TR-BDF2: trapezoidal rule and BDF2 in one step.
pub static TR_BDF2: MethodInfo = MethodInfo {
    id: "tr-bdf2",
    name: "TR-BDF2",
    order: 2,
    implicit: true,
    stepping: Stepping::Adaptive,
    tolerance_slope: 2.0 / 3.0,
    dissipative: true,
    linear_part: false,
    dense_matrices: true,
    parameters: &[],
    citation: "Bank et al., IEEE Trans. CAD 4 (1985) 436; Hosea, Shampine, Appl. Numer. Math. 20 (1996) 21; diffsol",
};

/// Declared properties of ESDIRK 3(4): an explicit first stage and three implicit ones.
pub static ESDIRK34: MethodInfo = MethodInfo {
    id: "esdirk34",
    name: "ESDIRK 3(4)",
    order: 3,
    implicit: true,
    stepping: Stepping::Adaptive,
    tolerance_slope: 0.75,
    dissipative: true,
    linear_part: false,
    dense_matrices: true,
    parameters: &[],
    citation: "Jorgensen, Kristensen, Thomsen, arXiv:1803.01613 (2018); diffsol",
};
