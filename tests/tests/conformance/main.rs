//! One law over all gear models and all methods: invariants, energy, ledgers, restitution.
//!
//! The tables are iterated, so a new model or method is held to all of this without a line here.
//! Observed figures are printed: `cargo test --release -p gearbench-tests -- --nocapture`.
#![allow(clippy::print_stdout)]

mod core;
mod elastic;
mod example;
mod flank_points;
mod impact;
mod leaving_tips;
mod losses;
mod retardation;
mod user_law;
