//! Loads on a hub: functions of time, or viscous.

use super::profile::Profile;

/// A load on a hub: torque about the axis [N m], or force along the motion of a prismatic mount [N].
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// Load that is a function of time.
    Applied(Profile),
    /// Viscous load `-c v`, with `c` in N m s/rad or N s/m.
    Viscous(f64),
}

impl Load {
    /// Returns the largest magnitude [N m or N], for a hub that moves at `speed`.
    pub fn greatest(&self, speed: f64) -> f64 {
        match self {
            Load::Applied(profile) => profile.greatest(),
            Load::Viscous(c) => c * speed.abs(),
        }
    }
}
