//! Steps that resonate with an oscillator, and the filter against them.
//!
//! The forces act once per step. Where `omega h` is near a multiple of pi an oscillator returns to its position after
//! each step, except for the sign, and the impulses of a contact add up instead of cancelling: the energy of such a
//! mode is not bounded by a modified one (E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical Integration*, 2nd ed.
//! 2006, XIII.1.5 and XIII.4; B. Garcia-Archilla, J. M. Sanz-Serna, R. D. Skeel, *SIAM J. Sci. Comput.* 20 (1998)
//! 930).
//!
//! A body with one elastic mode under a steady load, resting on a stop or bouncing on it, 40000 steps with
//! `omega_c h = 0.13` (a contact of 24 steps) and 0.5 (six steps): the largest energy error over the energy of the
//! motion, without a filter and with the default one, which takes modes beyond `0.64 pi/h = 2.01/h` by their mean over
//! the step (`cargo test --release -p gearbench-integrators --test suite filtered_modes -- --nocapture`):
//!
//! | `omega h` | 0.1 | 1 | 2 | 2.5 | 3 | 4 | 5 | 6 | 6.28 | 6.5 | 10 |
//! |---|---|---|---|---|---|---|---|---|---|---|---|
//! | 0.13, resting, none | 5e-2 | 4e-2 | 3e-2 | 2e-2 | 5e-3 | 7e-2 | 0.4 | 8 | > 1e6 | 13 | 3e-2 |
//! | 0.13, resting, default | 5e-2 | 4e-2 | 3e-2 | 7e-3 | 3e-3 | 5e-3 | 5e-3 | 4e-3 | 3e-3 | 4e-3 | 3e-3 |
//! | 0.13, bouncing, none | 2e-2 | 9e-3 | 5e-3 | 4e-3 | 4e-3 | 4e-3 | 5e-3 | 0.3 | 5e4 | 1 | 4e-3 |
//! | 0.13, bouncing, default | 2e-2 | 9e-3 | 5e-3 | 4e-3 | 4e-3 | 4e-3 | 4e-3 | 4e-3 | 4e-3 | 4e-3 | 4e-3 |
//! | 0.5, resting, none | 0.8 | 0.6 | 0.5 | 0.3 | 9e-2 | 1 | 6 | 150 | > 1e6 | 160 | 0.4 |
//! | 0.5, resting, default | 0.8 | 0.6 | 0.5 | 0.1 | 4e-2 | 7e-2 | 8e-2 | 0.1 | 4e-2 | 9e-2 | 4e-2 |
//! | 0.5, bouncing, none | 0.2 | 0.2 | 0.2 | 0.2 | 3 | 1 | 0.1 | 3e3 | 5e4 | 30 | 4e-2 |
//! | 0.5, bouncing, default | 0.2 | 0.2 | 0.2 | 4e-2 | 4e-2 | 4e-2 | 4e-2 | 4e-2 | 4e-2 | 0.2 | 4e-2 |
//!
//! Around even multiples of pi, where the impulses of a sustained force add up, a run is useless; around odd ones a
//! contact of few steps gains energy. The filter `phi = sinc(omega h)`, with impulses `phi r(phi q)`, is the
//! symplectic and symmetric pair `psi = sinc phi` of that book (XIII.2.2). It weakens the filtered modes: a mode that
//! matters to the contact should not need it.

use std::f64::consts::PI;

/// Fraction of `pi / h` up to which frequencies are safe: no contact stiffness that the step resolves shifts such an
/// oscillator into resonance. Modes beyond it belong into a residual compliance.
pub const SAFE: f64 = 0.64;

/// Half width of a resonance around a multiple of pi [rad].
pub const WIDTH: f64 = 0.3;

/// Oscillators whose displacement the remainder receives as its mean over the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// No oscillator is filtered.
    None,
    /// Oscillators with `omega h` beyond `0.64 pi` are filtered.
    #[default]
    Fast,
    /// All oscillators are filtered.
    All,
}

impl Filter {
    /// Returns the phase `omega h` [rad] above which oscillators are filtered.
    #[must_use]
    pub fn from(self) -> f64 {
        match self {
            Filter::None => f64::INFINITY,
            Filter::Fast => SAFE * PI,
            Filter::All => 0.0,
        }
    }
}

/// An oscillator near resonance with a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Index of the coordinate.
    pub mode: usize,
    /// Phase `omega h` of the oscillator [rad].
    pub phase: f64,
    /// Nearest multiple of pi.
    pub multiple: u32,
}

/// Lists the oscillators, by frequency [rad/s], whose `omega h` lies within [`WIDTH`] of a multiple of pi.
pub fn resonances(omega: &[f64], h: f64) -> Vec<Resonance> {
    let near = |(mode, w): (usize, &f64)| {
        let phase = w * h;
        let multiple = (phase / PI).round();
        (multiple >= 1.0 && (phase - multiple * PI).abs() <= WIDTH).then_some(Resonance {
            mode,
            phase,
            multiple: multiple as u32,
        })
    };
    omega.iter().enumerate().filter_map(near).collect()
}

/// Returns the largest step [s] at which all frequencies [rad/s] are safe; infinite without oscillators.
pub fn safe_step(omega: &[f64]) -> f64 {
    SAFE * PI / omega.iter().copied().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resonances_are_the_multiples_of_pi() {
        let omega = [0.0, 0.1, 2.0, 3.0, PI, 3.5, 6.2, 9.0, 9.2];
        let found = resonances(&omega, 1.0);
        let named: Vec<(usize, u32)> = found.iter().map(|r| (r.mode, r.multiple)).collect();
        assert_eq!(named, [(3, 1), (4, 1), (6, 2), (8, 3)]);
        assert!(resonances(&omega, safe_step(&omega)).is_empty());
        assert_eq!(safe_step(&[0.0]), f64::INFINITY);
    }
}
