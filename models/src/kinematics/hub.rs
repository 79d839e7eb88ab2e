//! The hub that carries a gear: where it is, how its mount lets it move, what the mount exerts.

use super::row::Row;
use crate::Vec3;
use crate::spec::{Mount, Profile};

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
}

impl Hub {
    /// Number of free coordinates: 0 or 1.
    #[inline]
    pub fn coordinates(&self) -> usize {
        usize::from(matches!(self.mount, Mount::Revolute | Mount::Prismatic))
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
        if self.coordinates() > 0 {
            load / self.inertia
        } else {
            self.prescribed_acceleration(t)
        }
    }

    /// What the mount makes of the six directions: three translations, along the slide of a body that slides, along x
    /// of any other, and so on in a right-handed frame about z; then three rotations about the same axes.
    pub fn directions(&self) -> [Direction<'_>; 6] {
        let mut directions = [Direction::Held; 6];
        directions[self.moving()] = match &self.mount {
            Mount::Fixed => Direction::Held,
            Mount::Revolute | Mount::Prismatic => Direction::Free,
            Mount::Driven(speed) => Direction::Driven(speed),
        };
        directions
    }

    /// The direction that is not always held: along the slide, or about z.
    #[inline]
    fn moving(&self) -> usize {
        if self.slide.is_some() { 0 } else { 5 }
    }

    /// Component of a unit force along `n` at `x`, the wrench `[n; (x - c) x n]`, in one of the six directions.
    #[inline]
    pub fn component(&self, direction: usize, x: &Vec3, n: &Vec3) -> f64 {
        let along = self.slide.unwrap_or(Vec3::new(1.0, 0.0, 0.0));
        match direction {
            0 => along.dot(n),
            1 => along.x * n.y - along.y * n.x,
            2 => n.z,
            5 => {
                let r = x - self.centre;
                r.x * n.y - r.y * n.x
            }
            _ => {
                let moment = (x - self.centre).cross(n);
                if direction == 3 {
                    along.dot(&moment)
                } else {
                    along.x * moment.y - along.y * moment.x
                }
            }
        }
    }

    /// Derivative of `x . n` with respect to the displacement for a point `x` that moves with the hub: the effective
    /// base radius arm about z [m], or the direction cosine for a slide [-].
    #[inline]
    pub fn effective_radius(&self, x: &Vec3, n: &Vec3) -> f64 {
        self.component(self.moving(), x, n)
    }

    /// Appends `S^T [n; (x - c) x n]` with the free directions `S` to a row; returns the part of `d(x . n)/dt` [m/s]
    /// that driven directions prescribe.
    #[inline]
    pub fn point_row(&self, t: f64, x: &Vec3, n: &Vec3, row: &mut Row) -> f64 {
        let along = self.effective_radius(x, n);
        if self.coordinates() > 0 {
            row.push(0, along);
            return 0.0;
        }
        along * self.speed(t, &[])
    }

    /// Whether its motion is prescribed.
    pub fn is_driven(&self) -> bool {
        matches!(self.mount, Mount::Driven(_))
    }

    /// What the mount exerts on a body that moves as its hub does and whose centre of mass lies on the axis, while
    /// contacts exert `contact` on it. The torque of a mount that is free is zero, and so is the force along a free
    /// slide, whatever loads the hub.
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

    /// Next breakpoint of a prescribed motion after `t`.
    pub fn next_breakpoint(&self, t: f64) -> f64 {
        match &self.mount {
            Mount::Driven(speed) => speed.next_breakpoint(t),
            _ => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moves a hub by a small amount in one of its directions.
    fn moved(hub: &Hub, direction: usize, by: f64, x: &Vec3) -> Vec3 {
        let along = hub.slide.unwrap_or(Vec3::x());
        let axes = [along, Vec3::z().cross(&along), Vec3::z()];
        match direction {
            0..3 => x + by * axes[direction],
            _ => x + by * axes[direction - 3].cross(&(x - hub.centre)),
        }
    }

    #[test]
    fn a_wrench_has_the_components_of_the_six_motions() {
        let (x, n) = (Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.48, 0.6, 0.64));
        for slide in [None, Some(Vec3::new(0.6, 0.8, 0.0))] {
            let hub = Hub {
                mount: Mount::Fixed,
                centre: Vec3::new(0.05, 0.1, -0.02),
                slide,
                inertia: 1.0,
            };
            for direction in 0..6 {
                let work = (moved(&hub, direction, 1.0, &x) - x).dot(&n);
                let found = hub.component(direction, &x, &n);
                assert!((found - work).abs() < 1e-15, "{direction}: {found} {work}");
            }
        }
    }

    #[test]
    fn mounts_leave_at_most_one_direction() {
        let speed = Profile::Constant(3.0);
        for (mount, slide, place, is) in [
            (Mount::Revolute, None, 5, Direction::Free),
            (Mount::Prismatic, Some(Vec3::y()), 0, Direction::Free),
            (
                Mount::Driven(speed.clone()),
                None,
                5,
                Direction::Driven(&speed),
            ),
            (Mount::Fixed, None, 5, Direction::Held),
        ] {
            let hub = Hub {
                mount,
                centre: Vec3::zeros(),
                slide,
                inertia: 1.0,
            };
            for (i, direction) in hub.directions().into_iter().enumerate() {
                let expected = if i == place { is } else { Direction::Held };
                assert_eq!(direction, expected);
            }
        }
    }
}
