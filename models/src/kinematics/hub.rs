//! The hub that carries a gear: where it is, how its mount lets it move, what the mount exerts.

use crate::Vec3;
use crate::spec::Mount;

/// Force and torque on a gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force [N], in space.
    pub force: Vec3,
    /// Torque about the axis [N m]; of a body that slides the force along the slide [N].
    pub torque: f64,
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

    /// Slope of a prescribed speed; zero for other mounts.
    #[inline]
    pub fn prescribed_acceleration(&self, t: f64) -> f64 {
        match &self.mount {
            Mount::Driven(speed) => speed.slope(t),
            _ => 0.0,
        }
    }

    /// Acceleration of a body that moves as its hub does, under a `load` where it is free.
    #[inline]
    pub fn acceleration(&self, t: f64, load: f64) -> f64 {
        if self.coordinates() > 0 {
            load / self.inertia
        } else {
            self.prescribed_acceleration(t)
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

    /// What the mount exerts on a body that moves as its hub does and whose centre of mass lies on the axis, while
    /// contacts exert `contact` on it. The torque of a mount that is free is zero, and so is the force along a free
    /// slide, whatever loads the hub.
    #[must_use]
    pub fn reaction(&self, t: f64, contact: &Wrench) -> Wrench {
        let pull = match &self.mount {
            Mount::Driven(speed) => self.inertia * speed.slope(t),
            _ => 0.0,
        };
        let free = self.coordinates() > 0;
        let mut force = -contact.force;
        if let Some(direction) = &self.slide {
            let along = if free { force.dot(direction) } else { -pull };
            force -= along * direction;
        }
        Wrench {
            force,
            torque: if free { 0.0 } else { pull - contact.torque },
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
