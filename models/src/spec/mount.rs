//! Mounts: how the hub of a gear may move.
//!
//! | mount | free coordinate | motion |
//! |---|---|---|
//! | fixed | none | at rest |
//! | revolute | angle about the axis [rad] | about the gear's centre |
//! | prismatic | displacement [m] | along a direction, as a rack |
//! | driven | none | a prescribed speed, about the axis or along the slide |
//!
//! That is the hub's own motion; where it is free a [`Guide`] may hold it with a spring, a damper and friction. Its five other directions are held unless [`LateralSpec`] says otherwise.

use super::profile::Profile;
use crate::Vec3;
use crate::law::DryFriction;
use nalgebra::Matrix3;

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

/// What holds a hub to the ground along its own motion, where its mount leaves that free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guide {
    /// Of a spring that is without force at the assembled position [N m/rad] or [N/m].
    pub stiffness: f64,
    /// [N m s/rad] or [N s/m].
    pub damping: f64,
    /// Dry friction.
    pub friction: Option<DryFriction>,
}

/// What a mount makes of a direction beside the hub's own motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Freedom {
    /// The mount holds it.
    #[default]
    Held,
    /// It is a coordinate.
    Free,
    /// Its speed is prescribed as a function of time.
    Driven(Profile),
}

/// Springs and dampers between hub and ground, in the six directions of the hub [N/m, N, N m] and [N s/m, ..].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bearing {
    /// Stiffness.
    pub stiffness: [[f64; 6]; 6],
    /// Damping.
    pub damping: [[f64; 6]; 6],
    /// Radial play to either side [m].
    pub clearance: f64,
}

/// The axes of space.
pub const UPRIGHT: [Vec3; 3] = [
    Vec3::new(1.0, 0.0, 0.0),
    Vec3::new(0.0, 1.0, 0.0),
    Vec3::new(0.0, 0.0, 1.0),
];

/// Axes turned by the least angle that brings the third to a unit vector.
pub fn turned_to(axes: &[Vec3; 3], third: &Vec3) -> [Vec3; 3] {
    if axes[2] == *third {
        return *axes;
    }
    let turn = nalgebra::Rotation3::rotation_between(&axes[2], third)
        .unwrap_or_else(|| nalgebra::Rotation3::new(std::f64::consts::PI * axes[0]));
    [turn * axes[0], turn * axes[1], *third]
}

/// Whether gyroscopic, centrifugal and Coriolis terms of a body act.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpinTerms {
    /// Where they change more than a thousandth: the speed of the hub beside the lowest natural frequency of its tilt.
    #[default]
    Auto,
    /// They act.
    On,
    /// They do not.
    Off,
}

/// How a hub may move beside its own turn or slide, and the body that moves with it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LateralSpec {
    /// Three translations along the axes of the hub, three rotations about them.
    pub directions: [Freedom; 6],
    /// Springs and dampers to the ground.
    pub bearing: Bearing,
    /// Mass [kg]; `None` takes the toothing's own.
    pub mass: Option<f64>,
    /// Mass added at the hub [kg].
    pub added_mass: f64,
    /// About the centre of mass, in the axes of the hub at the start [kg m^2]; `None` takes that of a round body.
    pub inertia: Option<Matrix3<f64>>,
    /// Centre of mass from the hub, in the same axes [m].
    pub centre_of_mass: Vec3,
    /// Spin terms.
    pub spin: SpinTerms,
}
