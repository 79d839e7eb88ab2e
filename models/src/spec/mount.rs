//! Mounts: how the hub of a gear may move.
//!
//! | mount | free coordinate | motion |
//! |---|---|---|
//! | fixed | none | at rest |
//! | revolute | angle about z [rad] | about the gear's centre |
//! | prismatic | displacement [m] | along a direction, as a rack |
//! | driven | none | a prescribed speed, about z or along the slide |

use super::load::Profile;

/// How a hub may move.
#[derive(Clone, Debug, PartialEq)]
pub enum Mount {
    /// At rest.
    Fixed,
    /// Free to turn about its axis.
    Revolute,
    /// Free to slide.
    Prismatic,
    /// Speed prescribed as a function of time [rad/s], or [m/s] for a rack.
    Driven(Profile),
}
