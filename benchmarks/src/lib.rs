//! The library behind the command `gearbench`: scenes and studies.

pub mod study;
