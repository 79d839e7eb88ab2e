//! Planet carriers: gears whose axes rotate with another body.
//!
//! In the frame of a carrier that has rotated by `theta_c` and moved by `u_c`, a planetary set is a train of gears on
//! fixed axes. Contacts, and the pins of planets, are evaluated in this **carrier-frame state**: angles less that of
//! the carrier, positions rotated back about its axis,
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
//! so that coordinates stay absolute, the mass matrix diagonal, and energy, momentum and angular momentum are
//! conserved. A planet without a bearing is on a rigid pin: its mass rotates with the carrier. Gears of a set with
//! fixed or driven mounts rotate freely here, and a rigid link to the ground fixes or drives them (Parker, Lin, *Modeling,
//! modal properties, and mesh stiffness variation instabilities of planetary gears*, NASA CR-2001-210939, has the same
//! set in the frame of the carrier).
//!
//! | module | owns |
//! |---|---|
//! | `plan` | carriers of a scene from its settings; refusals |
//! | `relative` | the relative state, and how forces in it act |
//! | `carrier_frame` | what a scene does in it |
//! | `correction` | Newton corrections |

mod carrier_frame;
mod correction;
mod plan;
mod relative;

pub(super) use plan::{Ground, PlanetarySets, grounded};
pub(super) use relative::{CarrierFrameState, Carriers};
