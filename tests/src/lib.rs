//! Scenes, models and runs shared by the tests across crates.
//!
//! The kinds of evidence stand in separate test binaries: `analytic` (exact solutions, difference checks,
//! refusals), `conformance` (one law over all models and methods, fitted orders) and `golden` (what every study
//! computes on small scenes, by its [`fingerprint`], against what is stored).

pub mod elastic_toy;
#[allow(dead_code)]
#[path = "../../models/examples/elastic_web.rs"]
pub mod elastic_web;
pub mod fingerprint;
pub mod flank_test_gears;
mod joined_table;
mod nodal_test_gear;
mod probe;
mod runs;
mod scenes;

pub use joined_table::*;
pub use probe::*;
pub use runs::*;
pub use scenes::*;
