//! Planet carriers: gears whose axes rotate with another body.
//!
//! Seen from a carrier that has turned by `theta_c` and moved by `u_c`, a planetary set is a train of gears on fixed axes.
//! Contacts, and the pins that hold planets, are evaluated in that **relative state**: angles less that of the carrier,
//! places turned back about its axis,
//!
//! ```text
//! theta~ = theta - theta_c,    u~ = R(-theta_c) (P + u - u_c) - P,    u~' = R(-theta_c) (u' - u_c') - theta_c' e_z x (P + u~)
//! ```
//!
//! with the place `P` of a hub from the axis of the carrier at the start. What they exert there acts by virtual work:
//!
//! ```text
//! T += T~,    F += R F~,    F_c -= R F~,    T_c -= T~ + e_z . ((P + u~) x F~)
//! ```
//!
//! so that coordinates stay absolute, the mass matrix diagonal, and energy, momentum and angular momentum are kept. A planet
//! without a bearing stands on a rigid pin: its mass turns with the carrier. Gears of a set that are held or driven turn
//! freely here, and a rigid link to the ground holds or drives them (Parker, Lin, *Modeling, modal properties, and mesh
//! stiffness variation instabilities of planetary gears*, NASA CR-2001-210939, has the same set in the frame of the carrier).
//!
//! | module | owns |
//! |---|---|
//! | `plan` | carriers of a scene from its settings; refusals |
//! | `relative` | the relative state, and how forces in it act |
//! | `carrier_frame` | what a scene does in it |
//! | `correction` | Newton corrections |

mod correction;
mod plan;
mod relative;
mod seen;

pub(super) use plan::{Ground, Sets, grounded};
pub(super) use relative::{Carriers, RelativeState};
