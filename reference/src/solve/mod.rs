//! Sparse symmetric solves: Cholesky factorisation.
