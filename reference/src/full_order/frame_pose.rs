//! Pose of a hub of several directions: frame, axes of its directions, and their rotations.
//!
//! Velocities are linear in the rates of the hub, `v = sum_d x_d' v_d` at a place `y` from its origin: `v_d = a_d` along an axis
//! of the hub, `v_d = w_d x y` about one of the three axes of its rotations, `e_x`, `Rx e_y`, `Rx Ry e_z` in the axes of the
//! hub, each of which turns with those before it. So with the spin `w = sum x_d' w_d` accelerations hold, beside those of the
//! rates,
//!
//! ```text
//! w_b x y + w x (w x y),     w_b = sum over i < j of x_i' x_j' (w_i x w_j)
//! ```
//!
//! as in [`gearbench_models::kinematics`].

use super::frame::Frame;
use gearbench_integrators::system::StateView;
use gearbench_models::Vec3;
use gearbench_models::kinematics::{Hub, Motion};
use nalgebra::Matrix3;

/// The pose of a hub and the axes of its directions in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct FramePose {
    /// Turn from the assembled position.
    pub turn: Matrix3<f64>,
    /// Displacement of its origin [m].
    pub shift: Vec3,
    /// Directions of the three translations, axes of the three rotations.
    pub axes: [Vec3; 6],
    /// Place and rates in the six directions.
    pub motion: Motion,
}

/// Change of a pose for a change of its directions, or its rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseChange {
    /// Turn of the whole.
    pub turn: Vec3,
    /// Shift of the origin.
    pub shift: Vec3,
    /// Changes of the axes of the rotations.
    pub axes: [Vec3; 3],
}

impl FramePose {
    /// Returns the pose of a hub at a state of its gear.
    pub fn of(hub: &Hub, at: StateView<'_>) -> Self {
        let motion = hub.motion(at.t, at.q, at.v);
        let assembled = Matrix3::from_columns(&hub.axes);
        let x = &motion.x;
        let ((sa, ca), (sb, cb)) = (x[3].sin_cos(), x[4].sin_cos());
        let (sg, cg) = x[5].sin_cos();
        // Rx Ry, and Rz.
        let tilted = Matrix3::new(cb, 0.0, sb, sa * sb, ca, -sa * cb, -ca * sb, sa, ca * cb);
        let spun = Matrix3::new(cg, -sg, 0.0, sg, cg, 0.0, 0.0, 0.0, 1.0);
        let about = |k: usize| assembled * tilted.column(k);
        FramePose {
            turn: assembled * (tilted * spun) * assembled.transpose(),
            shift: assembled * Vec3::new(x[0], x[1], x[2]),
            axes: [
                hub.axes[0],
                hub.axes[1],
                hub.axes[2],
                hub.axes[0],
                about(1),
                about(2),
            ],
            motion,
        }
    }

    /// Returns the floating frame.
    pub fn frame(&self) -> Frame {
        Frame::Posed {
            turn: self.turn,
            shift: self.shift,
        }
    }

    /// Velocity of a place from the origin by a unit rate of a direction.
    #[inline]
    pub fn unit(&self, direction: usize, y: &Vec3) -> Vec3 {
        match direction {
            0..3 => self.axes[direction],
            _ => self.axes[direction].cross(y),
        }
    }

    /// Velocity of a place from the origin.
    pub fn velocity(&self, y: &Vec3) -> Vec3 {
        (0..6).map(|d| self.motion.v[d] * self.unit(d, y)).sum()
    }

    /// Component of a force, and its moment about the origin, in a direction.
    #[inline]
    pub fn component(&self, direction: usize, force: &Vec3, moment: &Vec3) -> f64 {
        self.axes[direction].dot(if direction < 3 { force } else { moment })
    }

    /// The spin, and `w_b`.
    pub fn spin(&self) -> [Vec3; 2] {
        let v = &self.motion.v;
        let spin = (3..6).map(|d| v[d] * self.axes[d]).sum();
        let pairs = [(3, 4), (3, 5), (4, 5)];
        let second = pairs.map(|(i, j)| v[i] * v[j] * self.axes[i].cross(&self.axes[j]));
        [spin, second.into_iter().sum()]
    }

    /// Returns the change of the pose for a change of the six directions, or for their rates.
    pub fn along(&self, dx: &[f64; 6]) -> PoseChange {
        let mut turned = Vec3::zeros();
        let axes = [3, 4, 5].map(|d| {
            let by_those_before = turned.cross(&self.axes[d]);
            turned += dx[d] * self.axes[d];
            by_those_before
        });
        PoseChange {
            turn: turned,
            shift: (0..3).map(|d| dx[d] * self.axes[d]).sum(),
            axes,
        }
    }

    /// Changes of [`FramePose::spin`] along changes of place and rates.
    pub fn spin_change(&self, along: &PoseChange, dv: &[f64; 6]) -> [Vec3; 2] {
        let v = &self.motion.v;
        let changed = |d: usize| &along.axes[d - 3];
        let spin = (3..6)
            .map(|d| dv[d] * self.axes[d] + v[d] * changed(d))
            .sum();
        let pairs = [(3, 4), (3, 5), (4, 5)];
        let second = pairs.map(|(i, j)| {
            let (a, b) = (&self.axes[i], &self.axes[j]);
            (dv[i] * v[j] + v[i] * dv[j]) * a.cross(b)
                + v[i] * v[j] * (changed(i).cross(b) + a.cross(changed(j)))
        });
        [spin, second.into_iter().sum()]
    }
}
