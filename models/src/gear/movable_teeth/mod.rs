//! Tangentially movable teeth: one tangential coordinate per tooth (S. Ebrahimi, P. Eberhard,
//! *Contact modeling of meshing gear wheels using tangentially movable teeth*, SIMPACK user meeting 2006).
//!
//! Tooth `i` at angle `S_i`, body at `phi`, spring and damper between them on the radius `r_d`:
//!
//! ```text
//! m_t r_d^2 S_i'' + c r_d^2 (S_i' - phi') + k r_d^2 (S_i - phi) = T_i,       T_i = F_t,i r
//! J_b phi'' = sum_i [k r_d^2 (S_i - phi) + c r_d^2 (S_i' - phi')] + T_hub,   J_b = J - sum_i m_t r_d^2
//! ```
//!
//! The contact force of a tooth is projected on its normal (radial) and tangential direction: the radial part acts on
//! the body, the tangential part on the spring. On the line of action `F_t r = N r_b`, the effective base radius arm
//! of the contact row. The total inertia is preserved: that of the body is the total less that of the teeth.
//!
//! **Teeth out of contact are not integrated individually.** With equal teeth the mean `R` of those outside the
//! contact windows obeys the same equation as each of them, driven by the body, and their deviations `d_i = S_i - R`
//! obey the free equation `m d'' + c d' + k d = 0`, which has a closed form. As `sum d_i = 0` they do not act on the
//! body. So the state is `[phi, R, window teeth...]`: exact, at a cost that does not grow with the number of teeth.
//! When the gear rotates by a tooth the window moves by one: the tooth that leaves joins the mean, the tooth that
//! enters takes its place, momentum and energy are conserved (`deviations`). With unequal teeth all are integrated.
//! The error is bounded by rounding: integrated or not, a tooth obeys the same equation, so that the motion is the
//! same up to the error of the method, which applies to fewer teeth; in flight (`flight`) no tooth is integrated.
//!
//! A rack is the same with displacement for angles and `r_d = 1`.
//!
//! `k` may depend on the contact radius (`k(r)` of a tooth in contact, `k(r_0)` otherwise, `r_0` the first
//! breakpoint); the force on the tooth contains `k'(S) (S - phi)^2 / 2`, so that it is the derivative of the energy. What
//! a tooth that still swings gains or loses where its contact opens or closes is booked by the ledger as a jump.

mod deviations;
mod fit;
mod free_flight;
mod gear;
mod parameters;
mod reaction;
mod springs;
mod teeth;
mod windows;

pub use fit::FIT;
pub use parameters::{Integrate, MovableTeethParameters, PerTooth, build};
pub use teeth::MovableTeeth;
