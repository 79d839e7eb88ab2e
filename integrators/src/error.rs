//! Why a run ended early.

use crate::bounds::Bound;

/// Why a run ended early. Every variant says when, and how much where that helps.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Newton's method did not converge.
    #[error(
        "Newton diverged at t = {t:.6e} s with step {h:.3e} s: scaled correction {residual:.3e} after {iterations} iterations; use a smaller step"
    )]
    NewtonDiverged {
        /// Time [s].
        t: f64,
        /// Step [s].
        h: f64,
        /// Last scaled correction.
        residual: f64,
        /// Iterations done.
        iterations: u32,
    },
    /// The Newton matrix could not be inverted.
    #[error("the Newton matrix is singular at t = {t:.6e} s with step {h:.3e} s")]
    SingularTangent {
        /// Time [s].
        t: f64,
        /// Step [s].
        h: f64,
    },
    /// A coordinate became infinite or not a number.
    #[error("coordinate {dof} is not finite at t = {t:.6e} s: the run blew up; use a smaller step")]
    NonFinite {
        /// Time [s].
        t: f64,
        /// Index of the coordinate.
        dof: usize,
    },
    /// The error estimate asked for a step below resolution.
    #[error("step {h:.3e} s at t = {t:.6e} s is too small to go on: the tolerance cannot be met")]
    StepTooSmall {
        /// Time [s].
        t: f64,
        /// Step [s].
        h: f64,
    },
    /// Contact modes flip without time going on.
    #[error("contact chatter at t = {t:.6e} s: {events} events without progress")]
    Chatter {
        /// Time [s].
        t: f64,
        /// Events seen there.
        events: u32,
    },
    /// A bound of the run was reached, or would have been.
    #[error("stopped at t = {t:.6e} s after {steps} steps: {bound}")]
    Timeout {
        /// Time [s].
        t: f64,
        /// Steps done.
        steps: u64,
        /// The bound.
        bound: Bound,
    },
    /// Stopped from outside.
    #[error("interrupted at t = {t:.6e} s")]
    Interrupted {
        /// Time [s].
        t: f64,
    },
    /// The method cannot do what the plan asks.
    #[error("{method} cannot run {what}")]
    Unsupported {
        /// Method id.
        method: &'static str,
        /// What was asked.
        what: &'static str,
    },
    /// A library's solver gave up.
    #[error("{method} failed at t = {t:.6e} s: {message}")]
    Library {
        /// Method id.
        method: &'static str,
        /// Time [s].
        t: f64,
        /// The library's words.
        message: String,
    },
}
