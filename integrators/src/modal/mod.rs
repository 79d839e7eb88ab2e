//! Methods that are exact for linear oscillators: the trigonometric integrator.
//!
//! They run systems that are oscillators and a rest,
//!
//! ```text
//! q'' + 2 zeta omega q' + omega^2 q = g + r(t, q, q')
//! ```
//!
//! ([`ModalSplit`](crate::ModalSplit)), one oscillator per coordinate, with steady loads `g` and a remainder `r` that
//! is mostly contact. Between two evaluations of the remainder every oscillator moves in closed form, so the step is
//! bound by the contact, not by the highest frequency.
//!
//! | module | owns |
//! |---|---|
//! | [`propagator`] | an oscillator over a time in closed form; tables per step |
//! | [`trigonometric`] | the method: kick, drift, kick; flight in one step |
//! | [`resonance`] | steps that resonate with a frequency, and the filter against them |

pub mod propagator;
pub mod resonance;
pub mod trigonometric;
