//! Steps that resonate with a frequency.
//!
//! The forces act once per step. Where `omega h` is near a multiple of pi an oscillator stands, after each step, where
//! it stood before, but for its sign, and the kicks of a contact add up instead of cancelling: the energy of such a
//! mode is not bounded by a modified one (E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical Integration*,
//! 2nd ed. 2006, XIII.1.5 and XIII.4; B. Garcia-Archilla, J. M. Sanz-Serna, R. D. Skeel, *SIAM J. Sci. Comput.* 20
//! (1998) 930).

use std::f64::consts::PI;

/// Part of `pi / h` up to which frequencies are safe: below, no contact stiffness that the step resolves moves an
/// oscillator into resonance. Modes beyond it belong into a residual compliance.
pub const SAFE: f64 = 0.64;

/// Half width of a resonance around a multiple of pi [rad].
pub const WIDTH: f64 = 0.3;

/// An oscillator near resonance with a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Index of the coordinate.
    pub mode: usize,
    /// `omega h` [rad].
    pub phase: f64,
    /// The multiple of pi that it is near to.
    pub multiple: u32,
}

/// The oscillators, by frequency [rad/s], whose `omega h` lies within [`WIDTH`] of a multiple of pi.
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

/// The largest step [s] at which all frequencies [rad/s] are safe; infinite where nothing oscillates.
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
