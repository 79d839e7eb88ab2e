//! Pose of a hub with out-of-plane freedom at a state, shared by all points of its gear.
//!
//! A unit force along `n` at `x` has the wrench `[n; (x - o) x n]` about the place `o` of the hub. Of it the turn takes the
//! component along the turned axis, and the lateral directions `S^T` of it, in the axes of the mount. A [`PointWrench`] has a
//! moment of its own besides.

use super::Hub;
use crate::Vec3;
use crate::kinematics::HubFrame;
use crate::kinematics::freedom::{self, Motion};
use crate::kinematics::row::Row;
use crate::spec::Freedom;

/// Pose of a hub with out-of-plane directions.
#[derive(Clone, Copy, Debug)]
pub struct HubPose {
    motion: Motion,
    frame: HubFrame,
    /// Axes of the three rotations, in the axes of the mount.
    rotations: [Vec3; 3],
}

/// Force and moment about a point in space, on a body; likewise the derivative of a quantity by the motion of a body, `dy =
/// force . v + moment . w` with the velocity `v` of the body at that point and its angular velocity `w`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointWrench {
    /// Point in space [m].
    pub point: Vec3,
    /// Force.
    pub force: Vec3,
    /// Moment about the point.
    pub moment: Vec3,
}

impl PointWrench {
    /// Returns the moment about another point [m].
    #[inline]
    pub fn moment_about(&self, origin: &Vec3) -> Vec3 {
        (self.point - origin).cross(&self.force) + self.moment
    }

    /// Adds the multiple `x other`, about this point.
    #[inline]
    pub fn add(&mut self, x: f64, other: &PointWrench) {
        self.force += x * other.force;
        self.moment += x * other.moment_about(&self.point);
    }
}

/// Motion of a body on a hub, in space.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion {
    /// Position of the hub [m].
    pub origin: Vec3,
    /// Velocity of the hub [m/s].
    pub velocity: Vec3,
    /// Angular velocity of the body [rad/s].
    pub spin: Vec3,
    /// Axes of the three rotations in space.
    rotations: [Vec3; 3],
}

impl Hub {
    /// Returns the motion of a body on the hub.
    pub fn body_motion(&self, t: f64, q: &[f64], v: &[f64]) -> BodyMotion {
        let Motion { x, v, .. } = self.motion(t, q, v);
        let rotations = freedom::rotation_axes(&x).map(|axis| self.in_space(&axis));
        BodyMotion {
            origin: self.centre + self.in_space(&Vec3::new(x[0], x[1], x[2])),
            velocity: self.in_space(&Vec3::new(v[0], v[1], v[2])),
            spin: v[3] * rotations[0] + v[4] * rotations[1] + v[5] * rotations[2],
            rotations,
        }
    }

    /// Adds the generalised forces of a force [N] and of a moment [N m] about a point in space to those of the hub
    /// coordinates.
    pub fn add_wrench(
        &self,
        motion: &BodyMotion,
        (point, force, moment): (&Vec3, &Vec3, &Vec3),
        f: &mut [f64],
    ) {
        let moment = moment + (point - motion.origin).cross(force);
        for (f, d) in f.iter_mut().zip(self.free_directions()) {
            *f += match d {
                0..3 => self.axes[d].dot(force),
                _ => motion.rotations[d - 3].dot(&moment),
            };
        }
    }

    /// Returns the pose of the hub, or `None` where it only rotates or translates.
    pub fn hub_pose(&self, t: f64, q: &[f64]) -> Option<HubPose> {
        self.lateral.as_ref()?;
        let motion = self.motion(t, q, &[]);
        Some(HubPose {
            frame: self.frame_of(&motion.x),
            rotations: freedom::rotation_axes(&motion.x),
            motion,
        })
    }

    /// Returns [`Self::effective_radius_at`] for a known pose of the hub.
    #[inline]
    pub fn effective_radius_on(&self, hub_pose: Option<&HubPose>, x: &Vec3, n: &Vec3) -> f64 {
        let Some(HubPose { frame, .. }) = hub_pose else {
            return self.effective_radius(x, n);
        };
        match self.slide {
            None => frame.axes[2].dot(&(x - frame.origin).cross(n)),
            Some(slide) => slide.dot(n),
        }
    }

    /// Returns the component of a wrench in the direction of the hub's own motion.
    #[inline]
    pub fn own_component(&self, hub_pose: Option<&HubPose>, wrench: &PointWrench) -> f64 {
        let (axis, origin) = match hub_pose {
            Some(HubPose { frame, .. }) => (&frame.axes[2], &frame.origin),
            None => (&self.axes[2], &self.centre),
        };
        match &self.slide {
            None => axis.dot(&wrench.moment_about(origin)),
            Some(slide) => slide.dot(&wrench.force),
        }
    }

    /// Appends the out-of-plane directions to a row, and with `with_own` that of its own motion. Returns the part of
    /// `d(x . n)/dt` [m/s] from driven directions.
    pub fn lateral_row_on(
        &self,
        t: f64,
        hub_pose: &HubPose,
        (x, n): (&Vec3, &Vec3),
        row: &mut Row,
        with_own: bool,
    ) -> f64 {
        let wrench = PointWrench {
            point: *x,
            force: *n,
            moment: Vec3::zeros(),
        };
        self.wrench_row_on(t, hub_pose, &wrench, row, with_own)
    }

    /// Appends the components of a wrench in the out-of-plane directions to a row, and with `with_own` that in the direction
    /// of the hub's own motion. Returns the part of the power per unit wrench from driven directions.
    pub fn wrench_row_on(
        &self,
        t: f64,
        hub_pose: &HubPose,
        wrench: &PointWrench,
        row: &mut Row,
        with_own: bool,
    ) -> f64 {
        let Some(lateral) = &self.lateral else {
            return 0.0;
        };
        let own = self.moving();
        // Force and moment in the axes of the mount.
        let local = |y: &Vec3| {
            Vec3::new(
                self.axes[0].dot(y),
                self.axes[1].dot(y),
                self.axes[2].dot(y),
            )
        };
        let force = local(&wrench.force);
        let moment = local(&wrench.moment_about(&hub_pose.frame.origin));
        let component = |d: usize| match d {
            0..3 => force[d],
            _ => hub_pose.rotations[d - 3].dot(&moment),
        };
        let first = usize::from(self.is_free());
        row.push_span(first, lateral.free(own).map(component));
        let mut prescribed = 0.0;
        for (d, freedom) in lateral.directions.iter().enumerate() {
            if d != own && matches!(freedom, Freedom::Driven(_)) {
                prescribed += component(d) * hub_pose.motion.v[d];
            }
        }
        if with_own {
            if self.is_free() {
                row.push(0, component(own));
            } else {
                prescribed += component(own) * self.speed(t, &[]);
            }
        }
        prescribed
    }
}
