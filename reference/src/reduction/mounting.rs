//! How the hub of a reduced gear is mounted.

use crate::assembly::tie::HubMotion;
use gearbench_models::Vec3;

/// The one motion of the hub, in the gear's own frame, and whether the mount leaves it free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounting {
    /// Turning about z, or the displacement of a rack along its own y.
    pub motion: HubMotion,
    /// The mount leaves the motion free; else it is held or prescribed.
    pub free: bool,
    /// Inertia [kg m^2] (rack: mass [kg]) added at the hub.
    pub added_inertia: f64,
}

impl Mounting {
    /// A gear, whose hub turns about z.
    pub fn gear(free: bool, added_inertia: f64) -> Self {
        Mounting {
            motion: HubMotion::Turn,
            free,
            added_inertia,
        }
    }

    /// A rack, whose hub travels along its own y.
    pub fn rack(free: bool, added_mass: f64) -> Self {
        Mounting {
            motion: HubMotion::Slide(Vec3::y()),
            free,
            added_inertia: added_mass,
        }
    }

    /// The motions that are free: one or none.
    pub fn motions(&self) -> Vec<HubMotion> {
        if self.free {
            vec![self.motion]
        } else {
            Vec::new()
        }
    }

    /// Rigid motion of all nodes by a unit of the hub's, three components each.
    pub fn rigid(&self, nodes: &[Vec3]) -> Vec<f64> {
        (nodes.iter())
            .flat_map(|x| -> [f64; 3] { self.motion.of(x).into() })
            .collect()
    }
}
