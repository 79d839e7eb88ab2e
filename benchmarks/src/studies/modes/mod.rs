//! Natural frequencies and shapes of a whole scene about its loaded state.
//!
//! ```text
//! (K - omega^2 M) x = 0,    C x = 0
//! ```
//!
//! with the scene's own mass, tangents and constraints ([`small signals`](gearbench_models::scene::LinearisedScene)) where its
//! loads have come to rest ([`loaded`](crate::small_signals::loaded)). Modes are named by where their energy lies.
//!
//! | module | owns |
//! |---|---|
//! | `shares` | shares of energy by member, mesh, shaft and bearing; names |

pub(crate) mod arguments;
pub(crate) mod command;
mod plan;
mod run;
mod shares;
mod summary;

pub use plan::Plan;
pub use run::{ModesSettings, study, vibrations};
