//! Linear stability of the trigonometric method: impulses ("kicks") between exact oscillators.
//!
//! Without damping a kick-drift-kick step of `q'' + Omega^2 q = -K_c q` (unit masses) has the recurrence
//!
//! ```text
//! q_{n+1} - 2 cos(h Omega) q_n + q_{n-1} = -h^2 sinc(h Omega) F K_c F q_n,   F the filter
//! ```
//!
//! (E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical Integration*, XIII.2). As long as `sinc > 0`, up to
//! `omega h = pi`, the matrix of the right side is similar to a symmetric one, so that `z + 1/z` is real and the limit
//! is the first `h` at which
//!
//! ```text
//! 2 + 2 cos(h Omega) - h^2 S F K_c F S,   S = sqrt(sinc(h Omega))
//! ```
//!
//! loses definiteness (`z = -1`). For a free mass the limit is `4 = h^2 omega_c^2`. Beyond `pi` eigenvalues of both
//! signs coalesce and resonate; such steps are outside the intended range of the method (see
//! [`resonance`](crate::modal::resonance)).
//!
//! **Dampers.** With `D` in the impulses and every state proportional to `(-1)^n`, velocities before and after the
//! implicit half impulses of an instant are `(1 + h D / 2) v- = -h/2 K q`, and `v` at the instant is zero: the limit
//! is that without dampers ([`ModalSplit::remainder_after`](crate::ModalSplit::remainder_after), as for `C` in the
//! central difference method with implicit damping, T. J. R. Hughes, *The Finite Element Method*, 1987, 9.1.2). For a
//! system without implicit evaluation the impulse uses the predicted velocity, whose amplification of `v' = -lambda v`
//! is `[[1 - z/2, (1 - z)/2], [-z, -z]]`, `z = lambda h`, unstable from `z = 1` on: `d = 4` as for velocity Verlet.
//!
//! Where the system adds the compliance that the impulses leave out as local compliance
//! ([`ModalSplit::prepare`](crate::ModalSplit)), `K_c` depends on `h` through [`Impulses::quasi_static`].

use super::Flip;
use crate::modal::propagator::quasi_static_of;

/// Impulses of the remainder between exact oscillators, with a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulses {
    /// Phase `omega h` [rad] above which oscillators are filtered.
    pub filter_from: f64,
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

impl Impulses {
    /// Stability limit of a free mass on a remainder with dampers that are evaluated at the predicted velocity.
    /// Dampers that the system evaluates implicitly do not affect it.
    pub const FLIP: Flip = Flip { d: 4.0, k: 1.0 };

    /// Returns the filter factor of an oscillator, on its displacement in the remainder and on its impulse.
    #[must_use]
    pub fn filter(&self, omega: f64, h: f64) -> f64 {
        if omega * h > self.filter_from {
            sinc(omega * h)
        } else {
            1.0
        }
    }

    /// Returns the compliance per unit mass [s^2] by which the quasi-static response of an oscillator under the method
    /// falls short of `1/omega^2`.
    #[must_use]
    pub fn quasi_static(&self, omega: f64, h: f64) -> f64 {
        quasi_static_of(omega, h, self.filter_from)
    }

    /// Returns `2 + 2 cos(omega h)` and the weight `h sqrt(sinc(omega h)) f` of an oscillator; `None` at and beyond
    /// `omega h = pi`.
    #[must_use]
    pub fn weights(&self, omega: f64, h: f64) -> Option<[f64; 2]> {
        let x = omega * h;
        (x < std::f64::consts::PI).then(|| {
            [
                2.0 + 2.0 * x.cos(),
                h * sinc(x).sqrt() * self.filter(omega, h),
            ]
        })
    }
}
