//! Run-ups: a scene whose shafts accelerate from one speed to another runs once, and its histories are divided into
//! windows.
//!
//! ```text
//! A_k = 2/sum(w_j) |sum_j w_j (x_j - line) e^{-2 pi i k j/n}|,    w_j = (1 - cos(2 pi j/n))/2
//! ```
//!
//! are amplitudes (half of peak to peak) of each window, Hann's, once of equal times (a spectrum over speed: a waterfall)
//! and once at even angles of the reference gear, over whole turns (an order map: what goes with a shaft stays in its
//! line however the speed changes). Windows overlap by three quarters, and each stands at its mean speed. A sine in the middle of
//! its bin reads its amplitude, between two bins 15 % less; orders of meshes and shafts are followed at their very order, which
//! costs nothing. After S. Braun, *Discover Signal Processing* (2008), and K. R. Fyfe, E. D. S. Munck, *Analysis of computed order
//! tracking*, Mech. Syst. Signal Process. 11 (1997) 187.
//!
//! | module | owns |
//! |---|---|
//! | `drive` | the run-up of a scene that has none: from, to, over |
//! | `recorder` | few channels at many even times |
//! | `spectrum` | amplitudes of a window: all bins, and at one order |
//! | `windows` | equal times, whole turns |
//! | `orders` | the orders of meshes and shafts |
//! | `channels` | transmission errors, mesh and bearing forces, from what was recorded |
//! | `analysis` | the record of a run |

mod analysis;
pub(crate) mod arguments;
mod channels;
pub(crate) mod command;
mod drive;
mod orders;
mod plan;
mod recorder;
mod run;
mod spectrum;
mod summary;
#[cfg(test)]
mod tests;
mod windows;

pub use plan::{EvaluationSettings, Plan, Ramp};
pub use run::study;
