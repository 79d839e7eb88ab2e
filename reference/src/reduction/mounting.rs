//! How the hub of a reduced gear is mounted.

use crate::assembly::tie::HubMotion;
use gearbench_models::Vec3;
use gearbench_models::error::Reason;

/// Motion of the hub in the gear frame, its freedom, and the free out-of-plane directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounting {
    /// Turning about z, or the displacement of a rack along its own y.
    pub motion: HubMotion,
    /// True if the mount leaves the motion free; otherwise it is fixed or prescribed.
    pub free: bool,
    /// Inertia [kg m^2] (rack: mass [kg]) added at the hub.
    pub added_inertia: f64,
    /// Free out-of-plane directions of the hub: translations along x, y, z of the gear frame, rotations about them.
    /// See [`Mounting::lateral`].
    pub lateral: [bool; 6],
    /// Mass added at the hub, which moves in the free translations [kg].
    pub added_mass: f64,
    /// Inertia added at the hub about each axis except that of the own motion [kg m^2].
    pub added_tilting: f64,
}

/// The unit vector of a direction: translations along x, y, z, then rotations about them.
fn axis(direction: usize) -> Vec3 {
    let mut axis = Vec3::zeros();
    axis[direction % 3] = 1.0;
    axis
}

impl Mounting {
    /// A gear, whose hub turns about z.
    pub fn gear(free: bool, added_inertia: f64) -> Self {
        Mounting {
            motion: HubMotion::Turn,
            free,
            added_inertia,
            lateral: [false; 6],
            added_mass: 0.0,
            added_tilting: 0.0,
        }
    }

    /// A rack, whose hub travels along its own y.
    pub fn rack(free: bool, added_mass: f64) -> Self {
        Mounting {
            motion: HubMotion::Slide(Vec3::y()),
            added_mass,
            ..Mounting::gear(free, added_mass)
        }
    }

    /// Sets the free out-of-plane directions; the entry of the own motion is not used.
    ///
    /// # Errors
    /// The basis turns with its gear: x and y of a hub that turns are free together or held together, and so are the tilts
    /// about them.
    pub fn lateral(mut self, free: [bool; 6]) -> Result<Self, Reason> {
        self.lateral = free;
        self.lateral[self.own()] = false;
        let turns = self.own() == 5;
        for (what, [a, b]) in [("translations along", [0, 1]), ("tilts about", [3, 4])] {
            if turns && self.lateral[a] != self.lateral[b] {
                let cause = format!(
                    "of the {what} x and y of a hub that turns one is free and one is held, but modes turn with the gear and know \
                     no direction in space"
                );
                return Err((cause, "hold or free both; a stiff bearing holds one").into());
            }
        }
        Ok(self)
    }

    /// Adds a mass [kg], and an inertia about the axes other than the own one [kg m^2]. For a rack the mass is that
    /// already added to its motion.
    #[must_use]
    pub fn with_added(self, mass: f64, tilting: f64) -> Self {
        Mounting {
            added_mass: match self.own() {
                5 => mass,
                _ => self.added_inertia,
            },
            added_tilting: tilting,
            ..self
        }
    }

    /// The direction of the own motion among the six.
    pub fn own(&self) -> usize {
        match self.motion {
            HubMotion::Slide(_) => 1,
            HubMotion::Turn | HubMotion::TurnAbout(_) => 5,
        }
    }

    /// Returns true if the hub has out-of-plane freedom.
    pub fn is_lateral(&self) -> bool {
        self.lateral.contains(&true)
    }

    /// Iterates over the free directions, the own one first.
    pub fn directions(&self) -> impl Iterator<Item = usize> + '_ {
        let own = self.free.then_some(self.own());
        let lateral = (0..6).filter(|d| self.lateral[*d]);
        own.into_iter().chain(lateral)
    }

    /// Returns the motion in one of the six directions.
    pub fn motion_of(&self, direction: usize) -> HubMotion {
        match direction {
            d if d == self.own() => self.motion,
            0..3 => HubMotion::Slide(axis(direction)),
            _ => HubMotion::TurnAbout(axis(direction)),
        }
    }

    /// Returns the free motions, the own one first.
    pub fn motions(&self) -> Vec<HubMotion> {
        self.directions().map(|d| self.motion_of(d)).collect()
    }

    /// Returns the inertia added at the hub in each of the six directions [kg], [kg m^2].
    pub fn added(&self) -> [f64; 6] {
        let (m, i) = (self.added_mass, self.added_tilting);
        let mut added = [m, m, m, i, i, i];
        added[self.own()] = self.added_inertia;
        added
    }

    /// Returns the inertia added in each of the free motions.
    pub fn added_in_motions(&self) -> Vec<f64> {
        let added = self.added();
        self.directions().map(|d| added[d]).collect()
    }

    /// Rigid motion of all nodes by a unit of the hub's, three components each.
    pub fn rigid(&self, nodes: &[Vec3]) -> Vec<f64> {
        field(self.motion, nodes)
    }
}

/// Displacements of all nodes by a unit of a motion, three each.
pub(super) fn field(motion: HubMotion, nodes: &[Vec3]) -> Vec<f64> {
    (nodes.iter())
        .flat_map(|x| -> [f64; 3] { motion.of(x).into() })
        .collect()
}

/// Names of the six directions.
pub const DIRECTIONS: [&str; 6] = ["x", "y", "z", "tilt_x", "tilt_y", "tilt_z"];

/// Formats a mount with commas: `free` or `held`, then the free out-of-plane directions.
pub fn mount_text(free: bool, lateral: &[bool; 6]) -> String {
    let beside = DIRECTIONS.iter().zip(lateral).filter(|(_, free)| **free);
    let own = if free { "free" } else { "held" };
    std::iter::once(own)
        .chain(beside.map(|(name, _)| *name))
        .collect::<Vec<_>>()
        .join(",")
}
