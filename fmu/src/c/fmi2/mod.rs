//! The 44 functions of FMI 2.0.
//!
//! | module | owns |
//! |---|---|
//! | `common` | instances, variables, copies of the state |
//! | `stepping` | co-simulation |
//! | `exchange` | model exchange |

pub mod common;
pub mod exchange;
pub mod stepping;

/// Truth value of FMI 2, `fmi2Boolean`.
pub type Boolean = std::ffi::c_int;
