//! The hub that carries a gear: where it is, how its mount lets it move, what the mount exerts.

use super::HubFrame;
use super::freedom::{self, Lateral, Motion};
use super::row::Row;
use crate::Vec3;
use crate::spec::{Freedom, Mount, Profile};
use std::sync::Arc;

/// Force and torque on a gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force [N], in space.
    pub force: Vec3,
    /// Torque about the axis [N m]; of a body that slides the force along the slide [N].
    pub torque: f64,
}

/// What a mount makes of one of the six directions in which a hub could move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction<'a> {
    /// The mount holds it.
    Held,
    /// It is a coordinate.
    Free,
    /// Its speed is prescribed as a function of time.
    Driven(&'a Profile),
}

/// Where a hub is and how it moves; shared by all gear models.
#[derive(Clone, Debug, PartialEq)]
pub struct Hub {
    /// The mount.
    pub mount: Mount,
    /// Centre of the hub at zero displacement [m].
    pub centre: Vec3,
    /// Unit direction of displacement when the body slides; `None` when it turns.
    pub slide: Option<Vec3>,
    /// Inertia about the axis [kg m^2], or mass [kg] when the body slides; includes what is added at the hub.
    pub inertia: f64,
    /// Right-handed axes of the hub at the assembled position: the third is that of the gear, the first the slide of a body
    /// that slides.
    pub axes: [Vec3; 3],
    /// How the hub may move in its five other directions; `None` where the mount holds them all.
    pub lateral: Option<Arc<Lateral>>,
}

impl Hub {
    /// A hub about z, or on a slide, that a mount holds in all other directions.
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

    /// Whether the hub turns, or slides, as forces tell; that coordinate is then the first.
    #[inline]
    pub fn is_free(&self) -> bool {
        matches!(self.mount, Mount::Revolute | Mount::Prismatic)
    }

    /// Number of free coordinates: that of the hub's own motion, then the lateral ones.
    #[inline]
    pub fn coordinates(&self) -> usize {
        usize::from(self.is_free()) + self.lateral.as_ref().map_or(0, |l| l.coordinates())
    }

    /// The free directions in the order of their coordinates.
    pub fn free_directions(&self) -> impl Iterator<Item = usize> + '_ {
        let own = self.moving();
        let lateral = self.lateral.iter().flat_map(move |l| l.free(own));
        self.is_free().then_some(own).into_iter().chain(lateral)
    }

    /// Angle or displacement from the assembled position at time `t`.
    #[inline]
    pub fn displacement(&self, t: f64, q: &[f64]) -> f64 {
        match &self.mount {
            Mount::Revolute | Mount::Prismatic => q[0],
            Mount::Fixed => 0.0,
            Mount::Driven(speed) => speed.integral(t),
        }
    }

    /// Angular speed or speed of displacement.
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
        if self.is_free() {
            load / self.inertia
        } else {
            self.prescribed_acceleration(t)
        }
    }

    /// What the mount makes of the six directions: three translations along the axes of the hub, then three rotations about
    /// them.
    pub fn directions(&self) -> [Direction<'_>; 6] {
        let mut directions = [const { Direction::Held }; 6];
        if let Some(lateral) = &self.lateral {
            for (direction, freedom) in directions.iter_mut().zip(&lateral.directions) {
                *direction = match freedom {
                    Freedom::Held => Direction::Held,
                    Freedom::Free => Direction::Free,
                    Freedom::Driven(speed) => Direction::Driven(speed),
                };
            }
        }
        directions[self.moving()] = match &self.mount {
            Mount::Fixed => Direction::Held,
            Mount::Revolute | Mount::Prismatic => Direction::Free,
            Mount::Driven(speed) => Direction::Driven(speed),
        };
        directions
    }

    /// The direction that is not always held: along the slide, or about z.
    #[inline]
    pub fn moving(&self) -> usize {
        if self.slide.is_some() { 0 } else { 5 }
    }

    /// Where the hub is in its six directions and how fast, from the gear's coordinates.
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

    /// A vector in the axes of the hub, in space.
    #[inline]
    pub(super) fn in_space(&self, x: &Vec3) -> Vec3 {
        self.axes[0] * x.x + self.axes[1] * x.y + self.axes[2] * x.z
    }

    /// Axes of the hub, not turned with the gear, and its origin in space [m].
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

    /// The same of a hub that has moved by `x` in its six directions.
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

    /// Component of a unit force along `n` at `x`, the wrench `[n; (x - c) x n]`, in one of the six directions at the
    /// assembled position.
    #[inline]
    pub fn component(&self, direction: usize, x: &Vec3, n: &Vec3) -> f64 {
        if direction < 3 {
            return self.axes[direction].dot(n);
        }
        let axis = &self.axes[direction - 3];
        let r = x - self.centre;
        axis.dot(&r.cross(n))
    }

    /// Derivative of `x . n` with respect to the displacement for a point `x` that moves with the hub: the effective
    /// base radius arm about the axis [m], or the direction cosine for a slide [-]. At the assembled position, which is
    /// that of hubs without lateral freedom.
    #[inline]
    pub fn effective_radius(&self, x: &Vec3, n: &Vec3) -> f64 {
        if self.slide.is_none() && self.axes[2] == Vec3::z() {
            let r = x - self.centre;
            return r.x * n.y - r.y * n.x;
        }
        self.component(self.moving(), x, n)
    }

    /// The same where the hub is now.
    #[inline]
    pub fn effective_radius_at(&self, t: f64, q: &[f64], x: &Vec3, n: &Vec3) -> f64 {
        self.effective_radius_on(self.standing(t, q).as_ref(), x, n)
    }

    /// Appends `S^T [n; (x - c) x n]` with the free directions `S` to a row; returns the part of `d(x . n)/dt` [m/s]
    /// that driven directions prescribe.
    #[inline]
    pub fn point_row(&self, t: f64, q: &[f64], x: &Vec3, n: &Vec3, row: &mut Row) -> f64 {
        if let Some(standing) = self.standing(t, q) {
            return self.lateral_row_on(t, &standing, (x, n), row, true);
        }
        let along = self.effective_radius(x, n);
        if self.is_free() {
            row.push(0, along);
            return 0.0;
        }
        along * self.speed(t, &[])
    }

    /// Whether a part of its motion is prescribed.
    pub fn is_driven(&self) -> bool {
        let lateral = self.lateral.iter().flat_map(|l| &l.directions);
        matches!(self.mount, Mount::Driven(_))
            || lateral.into_iter().any(|d| matches!(d, Freedom::Driven(_)))
    }

    /// Whether the speed of its own motion is not prescribed, or piecewise linear in time.
    pub fn moves_linearly(&self) -> bool {
        match &self.mount {
            Mount::Driven(speed) => speed.is_linear(),
            _ => true,
        }
    }

    /// What the mount exerts on a body that moves as its hub does and whose centre of mass lies on the axis, while
    /// contacts exert `contact` on it. The torque of a mount that is free is zero, and so is the force along a free
    /// slide, whatever loads the hub.
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

    /// Next breakpoint of a prescribed motion after `t`.
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

mod standing;
#[cfg(test)]
mod tests;

pub use standing::{BodyMotion, Standing};
