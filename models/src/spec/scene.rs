//! What a scene is made of: plain data, SI units, no files.

use super::load::Load;
use super::mount::{Guide, LateralSpec, Mount};
use super::points::PointContact;
use super::shaft::{BodySpec, Carried, ShaftSpec, Station};
use crate::Vec3;
use crate::geometry::{Gear, Rack, Side, Tips};
use crate::law::{Damping, Friction};
use crate::stiffness::{Material, PairStiffness};

/// The toothed body of a gear.
#[derive(Clone, Debug)]
pub enum Body {
    /// An external or internal gear.
    Gear(Gear),
    /// A rack.
    Rack(Rack),
}

impl Body {
    /// Moment of inertia [kg m^2] of what belongs to the hub of a solid gear.
    pub fn core_inertia(&self, density: f64) -> f64 {
        match self {
            Body::Gear(gear) => gear.core_inertia(density),
            Body::Rack(_) => 0.0,
        }
    }

    /// Number of teeth.
    pub fn teeth(&self) -> u32 {
        match self {
            Body::Gear(gear) => gear.teeth(),
            Body::Rack(rack) => rack.teeth(),
        }
    }

    /// Where the tips of its teeth point.
    pub fn tips(&self) -> Tips {
        match self {
            Body::Gear(gear) if gear.is_internal() => Tips::Inwards,
            Body::Gear(_) => Tips::Outwards,
            Body::Rack(_) => Tips::Along,
        }
    }

    /// Face width [m].
    pub fn face_width(&self) -> f64 {
        match self {
            Body::Gear(gear) => gear.face_width(),
            Body::Rack(rack) => rack.params().face_width,
        }
    }

    /// Mass [kg].
    pub fn mass(&self, density: f64) -> f64 {
        match self {
            Body::Gear(gear) => gear.mass_properties(density).mass,
            Body::Rack(rack) => rack.mass(density),
        }
    }

    /// Helix angle on the base cylinder [rad].
    pub fn base_helix_angle(&self) -> f64 {
        match self {
            Body::Gear(gear) => gear.base_helix_angle(),
            Body::Rack(rack) => rack.base_helix_angle(),
        }
    }
}

/// A gear, its hub and what drives it.
#[derive(Clone, Debug)]
pub struct GearSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Toothing.
    pub body: Body,
    /// Material.
    pub material: Material,
    /// Inertia about the axis [kg m^2] (mass [kg] of a rack); `None` takes the toothing's own.
    pub inertia: Option<f64>,
    /// Inertia added at the hub [kg m^2] or [kg].
    pub added_inertia: f64,
    /// Mount.
    pub mount: Mount,
    /// What holds the hub along its own motion where the mount leaves that free.
    pub guide: Option<Guide>,
    /// How the hub may move beside that; `None`: not at all.
    pub lateral: Option<Box<LateralSpec>>,
    /// The middle of the face width on the axis; for a rack of its reference line, at zero displacement [m].
    pub position: [f64; 3],
    /// Right-handed unit axes of the gear at the start, angles count from the first to the second; the third is the axis
    /// itself. [`UPRIGHT`](super::UPRIGHT) for a rack.
    pub axes: [Vec3; 3],
    /// For a rack: direction from its body to its teeth [rad]. It slides at right angles to it,
    /// counter-clockwise positive as seen from the gear in front of it.
    pub facing: f64,
    /// Initial speed [rad/s] or [m/s].
    pub speed: f64,
    /// Loads on the hub.
    pub loads: Vec<Load>,
}

impl GearSpec {
    /// Inertia about the axis [kg m^2], of a rack the mass [kg], without what is added at the hub.
    pub fn own_inertia(&self) -> f64 {
        let density = self.material.density;
        self.inertia.unwrap_or_else(|| match &self.body {
            Body::Gear(gear) => gear.mass_properties(density).izz,
            Body::Rack(rack) => rack.mass(density),
        })
    }
}

/// Where a mesh starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Flank whose pair is placed.
    pub side: Side,
    /// Gap along the normal of the flanks, positive when open [m].
    pub gap: f64,
    /// Path coordinate of the pair from the first gear's tangent point [m]; `None` is the pitch point.
    pub path_coordinate: Option<f64>,
    /// The whole scene starts in the equilibrium of its loads at time zero, from where its meshes place it.
    pub loaded: bool,
}

/// Two gears in mesh. The first may not be a rack.
#[derive(Clone, Debug)]
pub struct MeshSpec {
    /// Indices of the gears.
    pub gears: [usize; 2],
    /// Initial position; the first mesh of a gear places it.
    pub start: Start,
}

/// Stiffness and law of the contacts of a mesh.
#[derive(Clone, Debug)]
pub struct ContactSpec {
    /// Stiffness of a tooth pair along the path.
    pub stiffness: PairStiffness,
    /// Exponent of the normal law.
    pub exponent: f64,
    /// Damping of the normal law; a ratio is resolved with the reduced mass of the pair.
    pub damping: Damping,
    /// Friction.
    pub friction: Option<Friction>,
    /// Slices over the face width; `None` chooses: 1 for a spur gear without lead crowning, else 16.
    pub slices: Option<usize>,
    /// Contact of flank points, for meshes with a gear that brings its flanks; `stiffness`, `damping` and
    /// `slices` are those of all other meshes. The exponent serves both.
    pub points: Option<PointContact>,
}

/// A scene without its models.
#[derive(Clone, Debug)]
pub struct SceneSpec {
    /// Gears.
    pub gears: Vec<GearSpec>,
    /// Meshes.
    pub meshes: Vec<MeshSpec>,
    /// Shafts that join gears with each other and with bodies without teeth.
    pub shafts: Vec<ShaftSpec>,
}

impl SceneSpec {
    /// The bodies without teeth, shaft by shaft; in an assembled scene they stand behind the gears.
    pub fn bodies(&self) -> impl Iterator<Item = &BodySpec> {
        self.shafts.iter().flat_map(ShaftSpec::bodies)
    }

    /// The first mesh that asks for the whole scene to start in the equilibrium of its loads.
    pub fn starts_loaded(&self) -> Option<&MeshSpec> {
        self.meshes.iter().find(|m| m.start.loaded)
    }

    /// The first gear on the axis of a planet carrier: it meshes with a planet and is none.
    pub fn centre_of(&self, carrier: &BodySpec) -> Option<&GearSpec> {
        let planets = &carrier.planets;
        let other = |m: &MeshSpec| match m.gears.map(|g| planets.contains(&g)) {
            [true, false] => Some(m.gears[1]),
            [false, true] => Some(m.gears[0]),
            _ => None,
        };
        self.meshes.iter().find_map(other).map(|i| &self.gears[i])
    }

    /// Loads on the hub of a gear, and on the bodies of its shaft.
    pub fn loads_at(&self, gear: usize) -> impl Iterator<Item = &Load> {
        let carries = move |s: &&ShaftSpec| {
            let stations = s.stations.iter();
            let mut gears = stations.map(|s| matches!(s.carries, Carried::Gear(i) if i == gear));
            gears.any(|own| own)
        };
        let bodies = self
            .shafts
            .iter()
            .filter(carries)
            .flat_map(ShaftSpec::bodies);
        let own = self.gears.get(gear).into_iter().flat_map(|g| &g.loads);
        own.chain(bodies.flat_map(|b| &b.loads))
    }

    /// Name of what a shaft carries at a station.
    pub fn station_name<'a>(&'a self, station: &'a Station) -> &'a str {
        match &station.carries {
            Carried::Gear(i) => &self.gears[*i].name,
            Carried::Body(body) => &body.name,
        }
    }

    /// Name of a gear or, behind them, of a body on a shaft.
    pub fn member_name(&self, member: usize) -> &str {
        match self.gears.get(member) {
            Some(gear) => &gear.name,
            None => (self.bodies().nth(member - self.gears.len())).map_or("", |b| b.name.as_str()),
        }
    }
}
