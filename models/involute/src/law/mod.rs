//! Normal and tangential contact laws: force, its derivatives and its elastic energy.
//!
//! Convention, stated here once: the gap `g` (m) is positive when open, the penetration is
//! `d = -g`, the gap rate `g' < 0` while the bodies approach, and the normal force `N >= 0` is
//! compressive. `v0 >= 0` is the approach speed `-g'` at the instant of first touch.
//!
//! The normal force is
//!
//! ```text
//! none            N = k d^n
//! Kelvin-Voigt    N = k d^n + c d'
//! bounded         N = k d^n + c d', |c d'| <= k d^n
//! ratio at load   N = k d^n (1 + d' / v_L)
//! all others      N = k d^n (1 + chi d' / v),    v = max(v0 + v_L, |d'|)
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
//! **Under load.** A contact that closes under load has hardly any approach speed, so `d'/v0` alone would damp it by any
//! amount. The load speed `v_L` is what the speed of vibration under the load of the mesh is measured by: with the force
//! `F` of the load, `d_0 = (F/k)^(1/n)`, `k_t = n F / d_0` and the reduced mass `m` of both gears,
//!
//! ```text
//! v_L = chi F / (2 zeta sqrt(k_t m)),    zeta = -ln(e)/pi   (or the ratio at load)
//! ```
//!
//! so that small vibrations about the load have the damping ratio `zeta`, which is what a restitution `e` loses in half a
//! period; with `e` near 1 it is near none. A free impact has `v_L = 0`: its restitution is that of the table's law, at any speed. A
//! contact that is squeezed faster than it was touched takes that speed: no force is more than `1 + chi` times the elastic
//! one. A contact that closes without speed, as one that starts in the equilibrium of its load, has the touch speed zero
//! for as long as it stays closed: its damping is `zeta` alone. Kelvin-Voigt damping is the same under any load; a ratio of it is that of the stiffest pair.
//!
//! **Bounded dashpot.** A constant damper pushes with a jump where flanks touch; bounded by the elastic force it does not
//! (K. H. Hunt, F. R. E. Crossley, *J. Appl. Mech.* 42 (1975) 440; the backlash `ElastoBacklash` of the Modelica Standard
//! Library). Its force has three branches, `2 k d^n` while the dashpot would push with more than the spring, `k d^n + c d'`,
//! and none while it would pull with more: which one holds is the [mode](Law::mode) of a contact, and each is smooth.
//!
//! Event-located integration needs a branch that stays smooth while a root is sought, so
//! [`Law::smooth`] continues the law oddly into the open gap and does not clip; the force that acts
//! is [`Law::clipped`]: zero when open, zero instead of tensile (contact never pulls).

mod branches;
mod damping;
mod dry;
mod error;
mod friction;
mod half_space;
mod normal;
mod retardation;
#[cfg(test)]
mod tests;
mod user_law;

pub use branches::{CLOSED, OPEN, SATURATED, UNTOUCHED, touch_speed};
pub use damping::{Damping, DampingKeys, realised_restitution};
pub use dry::{DryFriction, Part};
pub use error::LawError;
pub use friction::{Film, Friction, FrictionForce, FrictionForm, MeshFilm};
pub use half_space::HalfSpace;
pub use normal::{Law, LawForce, MeshLoad};
pub use retardation::{SeenBy, retarded};
pub use user_law::{ContactState, ForceLaw};
