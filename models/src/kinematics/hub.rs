//! The hub that carries a gear: its position, its freedom, and the reaction of its mount.

use super::HubFrame;
use super::freedom::{self, Motion, OutOfPlane};
use super::row::Row;
use crate::Vec3;
use crate::spec::{Freedom, Mount, Profile};
use std::sync::Arc;

/// Force and torque on a gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force [N], in space.
    pub force: Vec3,
    /// Torque about the axis [N m]; for a translating body the force along its direction of motion [N].
    pub torque: f64,
}

/// Constraint of one of the six directions of a hub.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction<'a> {
    /// The mount fixes the direction.
    Fixed,
    /// The direction is a coordinate.
    Free,
    /// The speed is prescribed as a function of time.
    Driven(&'a Profile),
}

/// Position and freedom of a hub; shared by all gear models.
#[derive(Clone, Debug, PartialEq)]
pub struct Hub {
    /// Mount of the hub.
    pub mount: Mount,
    /// Centre of the hub at zero displacement [m].
    pub centre: Vec3,
    /// Unit direction of motion of a translating body; `None` for a rotating one.
    pub slide: Option<Vec3>,
    /// Inertia about the axis [kg m^2], or mass [kg] of a translating body; it includes the inertia added at the hub.
    pub inertia: f64,
    /// Right-handed axes of the hub at the assembled position: the third is that of the gear, the first the direction
    /// of motion of a translating body.
    pub axes: [Vec3; 3],
    /// Out-of-plane freedom of the hub; `None` where the mount fixes all other directions.
    pub lateral: Option<Arc<OutOfPlane>>,
}

impl Hub {
    /// Creates a hub that rotates about z or translates, and that a mount fixes in all other directions.
    pub fn new(mount: Mount, centre: Vec3, slide: Option<Vec3>, inertia: f64) -> Self {
        let first = slide.unwrap_or(Vec3::x());
        Hub {
            mount,
            centre,
            slide,
            inertia,
            axes: [first, Vec3::z().cross(&first), Vec3::z()],
            lateral: None,
        }
    }

    /// Returns true if the hub rotates or translates under forces; that coordinate is then the first.
    #[inline]
    pub fn is_free(&self) -> bool {
        matches!(self.mount, Mount::Revolute | Mount::Prismatic)
    }

    /// Returns the number of free coordinates: that of the hub's own motion, then the out-of-plane ones.
    #[inline]
    pub fn coordinates(&self) -> usize {
        usize::from(self.is_free()) + self.lateral.as_ref().map_or(0, |l| l.coordinates())
    }

    /// Iterates over the free directions in the order of their coordinates.
    pub fn free_directions(&self) -> impl Iterator<Item = usize> + '_ {
        let own = self.moving();
        let lateral = self.lateral.iter().flat_map(move |l| l.free(own));
        self.is_free().then_some(own).into_iter().chain(lateral)
    }

    /// Returns the angle or displacement from the assembled position at time `t`.
    #[inline]
    pub fn displacement(&self, t: f64, q: &[f64]) -> f64 {
        match &self.mount {
            Mount::Revolute | Mount::Prismatic => q[0],
            Mount::Fixed => 0.0,
            Mount::Driven(speed) => speed.integral(t),
        }
    }

    /// Returns the angular speed or the speed of displacement.
    #[inline]
    pub fn speed(&self, t: f64, v: &[f64]) -> f64 {
        match &self.mount {
            Mount::Revolute | Mount::Prismatic => v[0],
            Mount::Fixed => 0.0,
            Mount::Driven(speed) => speed.value(t),
        }
    }

    /// Returns the slope of a prescribed speed, or zero for other mounts.
    #[inline]
    pub fn prescribed_acceleration(&self, t: f64) -> f64 {
        match &self.mount {
            Mount::Driven(speed) => speed.slope(t),
            _ => 0.0,
        }
    }

    /// Returns the acceleration of a body that moves as its hub does, under a `load` where it is free.
    #[inline]
    pub fn acceleration(&self, t: f64, load: f64) -> f64 {
        if self.is_free() {
            load / self.inertia
        } else {
            self.prescribed_acceleration(t)
        }
    }

    /// Returns the constraints of the six directions: three translations along the axes of the hub, then three
    /// rotations about them.
    pub fn directions(&self) -> [Direction<'_>; 6] {
        let mut directions = [const { Direction::Fixed }; 6];
        if let Some(lateral) = &self.lateral {
            for (direction, freedom) in directions.iter_mut().zip(&lateral.directions) {
                *direction = match freedom {
                    Freedom::Fixed => Direction::Fixed,
                    Freedom::Free => Direction::Free,
                    Freedom::Driven(speed) => Direction::Driven(speed),
                };
            }
        }
        directions[self.moving()] = match &self.mount {
            Mount::Fixed => Direction::Fixed,
            Mount::Revolute | Mount::Prismatic => Direction::Free,
            Mount::Driven(speed) => Direction::Driven(speed),
        };
        directions
    }

    /// Returns the direction of the hub's own motion: the translation, or the rotation about z.
    #[inline]
    pub fn moving(&self) -> usize {
        if self.slide.is_some() { 0 } else { 5 }
    }

    /// Returns position and velocity of the hub in its six directions, from the coordinates of the gear.
    pub fn motion(&self, t: f64, q: &[f64], v: &[f64]) -> Motion {
        let mut motion = Motion::default();
        if let Some(lateral) = &self.lateral {
            let first = usize::from(self.is_free());
            lateral.fill(
                self.moving(),
                t,
                &q[first..],
                v.get(first..).unwrap_or(&[]),
                &mut motion,
            );
        }
        let own = self.moving();
        motion.x[own] = self.displacement(t, q);
        motion.v[own] = if self.is_free() {
            v.first().copied().unwrap_or(0.0)
        } else {
            self.speed(t, v)
        };
        motion.prescribed[own] = self.prescribed_acceleration(t);
        motion
    }

    /// Transforms a vector in the axes of the hub to space.
    #[inline]
    pub(super) fn in_space(&self, x: &Vec3) -> Vec3 {
        self.axes[0] * x.x + self.axes[1] * x.y + self.axes[2] * x.z
    }

    /// Returns the axes of the hub, not rotated with the gear, and its origin in space [m].
    pub fn frame(&self, t: f64, q: &[f64]) -> HubFrame {
        if self.lateral.is_none() {
            let along = self.slide.map_or(0.0, |_| self.displacement(t, q));
            return HubFrame {
                axes: self.axes,
                origin: self.centre + along * self.axes[0],
            };
        }
        self.frame_of(&self.motion(t, q, &[]).x)
    }

    /// Returns the frame of a hub that has moved by `x` in its six directions.
    fn frame_of(&self, x: &[f64; 6]) -> HubFrame {
        let mut turned = freedom::tilted(x);
        if self.slide.is_some() {
            turned *= freedom::turn(x[5]);
        }
        HubFrame {
            axes: [0, 1, 2].map(|k| self.in_space(&turned.column(k).into())),
            origin: self.centre + self.in_space(&Vec3::new(x[0], x[1], x[2])),
        }
    }

    /// Returns the component of a unit force along `n` at `x`, the wrench `[n; (x - c) x n]`, in one of the six
    /// directions at the assembled position.
    #[inline]
    pub fn component(&self, direction: usize, x: &Vec3, n: &Vec3) -> f64 {
        if direction < 3 {
            return self.axes[direction].dot(n);
        }
        let axis = &self.axes[direction - 3];
        let r = x - self.centre;
        axis.dot(&r.cross(n))
    }

    /// Returns the derivative of `x . n` with respect to the displacement for a point `x` that moves with the hub: the
    /// effective base radius arm about the axis [m], or the direction cosine for a translation [-]. It is valid at the
    /// assembled position, which is that of hubs without out-of-plane freedom.
    #[inline]
    pub fn effective_radius(&self, x: &Vec3, n: &Vec3) -> f64 {
        if self.slide.is_none() && self.axes[2] == Vec3::z() {
            let r = x - self.centre;
            return r.x * n.y - r.y * n.x;
        }
        self.component(self.moving(), x, n)
    }

    /// Returns the effective radius at the present position of the hub. See [`Self::effective_radius`].
    #[inline]
    pub fn effective_radius_at(&self, t: f64, q: &[f64], x: &Vec3, n: &Vec3) -> f64 {
        self.effective_radius_on(self.hub_pose(t, q).as_ref(), x, n)
    }

    /// Appends `S^T [n; (x - c) x n]` with the free directions `S` to a row; returns the part of `d(x . n)/dt` [m/s]
    /// from driven directions.
    #[inline]
    pub fn point_row(&self, t: f64, q: &[f64], x: &Vec3, n: &Vec3, row: &mut Row) -> f64 {
        if let Some(hub_pose) = self.hub_pose(t, q) {
            return self.lateral_row_on(t, &hub_pose, (x, n), row, true);
        }
        let along = self.effective_radius(x, n);
        if self.is_free() {
            row.push(0, along);
            return 0.0;
        }
        along * self.speed(t, &[])
    }

    /// Returns true if a part of the motion is prescribed.
    pub fn is_driven(&self) -> bool {
        let lateral = self.lateral.iter().flat_map(|l| &l.directions);
        matches!(self.mount, Mount::Driven(_))
            || lateral.into_iter().any(|d| matches!(d, Freedom::Driven(_)))
    }

    /// Returns true if the speed of the own motion is not prescribed, or is piecewise linear in time.
    pub fn moves_linearly(&self) -> bool {
        match &self.mount {
            Mount::Driven(speed) => speed.is_linear(),
            _ => true,
        }
    }

    /// Returns the reaction of the mount on a body that moves as its hub does and whose centre of mass lies on the
    /// axis, under contact forces `contact`. The torque of a free mount is zero, and so is the force along a free
    /// translation, whatever the loads on the hub.
    pub fn reaction(&self, t: f64, contact: &Wrench) -> Wrench {
        let pull = match &self.mount {
            Mount::Driven(speed) => self.inertia * speed.slope(t),
            _ => 0.0,
        };
        let free = self.is_free();
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

    /// Returns the next breakpoint of a prescribed motion after `t`.
    pub fn next_breakpoint(&self, t: f64) -> f64 {
        let own = match &self.mount {
            Mount::Driven(speed) => speed.next_breakpoint(t),
            _ => f64::INFINITY,
        };
        let lateral = self.lateral.iter().flat_map(|l| &l.directions);
        lateral.fold(own, |next, freedom| match freedom {
            Freedom::Driven(speed) => next.min(speed.next_breakpoint(t)),
            _ => next,
        })
    }
}

mod hub_pose;
#[cfg(test)]
mod tests;

pub use hub_pose::{BodyMotion, HubPose, PointWrench};
