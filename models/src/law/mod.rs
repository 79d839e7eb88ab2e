//! Normal and tangential contact laws: force, its derivatives and its elastic energy.
//!
//! Convention, stated here once: the gap `g` (m) is positive when open, the penetration is
//! `d = -g`, the gap rate `g' < 0` while the bodies approach, and the normal force `N >= 0` is
//! compressive. `v0 > 0` is the approach speed `-g'` at the instant of first touch.
//!
//! The normal force is
//!
//! ```text
//! none            N = k d^n
//! Kelvin-Voigt    N = k d^n + c d'
//! all others      N = k d^n (1 + chi d' / v0)
//! ```
//!
//! | damping | chi | source |
//! |---|---|---|
//! | Hunt-Crossley | 3 (1 - e) / 2 | J. Appl. Mech. 42 (1975) 440-445 |
//! | Lankarani-Nikravesh | 3 (1 - e^2) / 4 | J. Mech. Des. 112 (1990) 369-376 |
//! | Flores et al. | 8 (1 - e) / (5 e) | Multibody Syst. Dyn. 25 (2011) 357-375 |
//! | Gonthier et al. | (1 - e^2) / e | Multibody Syst. Dyn. 11 (2004) 209-233 |
//!
//! The restitution `r` such a law really gives in a free impact is the same for every exponent:
//! it solves `chi (1 + r) = ln((1 + chi) / (1 - chi r))` ([`realised_restitution`]). The first two
//! factors meet `r = e` only near `e = 1`; the last two stay close to it over the whole range.
//!
//! Event-located integration needs a branch that stays smooth while a root is sought, so
//! [`Law::smooth`] continues the law oddly into the open gap and does not clip; the force that acts
//! is [`Law::clipped`]: zero when open, zero instead of tensile (contact never pulls).

mod damping;
mod error;
mod friction;
mod normal;
#[cfg(test)]
mod tests;

pub use damping::Damping;
pub use error::LawError;
pub use friction::{Friction, FrictionForce};
pub use normal::{Law, LawForce, realised_restitution};
