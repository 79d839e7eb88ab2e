//! Mounts: how the hub of a gear may move.
//!
//! | mount | free coordinate | motion |
//! |---|---|---|
//! | fixed | none | at rest |
//! | revolute | angle about the axis [rad] | about the gear's centre |
//! | prismatic | displacement [m] | along a direction, as a rack |
//! | driven | none | a prescribed speed, about the axis or along the slide |
//!
//! This is the hub's own motion; where it is free a [`Guide`] may support it with a spring, a damper and friction. Its
//! five other directions are fixed unless an [`OutOfPlaneSpec`] frees them.

use super::profile::Profile;
use crate::Vec3;
use crate::law::DryFriction;
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// Freedom of a hub along its own motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Mount {
    /// The hub is at rest.
    Fixed,
    /// The hub is free to rotate about its axis.
    Revolute,
    /// The hub is free to translate.
    Prismatic,
    /// The speed is prescribed as a function of time [rad/s], or [m/s] for a rack.
    Driven(Profile),
}

/// Support of a hub along its own motion, where its mount leaves that free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guide {
    /// Stiffness of a spring without force at the assembled position [N m/rad] or [N/m].
    pub stiffness: f64,
    /// Damping coefficient [N m s/rad] or [N s/m].
    pub damping: f64,
    /// Dry friction, if any.
    pub friction: Option<DryFriction>,
}

/// Freedom of a hub in a direction other than its own motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Freedom {
    /// The mount fixes the direction.
    #[default]
    Fixed,
    /// The direction is a coordinate.
    Free,
    /// The speed is prescribed as a function of time.
    Driven(Profile),
}

/// Springs and dampers between hub and ground, in the six directions of the hub [N/m, N, N m] and [N s/m, ..].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bearing {
    /// Stiffness matrix.
    pub stiffness: [[f64; 6]; 6],
    /// Damping matrix.
    pub damping: [[f64; 6]; 6],
    /// Radial clearance to either side [m].
    pub clearance: f64,
}

/// The axes of space.
pub const UPRIGHT: [Vec3; 3] = [
    Vec3::new(1.0, 0.0, 0.0),
    Vec3::new(0.0, 1.0, 0.0),
    Vec3::new(0.0, 0.0, 1.0),
];

/// Returns the axes rotated by the smallest angle that brings the third to a unit vector.
pub fn turned_to(axes: &[Vec3; 3], third: &Vec3) -> [Vec3; 3] {
    if axes[2] == *third {
        return *axes;
    }
    let turn = nalgebra::Rotation3::rotation_between(&axes[2], third)
        .unwrap_or_else(|| nalgebra::Rotation3::new(std::f64::consts::PI * axes[0]));
    [turn * axes[0], turn * axes[1], *third]
}

/// Selection of the gyroscopic, centrifugal and Coriolis terms of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpinTerms {
    /// The terms are included where they change results by more than a thousandth, from the ratio of the hub speed to
    /// the lowest natural frequency of its tilt.
    #[default]
    Auto,
    /// The terms are included.
    On,
    /// The terms are neglected.
    Off,
}

/// Out-of-plane freedom of a hub, and the body that moves with it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutOfPlaneSpec {
    /// Freedom of three translations along the axes of the hub, and of three rotations about them.
    pub directions: [Freedom; 6],
    /// Springs and dampers to the ground.
    pub bearing: Bearing,
    /// Mass [kg]; `None` uses that of the toothing.
    pub mass: Option<f64>,
    /// Mass added at the hub [kg].
    pub added_mass: f64,
    /// Inertia tensor about the centre of mass, in the axes of the hub at the start [kg m^2]; `None` uses that of a
    /// round body.
    pub inertia: Option<Matrix3<f64>>,
    /// Position of the centre of mass from the hub, in the same axes [m].
    pub centre_of_mass: Vec3,
    /// Selection of the spin terms.
    pub spin: SpinTerms,
}
