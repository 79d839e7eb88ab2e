//! Largest stable step of a method on a scene, by linear theory and by the method as implemented.
//!
//! A scene is linear as long as its contacts neither open nor close. At such a state ([`Linearised`]) it is
//! `M q'' + D q' + K q = 0`, for which [`linear_stability`](gearbench_integrators::linear_stability) knows the limit of
//! every method. **The state** is the one of the largest contact force, among those with the most tooth pairs in
//! contact, of a run from the scene's start through its first contact (until the teeth part again or the first gear has
//! turned by a pitch); the start itself for a scene that does not touch. Contacts only add stiffness to the open scene,
//! whose frequencies are therefore no higher and whose limit is no smaller. A run that leaves contact half of the time
//! may survive a step somewhat larger; one that finds a stiffer contact later may not.
//!
//! | module | owns |
//! |---|---|
//! | [`linearised`] | the state, the matrices there |
//! | `end_dampers` | dampers that act at the velocities at the end of a half-step impulse |
//! | [`linear`] | mass-scaled matrices, frequencies, the limit of a method on them |
//! | [`lines`] | limits, resonances and penalty frequency as lines over the step |
//! | [`stepped_limit`] | the limit of the method as implemented, by stepping the linear system |
//! | [`table`] | comparison of both for models and methods |

mod end_dampers;
pub mod linear;
pub mod linearised;
pub mod lines;
pub mod stepped_limit;
mod system;
pub mod table;

#[cfg(test)]
mod tests;

pub use linearised::Linearised;
pub use table::{Case, StepLimit};

pub use gearbench_reports::stability::LineKind;

use gearbench_models::error::BuildError;

/// Step that theory marks, with a description.
#[derive(Clone, Debug, PartialEq)]
pub struct StepLine {
    /// Description of the step in words.
    pub label: String,
    /// Step of the line [s].
    pub step_s: f64,
    /// Kind of limit that the line marks.
    pub kind: LineKind,
}

/// Reason why a limit cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// The scene cannot be assembled.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The matrices at the state are no matrices of a vibrating system.
    #[error("the scene cannot be linearised where its contact force is largest: {0}")]
    Matrices(&'static str),
}

/// Ratio of trial steps in the search for the first unstable step, and the relative width at which the search ends.
const LOOK: f64 = 1.25;
const WIDTH: f64 = 1e-3;

/// The first step between two at which something is unstable, from below.
fn first_unstable(
    [from, to]: [f64; 2],
    mut unstable: impl FnMut(f64) -> Result<bool, LimitError>,
) -> Result<Option<f64>, LimitError> {
    let mut low = 0.0;
    let mut high = from;
    while !unstable(high)? {
        low = high;
        high *= LOOK;
        if high >= to {
            return Ok(None);
        }
    }
    while high - low > WIDTH * high {
        let h = 0.5 * (low + high);
        if unstable(h)? {
            high = h;
        } else {
            low = h;
        }
    }
    Ok(Some(0.5 * (low + high)))
}
