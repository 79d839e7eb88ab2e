//! Linear stability of methods at fixed steps: for which `h` do the solutions of
//!
//! ```text
//! M q'' + D q' + K q = 0,   M, D, K symmetric, M > 0, D, K >= 0
//! ```
//!
//! stay bounded. Every method of the table declares the data that determine this ([`Stability`]);
//! [`Stability::largest_step`] returns the limit for one oscillator `q'' + 2 zeta omega q' + omega^2 q = 0`.
//!
//! **Runge-Kutta methods** see the system in first order, `y' = A y`. With `lambda` an eigenvalue of `A` a step
//! multiplies by `R(h lambda)`, `R(z) = 1 + z b^T (I - z A_tableau)^-1 1`, a polynomial for explicit ones
//! (E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.2). On the imaginary axis, where undamped
//! systems are, the classical method is stable to `|z| = 2 sqrt 2`, Dormand-Prince to 0.9972 only, beyond which it
//! grows slowly; on the negative real axis to 2.785 and 3.307.
//!
//! **Methods of displacement and velocity** leave the unit circle through `z = -1`: with every state proportional to
//! `(-1)^n` the recurrence becomes `(4 M - d h D - k h^2 K) q = 0`, so that the limit is the first `h` at which that
//! matrix is singular, whether or not `D` has the modes of `M` and `K` ([`Flip`]).
//!
//! | method | d | k | limit of an oscillator, `x = omega h` |
//! |---|---|---|---|
//! | velocity Verlet, damping at the predicted `v + h a` | 4 | 1 | `2 (sqrt(1 + 4 zeta^2) - 2 zeta)` |
//! | semi-implicit Euler, damping at the old `v` | 2 | 1 | `2 (sqrt(1 + zeta^2) - zeta)` |
//! | Newmark, gamma = 1/2, beta < 1/4 | 0 | 1 - 4 beta | `2 / sqrt(1 - 4 beta)` |
//!
//! The last two are the classical results (T. Belytschko, in *Computational Methods for Transient Analysis*, 1983, 1;
//! T. J. R. Hughes, *The Finite Element Method*, 1987, 9.1). For velocity Verlet the amplification polynomial is
//! `z^3 + (X - 2 + 3Y/2) z^2 + (1 - 2Y) z + Y/2` with `X = x^2`, `Y = 2 zeta x`; by Jury's conditions its complex roots
//! stay inside until `Y^2 - 3Y + 2 <= 0`, `Y >= 1`, which the flip at `4 = X + 4Y` comes before.
//!
//! Dampers that a system takes implicitly ([`force_after`](crate::SecondOrderSystem::force_after), as contacts do with
//! dashpots at flanks) do not show in the limit of velocity Verlet: with a state proportional to `(-1)^n` the velocity at
//! the end of a kick is zero, so that `D` has the other dampers alone ([`Flip::predicts`]), and `2 / omega` is the limit
//! without these.
//!
//! **The trigonometric method** is exact for oscillators and kicks them by the rest, see [`Impulses`].
//!
//! Newmark with beta >= 1/4, HHT-alpha and generalised-alpha with the parameters of their declared ranges are stable at
//! every step on linear systems. Methods that run under a tolerance only choose their steps themselves.

mod impulses;
mod polynomial;

#[cfg(test)]
mod tests;

pub use impulses::Impulses;
pub use polynomial::{first_exit, modulus};

/// Data that determine the stability of a method at fixed steps.
#[derive(Clone, Debug, PartialEq)]
pub enum Stability {
    /// Stability polynomial: the coefficients of `R(z)` from order zero on.
    Polynomial(Vec<f64>),
    /// The limit is where `4 M - d h D - k h^2 K` becomes singular.
    Flip(Flip),
    /// Impulses of the remainder between exact oscillators.
    Impulses(Impulses),
    /// Every step is stable.
    Unconditional,
    /// The method has no fixed steps.
    Controlled,
}

/// Coefficients of the matrix `4 M - d h D - k h^2 K`, which is singular at the stability limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// Coefficient of the damping matrix.
    pub d: f64,
    /// Coefficient of the stiffness matrix.
    pub k: f64,
}

impl Flip {
    /// Returns true if the method predicts the velocities at the end of a step (`d = 4`). Where the system can
    /// evaluate its forces at that end ([`force_after`](crate::SecondOrderSystem::force_after)), the dampers that it
    /// evaluates so do not belong to `D`.
    #[must_use]
    pub fn predicts(&self) -> bool {
        self.d == Impulses::FLIP.d
    }

    /// Returns the largest stable step [s] of an oscillator: the positive root of `k x^2 + 2 d zeta x = 4` over
    /// `omega`.
    #[must_use]
    pub fn largest_step(&self, omega: f64, zeta: f64) -> f64 {
        let damped = self.d * zeta;
        // Without cancellation for heavy damping.
        4.0 / (damped + (damped * damped + 4.0 * self.k).sqrt()) / omega
    }
}

/// Returns the eigenvalues `[re, im]` [1/s] of an oscillator in first-order form; the second is the conjugate of a
/// complex one.
#[must_use]
pub fn eigenvalues_of(omega: f64, zeta: f64) -> [[f64; 2]; 2] {
    let rest = (1.0 - zeta) * (1.0 + zeta);
    let re = -zeta * omega;
    if rest >= 0.0 {
        let im = omega * rest.sqrt();
        [[re, im], [re, -im]]
    } else {
        let fast = re - omega * (-rest).sqrt();
        // Their product is omega^2.
        [[fast, 0.0], [omega * omega / fast, 0.0]]
    }
}

impl Stability {
    /// Returns the largest stable step [s] for an oscillator of frequency `omega` [rad/s] and damping ratio `zeta`, or
    /// `None` where every step is stable or the method has no fixed steps. For the trigonometric method the oscillator
    /// is a free mass on a contact.
    #[must_use]
    pub fn largest_step(&self, omega: f64, zeta: f64) -> Option<f64> {
        match self {
            Stability::Polynomial(r) => {
                let exits = eigenvalues_of(omega, zeta).map(|z| first_exit(r, z));
                Some(exits[0].min(exits[1]))
            }
            Stability::Flip(flip) => Some(flip.largest_step(omega, zeta)),
            Stability::Impulses(_) => Some(Impulses::FLIP.largest_step(omega, zeta)),
            Stability::Unconditional | Stability::Controlled => None,
        }
    }
}
