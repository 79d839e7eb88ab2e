//! Named quantities of meshes and gears that a scene reports: definition, position in
//! [`Outputs::channels`](gearbench_integrators::Outputs), and unit.

use super::assembled::Scene;
use super::members::{SceneGear, SceneMesh};
use crate::spec::{Body, SceneSpec};

/// A quantity of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfMesh {
    /// Magnitude of the sum of the contact forces on the second gear [N].
    Force,
    /// Part of that force perpendicular to the axes of the mesh [N].
    Transverse,
    /// Component of that force along x [N].
    X,
    /// Component of that force along y [N].
    Y,
    /// Component of that force along z [N].
    Z,
    /// Smallest normal force of the contacts, 0 without any [N].
    LeastNormal,
    /// Largest pressure of the contacts [Pa]; 0 for contacts without a pressure, that is all except lines on
    /// half-spaces.
    Pressure,
    /// Half-width of the contact with that pressure [m].
    HalfWidth,
    /// Torque of the contacts on the first gear about its axis [N m], or force along the motion of a rack [N].
    FirstTorque,
    /// Torque of the contacts on the second gear about its axis [N m], or force along the motion of a rack [N].
    SecondTorque,
}

/// A quantity of a gear; for a rack [m] and [N] replace [rad] and [N m].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfGear {
    /// Momentum divided by inertia, the momentum mean of the speed [rad/s].
    Speed,
    /// Speed of the hub [rad/s].
    HubSpeed,
    /// Rotation of the hub from the assembled position [rad].
    Displacement,
    /// Torque of the contact forces about the axis [N m], or force along the motion of a rack [N].
    ContactTorque,
    /// Reaction of the mount along x [N].
    BearingX,
    /// Reaction of the mount along y [N].
    BearingY,
    /// Torque about the axis of a fixed or driven mount [N m].
    MountTorque,
    /// Reaction of the mount or bearing along z [N].
    BearingZ,
    /// Displacement of the hub from the assembled position along its first axis [m].
    ShiftX,
    /// Displacement of the hub along its second axis [m].
    ShiftY,
    /// Displacement of the hub along the axis of the gear [m].
    ShiftZ,
    /// Tilt of the hub about its first axis [rad].
    TiltX,
    /// Tilt of the hub about its second axis [rad].
    TiltY,
}

/// A channel: a quantity of a mesh or of a gear, with the index in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Quantity of a mesh, by its index.
    Mesh(usize, OfMesh),
    /// Quantity of a gear, or of a body on a shaft behind the gears, by its index.
    Gear(usize, OfGear),
    /// Torque of a member on the next one through their shaft or their stage, in the order of
    /// [`SceneSpec::spans`] [N m].
    ShaftTorque(usize),
}

impl OfMesh {
    /// All quantities, in the order of the channels of a mesh.
    pub const ALL: [OfMesh; 10] = [
        OfMesh::Force,
        OfMesh::Transverse,
        OfMesh::X,
        OfMesh::Y,
        OfMesh::Z,
        OfMesh::LeastNormal,
        OfMesh::Pressure,
        OfMesh::HalfWidth,
        OfMesh::FirstTorque,
        OfMesh::SecondTorque,
    ];
    /// Torques on both gears.
    pub const TORQUES: [OfMesh; 2] = [OfMesh::FirstTorque, OfMesh::SecondTorque];

    fn name(self) -> &'static str {
        match self {
            OfMesh::Force => "force",
            OfMesh::Transverse => "force_transverse",
            OfMesh::X => "force_x",
            OfMesh::Y => "force_y",
            OfMesh::Z => "force_z",
            OfMesh::LeastNormal => "normal_min",
            OfMesh::Pressure => "contact_pressure",
            OfMesh::HalfWidth => "contact_half_width",
            OfMesh::FirstTorque => "mesh_torque_first",
            OfMesh::SecondTorque => "mesh_torque_second",
        }
    }

    /// Returns the unit as it ends a column name.
    fn unit(self) -> &'static str {
        match self {
            OfMesh::Pressure => "pa",
            OfMesh::HalfWidth => "m",
            OfMesh::FirstTorque | OfMesh::SecondTorque => "nm",
            _ => "n",
        }
    }
}

impl OfGear {
    /// All quantities, in the order of the channels of a gear.
    pub const ALL: [OfGear; 13] = [
        OfGear::Speed,
        OfGear::HubSpeed,
        OfGear::Displacement,
        OfGear::ContactTorque,
        OfGear::BearingX,
        OfGear::BearingY,
        OfGear::MountTorque,
        OfGear::BearingZ,
        OfGear::ShiftX,
        OfGear::ShiftY,
        OfGear::ShiftZ,
        OfGear::TiltX,
        OfGear::TiltY,
    ];

    /// Returns the out-of-plane displacements and tilts of a hub, in the order of its first five directions.
    pub fn aside() -> &'static [OfGear] {
        &Self::ALL[OfGear::ShiftX as usize..]
    }

    fn name(self) -> &'static str {
        match self {
            OfGear::Speed => "speed",
            OfGear::HubSpeed => "hub_speed",
            OfGear::Displacement => "hub_angle",
            OfGear::ContactTorque => "contact_torque",
            OfGear::BearingX => "bearing_x",
            OfGear::BearingY => "bearing_y",
            OfGear::MountTorque => "mount_torque",
            OfGear::BearingZ => "bearing_z",
            OfGear::ShiftX => "hub_x",
            OfGear::ShiftY => "hub_y",
            OfGear::ShiftZ => "hub_z",
            OfGear::TiltX => "hub_tilt_x",
            OfGear::TiltY => "hub_tilt_y",
        }
    }

    /// Returns the unit for a rotating or translating gear as it ends a column name.
    pub fn unit(self, slides: bool) -> &'static str {
        match (self, slides) {
            (OfGear::Speed | OfGear::HubSpeed, false) => "rad_s",
            (OfGear::Speed | OfGear::HubSpeed, true) => "m_s",
            (OfGear::Displacement, false) => "rad",
            (OfGear::Displacement, true) => "m",
            (OfGear::ContactTorque | OfGear::MountTorque, false) => "nm",
            (OfGear::ShiftX | OfGear::ShiftY | OfGear::ShiftZ, _) => "m",
            (OfGear::TiltX | OfGear::TiltY, _) => "rad",
            _ => "n",
        }
    }
}

impl Channel {
    /// Returns the column name in a record: quantity, name of the gear or names of both gears of the mesh, unit.
    pub fn column(self, scene: &SceneSpec) -> String {
        match self {
            Channel::Mesh(m, what) => {
                let quantity = match what {
                    OfMesh::Force => "contact_force",
                    OfMesh::Transverse => "transverse_force",
                    other => other.name(),
                };
                let mesh = scene.meshes.get(m);
                let [a, b] = mesh.map_or_else(Default::default, |m| scene.names_of(m.gears));
                format!("{quantity}_{a}_{b}_{}", what.unit())
            }
            Channel::ShaftTorque(span) => {
                let members = scene.spans().get(span).copied();
                let [a, b] =
                    members.map_or_else(Default::default, |m| m.map(|i| scene.member_name(i)));
                format!("shaft_torque_{a}_{b}_nm")
            }
            Channel::Gear(g, what) => {
                let body = scene.gears.get(g).map(|gear| &gear.body);
                let slides = matches!(body, Some(Body::Rack(_)));
                let unit = what.unit(slides);
                let name = scene.member_name(g);
                match what {
                    OfGear::BearingX => format!("bearing_{name}_x_{unit}"),
                    OfGear::BearingY => format!("bearing_{name}_y_{unit}"),
                    OfGear::BearingZ => format!("bearing_{name}_z_{unit}"),
                    OfGear::ShiftX => format!("hub_{name}_x_{unit}"),
                    OfGear::ShiftY => format!("hub_{name}_y_{unit}"),
                    OfGear::ShiftZ => format!("hub_{name}_z_{unit}"),
                    OfGear::TiltX => format!("hub_{name}_tilt_x_{unit}"),
                    OfGear::TiltY => format!("hub_{name}_tilt_y_{unit}"),
                    OfGear::Displacement if slides => format!("hub_displacement_{name}_{unit}"),
                    _ => format!("{}_{name}_{unit}", what.name()),
                }
            }
        }
    }
}

/// Returns the names of all channels of a scene in order: of its meshes by number, of its gears by name, of its shafts
/// by number.
pub(super) fn names(meshes: &[SceneMesh], gears: &[SceneGear], torques: usize) -> Vec<String> {
    let meshes = 0..meshes.len();
    let of_meshes = meshes.flat_map(|m| OfMesh::ALL.map(|c| format!("{}:{m}", c.name())));
    let of_gear = |g: &SceneGear| OfGear::ALL.map(|c| format!("{}:{}", c.name(), g.name));
    let of_shafts = (0..torques).map(|t| format!("shaft_torque:{t}"));
    let of_gears = gears.iter().flat_map(of_gear);
    of_meshes.chain(of_gears).chain(of_shafts).collect()
}

impl Scene {
    /// Returns the index of a channel, or `None` where the scene has no such mesh or gear.
    pub fn channel(&self, channel: Channel) -> Option<usize> {
        let meshes = self.meshes.len();
        match channel {
            Channel::Mesh(m, what) => (m < meshes).then_some(OfMesh::ALL.len() * m + what as usize),
            Channel::Gear(g, what) => (g < self.gears.len())
                .then_some(OfMesh::ALL.len() * meshes + OfGear::ALL.len() * g + what as usize),
            Channel::ShaftTorque(span) => (span < self.shafts.torques.len()).then_some(
                OfMesh::ALL.len() * meshes + OfGear::ALL.len() * self.gears.len() + span,
            ),
        }
    }

    /// Returns the number of all channels.
    pub fn channel_count(&self) -> usize {
        self.channels.len()
    }

    /// Returns the indices of a quantity of all meshes.
    pub fn channels_of_meshes(&self, what: OfMesh) -> Vec<usize> {
        let all = (0..self.meshes.len()).map(|m| Channel::Mesh(m, what));
        all.filter_map(|c| self.channel(c)).collect()
    }
}
