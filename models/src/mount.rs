//! Mounts: how the hub of a gear may move.
//!
//! | mount | free coordinate | motion |
//! |---|---|---|
//! | fixed | none | at rest |
//! | revolute | angle about z [rad] | about the gear's centre |
//! | prismatic | travel [m] | along a direction, as a rack |
//! | driven | none | a prescribed speed, about z or along the slide |

use crate::Vec3;
use crate::load::Profile;

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

/// Where a hub is and how it moves; shared by all gear models.
#[derive(Clone, Debug, PartialEq)]
pub struct Hub {
    /// The mount.
    pub mount: Mount,
    /// Centre of the hub at zero travel [m].
    pub centre: Vec3,
    /// Unit direction of travel when the body slides; `None` when it turns.
    pub slide: Option<Vec3>,
    /// Inertia about the axis [kg m^2], or mass [kg] when the body slides; includes what is added at the hub.
    pub inertia: f64,
}

impl Hub {
    /// Number of free coordinates: 0 or 1.
    #[inline]
    pub fn coordinates(&self) -> usize {
        usize::from(matches!(self.mount, Mount::Revolute | Mount::Prismatic))
    }

    /// Angle or travel from the assembled position at time `t`.
    #[inline]
    pub fn travel(&self, t: f64, q: &[f64]) -> f64 {
        match &self.mount {
            Mount::Revolute | Mount::Prismatic => q[0],
            Mount::Fixed => 0.0,
            Mount::Driven(speed) => speed.integral(t),
        }
    }

    /// Angular speed or speed of travel.
    #[inline]
    pub fn speed(&self, t: f64, v: &[f64]) -> f64 {
        match &self.mount {
            Mount::Revolute | Mount::Prismatic => v[0],
            Mount::Fixed => 0.0,
            Mount::Driven(speed) => speed.value(t),
        }
    }

    /// Derivative of `x . n` with respect to the travel for a point `x` that moves with the hub: the lever
    /// arm about z [m], or the direction cosine for a slide [-].
    #[inline]
    pub fn lever(&self, x: &Vec3, n: &Vec3) -> f64 {
        match &self.slide {
            None => {
                let r = x - self.centre;
                r.x * n.y - r.y * n.x
            }
            Some(direction) => direction.dot(n),
        }
    }

    /// Next knot of a prescribed motion after `t`.
    pub fn next_knot(&self, t: f64) -> f64 {
        match &self.mount {
            Mount::Driven(speed) => speed.next_knot(t),
            _ => f64::INFINITY,
        }
    }
}
