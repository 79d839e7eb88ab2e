//! The named quantities that a scene reports, of every mesh and every gear: what they are, where they stand in
//! [`Outputs::channels`](gearbench_integrators::Outputs), and in which unit.

use super::assembled::Scene;
use super::members::{SceneGear, SceneMesh};
use crate::spec::{Body, SceneSpec};

/// A quantity of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfMesh {
    /// Magnitude of the vector sum over its contacts on the second gear [N].
    Force,
    /// Its part across the axes of the mesh [N].
    Transverse,
    /// Its component along x [N].
    X,
    /// Its component along y [N].
    Y,
    /// Its component along z [N].
    Z,
    /// The least normal force of its contacts, 0 without any [N].
    LeastNormal,
    /// The largest pressure of its contacts [Pa]; 0 where they have none, as all but lines on half-spaces.
    Pressure,
    /// Half the width of that contact [m].
    HalfWidth,
    /// Torque of its contacts on its first gear about that gear's axis, or force along its slide [N m].
    FirstTorque,
    /// The same on its second gear.
    SecondTorque,
}

/// A quantity of a gear; [rad] and [N m] are [m] and [N] of one that slides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfGear {
    /// Momentum over inertia, the momentum mean [rad/s].
    Speed,
    /// Speed of the hub [rad/s].
    HubSpeed,
    /// How far the hub has turned [rad].
    Displacement,
    /// Torque of its contact forces about its axis, or force along its slide [N m].
    ContactTorque,
    /// What its mount exerts on it along x [N].
    BearingX,
    /// And along y [N].
    BearingY,
    /// Torque about the axis of a mount that is held or driven [N m].
    MountTorque,
    /// What its mount or bearing exerts on it along z [N].
    BearingZ,
    /// How far its hub is off the assembled position along the hub's axes [m].
    ShiftX,
    /// Along the second axis.
    ShiftY,
    /// Along the axis of the gear.
    ShiftZ,
    /// How far its hub is tilted about the first axis [rad].
    TiltX,
    /// About the second axis.
    TiltY,
}

/// A channel: a quantity of a mesh or of a gear, by its place in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Of a mesh.
    Mesh(usize, OfMesh),
    /// Of a gear, or behind them of a body on a shaft.
    Gear(usize, OfGear),
    /// Torque that a station exerts on the next one through their shaft, counted shaft by shaft [N m].
    ShaftTorque(usize),
}

impl OfMesh {
    /// All, in the order of the channels of a mesh.
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

    /// Unit, as names of columns end.
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
    /// All, in the order of the channels of a gear.
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

    /// How far a hub is aside, in the order of its first five directions.
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

    /// Unit of a gear that turns or slides, as names of columns end.
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
    /// The name of its column in a record, with its unit: quantities of the first mesh stand alone, those of others
    /// name their gears.
    pub fn column(self, scene: &SceneSpec) -> String {
        match self {
            Channel::Mesh(m, what) => {
                let quantity = match what {
                    OfMesh::Force => "contact_force",
                    OfMesh::Transverse => "contact_force_transverse",
                    other => other.name(),
                };
                let of = match scene.meshes.get(m) {
                    Some(mesh) if m > 0 => {
                        let [a, b] = mesh.gears.map(|i| scene.gears[i].name.as_str());
                        format!("_{a}_{b}")
                    }
                    _ => String::new(),
                };
                format!("{quantity}{of}_{}", what.unit())
            }
            Channel::ShaftTorque(span) => {
                let spans = scene.shafts.iter().flat_map(|s| {
                    let pairs = s.stations.windows(2);
                    pairs.map(|p| [0, 1].map(|k| scene.station_name(&p[k])))
                });
                let [a, b] = spans.into_iter().nth(span).unwrap_or_default();
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

/// Names of all channels of a scene, in order: of its meshes by number, of its gears by name, of its shafts by number.
pub(super) fn names(meshes: &[SceneMesh], gears: &[SceneGear], torques: usize) -> Vec<String> {
    let meshes = 0..meshes.len();
    let of_meshes = meshes.flat_map(|m| OfMesh::ALL.map(|c| format!("{}:{m}", c.name())));
    let of_gear = |g: &SceneGear| OfGear::ALL.map(|c| format!("{}:{}", c.name(), g.name));
    let of_shafts = (0..torques).map(|t| format!("shaft_torque:{t}"));
    let of_gears = gears.iter().flat_map(of_gear);
    of_meshes.chain(of_gears).chain(of_shafts).collect()
}

impl Scene {
    /// Where a channel stands; `None` where the scene has no such mesh or gear.
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

    /// Number of all channels.
    pub fn channel_count(&self) -> usize {
        self.channels.len()
    }

    /// Where a quantity of every mesh stands.
    pub fn channels_of_meshes(&self, what: OfMesh) -> Vec<usize> {
        let all = (0..self.meshes.len()).map(|m| Channel::Mesh(m, what));
        all.filter_map(|c| self.channel(c)).collect()
    }
}
