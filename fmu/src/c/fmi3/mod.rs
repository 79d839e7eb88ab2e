//! The 75 functions of FMI 3.0.
//!
//! | module | owns |
//! |---|---|
//! | `common` | instances, co-simulation, variables, copies of the state |
//! | `exchange` | model exchange |
//! | `unsupported` | functions for missing features: other types, clocks, partial derivatives |

pub mod common;
pub mod exchange;
pub mod unsupported;
