//! The study of accuracy against cost.
