//! The study of mode counts: error of the elastic model over the number of modes and their highest frequency, with
//! and without residual compliance, chosen by frequency and by flank compliance, against full finite elements on the
//! same mesh.
//!
//! The full model runs once, at a step so small that its own error is negligible, and all runs are compared with it.
//! Between the largest number of modes that misses a limit and the fewest that keeps it, the study bisects, so that the
//! fewest modes are found and not only bracketed.

pub(crate) mod arguments;
pub(crate) mod command;
mod plan;
mod run;
mod summary;
