//! Reasons why a run ended before its end time.

use crate::bounds::Bound;

/// Reason why a run ended before its end time. Every variant has the time and, where it helps, a magnitude.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Newton's method did not converge.
    #[error(
        "Newton diverged at t = {t:.6e} s with step {h:.3e} s: scaled correction {residual:.3e} after {iterations} iterations; use a smaller step"
    )]
    NewtonDiverged {
        /// Time of the failure [s].
        t: f64,
        /// Step size [s].
        h: f64,
        /// Last correction, relative to the scales of the system.
        residual: f64,
        /// Number of Newton iterations.
        iterations: u32,
    },
    /// The Newton matrix could not be inverted.
    #[error("the Newton matrix is singular at t = {t:.6e} s with step {h:.3e} s")]
    SingularTangent {
        /// Time of the failure [s].
        t: f64,
        /// Step size [s].
        h: f64,
    },
    /// A coordinate became infinite or not a number.
    #[error("coordinate {dof} is not finite at t = {t:.6e} s: the run blew up; use a smaller step")]
    NonFinite {
        /// Time of the failure [s].
        t: f64,
        /// Index of the coordinate.
        dof: usize,
    },
    /// The error estimate requires a step below the resolution of time.
    #[error("step {h:.3e} s at t = {t:.6e} s is too small to go on: the tolerance cannot be met")]
    StepTooSmall {
        /// Time of the failure [s].
        t: f64,
        /// Step size [s].
        h: f64,
    },
    /// Contact modes switch repeatedly while time does not advance.
    #[error("contact chatter at t = {t:.6e} s: {events} events without progress")]
    Chatter {
        /// Time of the failure [s].
        t: f64,
        /// Number of events at that time.
        events: u32,
    },
    /// A bound of the run was reached, or would have been exceeded at the present pace.
    #[error("stopped at t = {t:.6e} s after {steps} steps: {bound}")]
    Timeout {
        /// Time at which the run was stopped [s].
        t: f64,
        /// Number of accepted steps.
        steps: u64,
        /// Bound that stopped the run.
        bound: Bound,
    },
    /// The run was stopped from outside.
    #[error("interrupted at t = {t:.6e} s")]
    Interrupted {
        /// Time at which the run was stopped [s].
        t: f64,
    },
    /// The method does not support a setting of the plan.
    #[error("{method} cannot run {what}")]
    Unsupported {
        /// Identifier of the method.
        method: &'static str,
        /// Description of the unsupported setting.
        what: &'static str,
    },
    /// The solver of a library failed.
    #[error("{method} failed at t = {t:.6e} s: {message}")]
    Library {
        /// Identifier of the method.
        method: &'static str,
        /// Time of the failure [s].
        t: f64,
        /// Error message of the library.
        message: String,
    },
}
