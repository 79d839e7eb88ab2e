//! Criterion benches of gearbench; see `benches/`.
