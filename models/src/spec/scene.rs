//! Specification of a scene: gears, meshes, contacts, shafts and stages as plain data in SI units.

use super::load::Load;
use super::mount::{Guide, Mount, OutOfPlaneSpec};
use super::points::FlankContact;
use super::profile::Profile;
use super::shaft::{BodySpec, ShaftSpec, Station, StationMember};
use super::stage::StageSpec;
use crate::Vec3;
use crate::geometry::{Gear, Rack, Side, Tips};
use crate::law::{Damping, ForceLaw, Friction};
use crate::stiffness::{Material, PairStiffness};
use std::sync::Arc;

/// Part of a pitch within which the teeth in mesh stay the same.
const FEW_PITCHES: f64 = 0.5;

/// The toothed body of a gear.
#[derive(Clone, Debug)]
pub enum Body {
    /// An external or internal gear.
    Gear(Gear),
    /// A rack with straight flanks.
    Rack(Rack),
}

impl Body {
    /// Returns the moment of inertia [kg m^2] of the core of a solid gear, which belongs to the hub.
    pub fn core_inertia(&self, density: f64) -> f64 {
        match self {
            Body::Gear(gear) => gear.core_inertia(density),
            Body::Rack(_) => 0.0,
        }
    }

    /// Returns the number of teeth.
    pub fn teeth(&self) -> u32 {
        match self {
            Body::Gear(gear) => gear.teeth(),
            Body::Rack(rack) => rack.teeth(),
        }
    }

    /// Returns the direction of the tooth tips.
    pub fn tips(&self) -> Tips {
        match self {
            Body::Gear(gear) if gear.is_internal() => Tips::Inwards,
            Body::Gear(_) => Tips::Outwards,
            Body::Rack(_) => Tips::Along,
        }
    }

    /// Returns the normal module [m].
    pub fn module(&self) -> f64 {
        match self {
            Body::Gear(gear) => gear.params().module,
            Body::Rack(rack) => rack.params().module,
        }
    }

    /// Returns the face width [m].
    pub fn face_width(&self) -> f64 {
        match self {
            Body::Gear(gear) => gear.face_width(),
            Body::Rack(rack) => rack.params().face_width,
        }
    }

    /// Returns the mass [kg] for a density [kg/m^3].
    pub fn mass(&self, density: f64) -> f64 {
        match self {
            Body::Gear(gear) => gear.mass_properties(density).mass,
            Body::Rack(rack) => rack.mass(density),
        }
    }

    /// Returns the helix angle on the base cylinder [rad].
    pub fn base_helix_angle(&self) -> f64 {
        match self {
            Body::Gear(gear) => gear.base_helix_angle(),
            Body::Rack(rack) => rack.base_helix_angle(),
        }
    }
}

/// A gear with its hub, mount and loads.
#[derive(Clone, Debug)]
pub struct GearSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Body with the toothing of the gear.
    pub body: Body,
    /// Material of the body.
    pub material: Material,
    /// Inertia about the axis [kg m^2] (mass [kg] of a rack); `None` uses that of the toothing.
    pub inertia: Option<f64>,
    /// Inertia added at the hub [kg m^2] or [kg].
    pub added_inertia: f64,
    /// Mount of the hub.
    pub mount: Mount,
    /// Support of the hub along its own motion where the mount leaves that free.
    pub guide: Option<Guide>,
    /// Out-of-plane freedom of the hub; `None` fixes all other directions.
    pub lateral: Option<Box<OutOfPlaneSpec>>,
    /// Position of the middle of the face width on the axis; for a rack of its reference line, at zero displacement
    /// [m].
    pub position: [f64; 3],
    /// Right-handed unit axes of the gear at the start. Angles count from the first to the second; the third is the
    /// gear axis. [`UPRIGHT`](super::UPRIGHT) for a rack.
    pub axes: [Vec3; 3],
    /// Direction from the body of a rack to its teeth [rad]. The rack translates at right angles to it, positive
    /// counter-clockwise in the view of the gear in front of it.
    pub facing: f64,
    /// Initial speed [rad/s] or [m/s].
    pub speed: f64,
    /// Loads on the hub.
    pub loads: Vec<Load>,
}

impl GearSpec {
    /// Returns the inertia about the axis [kg m^2], for a rack the mass [kg], without that added at the hub.
    pub fn own_inertia(&self) -> f64 {
        let density = self.material.density;
        self.inertia.unwrap_or_else(|| match &self.body {
            Body::Gear(gear) => gear.mass_properties(density).izz,
            Body::Rack(rack) => rack.mass(density),
        })
    }
}

/// Initial position of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Flank side of the pair that is placed.
    pub side: Side,
    /// Gap along the normal of the flanks, positive when open [m].
    pub gap: f64,
    /// Path coordinate of the pair from the first gear's tangent point [m]; `None` is the pitch point.
    pub path_coordinate: Option<f64>,
    /// True if the whole scene starts in the equilibrium of its loads at time zero, found from the position that its
    /// meshes define.
    pub loaded: bool,
}

/// Two gears in mesh. The first must not be a rack.
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
    /// Normal force of a program in place of exponent and damping, if any.
    pub normal_force: Option<Arc<dyn ForceLaw>>,
    /// Friction of the contact, if any.
    pub friction: Option<Friction>,
    /// Number of slices over the face width; `None` selects 1 for a spur gear without lead crowning, otherwise 16.
    pub slices: Option<usize>,
    /// Contact of the flanks, for meshes with a gear that has its own flanks; `stiffness`, `damping` and `slices`
    /// apply to all other meshes. The exponent applies to both.
    pub flanks: FlankContact,
}

/// A scene without its models.
#[derive(Clone, Debug)]
pub struct SceneSpec {
    /// Gears of the scene.
    pub gears: Vec<GearSpec>,
    /// Meshes of the scene.
    pub meshes: Vec<MeshSpec>,
    /// Shafts that join gears with each other and with bodies without teeth.
    pub shafts: Vec<ShaftSpec>,
    /// Stages without teeth between members.
    pub stages: Vec<StageSpec>,
    /// Simulated time [s]; infinite where it is not known.
    pub duration: f64,
}

impl SceneSpec {
    /// Returns the bodies without teeth, shaft by shaft; in an assembled scene they follow the gears.
    pub fn bodies(&self) -> impl Iterator<Item = &BodySpec> {
        self.shafts.iter().flat_map(ShaftSpec::bodies)
    }

    /// Returns true if shafts or stages join members.
    pub fn joins_members(&self) -> bool {
        !(self.shafts.is_empty() && self.stages.is_empty())
    }

    /// Returns the members of every shaft, from one end to the other: gears by index, bodies behind them.
    pub fn members_of_shafts(&self) -> Vec<Vec<usize>> {
        let mut body = self.gears.len();
        let mut of = |station: &Station| match station.carries {
            StationMember::Gear(gear) => gear,
            StationMember::Body(_) => {
                body += 1;
                body - 1
            }
        };
        let shafts = self.shafts.iter();
        shafts
            .map(|s| s.stations.iter().map(&mut of).collect())
            .collect()
    }

    /// Returns the pairs of members between which torques are reported: neighbours on shafts, shaft by shaft, then the
    /// members of stages.
    pub fn spans(&self) -> Vec<[usize; 2]> {
        let shafts = self.members_of_shafts();
        let neighbours = shafts.iter().flat_map(|members| members.windows(2));
        let stages = self.stages.iter().map(|s| s.members);
        neighbours.map(|w| [w[0], w[1]]).chain(stages).collect()
    }

    /// Returns true for a member that is a rack.
    pub fn is_rack(&self, member: usize) -> bool {
        (self.gears.get(member)).is_some_and(|g| matches!(g.body, Body::Rack(_)))
    }

    /// Returns the names of the two gears of a mesh, given by their indices.
    pub fn names_of(&self, gears: [usize; 2]) -> [&str; 2] {
        gears.map(|i| self.gears[i].name.as_str())
    }

    /// Returns the time for which no other teeth come into mesh than those at the start [s]: the duration, if none of the
    /// gears passes half a pitch at its initial speed, or infinity. With loads or driven hubs, which may move gears on, it
    /// is infinite. Loads that are zero do not count: a host may apply others to the same gears.
    pub fn time_of_first_teeth(&self) -> f64 {
        let loaded = |loads: &[Load]| {
            let idle = |l: &Load| matches!(l, Load::Applied(Profile::Constant(x)) if *x == 0.0);
            !loads.iter().all(idle)
        };
        let passes_few = |g: &GearSpec| {
            let pitch = match &g.body {
                Body::Gear(gear) => gear.pitch_angle(),
                Body::Rack(rack) => rack.pitch(),
            };
            let speed = super::initial_speed(&g.mount, g.speed).abs();
            speed == 0.0 || speed * self.duration < FEW_PITCHES * pitch
        };
        let moved_on = (self.gears.iter())
            .any(|g| loaded(&g.loads) || matches!(g.mount, Mount::Driven(_)) || !passes_few(g))
            || (self.bodies()).any(|b| loaded(&b.loads) || matches!(b.mount, Mount::Driven(_)));
        match moved_on {
            true => f64::INFINITY,
            false => self.duration,
        }
    }

    /// Returns the first mesh with a loaded start, if any.
    pub fn starts_loaded(&self) -> Option<&MeshSpec> {
        self.meshes.iter().find(|m| m.start.loaded)
    }

    /// Returns the first gear on the axis of a planet carrier: it meshes with a planet and is none.
    pub fn centre_of(&self, carrier: &BodySpec) -> Option<&GearSpec> {
        let planets = &carrier.planets;
        let other = |m: &MeshSpec| match m.gears.map(|g| planets.contains(&g)) {
            [true, false] => Some(m.gears[1]),
            [false, true] => Some(m.gears[0]),
            _ => None,
        };
        self.meshes.iter().find_map(other).map(|i| &self.gears[i])
    }

    /// Returns the loads on the hub of a gear, and on the bodies of its shaft.
    pub fn loads_at(&self, gear: usize) -> impl Iterator<Item = &Load> {
        let carries = move |s: &&ShaftSpec| {
            let stations = s.stations.iter();
            let mut gears =
                stations.map(|s| matches!(s.carries, StationMember::Gear(i) if i == gear));
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

    /// Returns the name of the gear or body at a station.
    pub fn station_name<'a>(&'a self, station: &'a Station) -> &'a str {
        match &station.carries {
            StationMember::Gear(i) => &self.gears[*i].name,
            StationMember::Body(body) => &body.name,
        }
    }

    /// Returns the name of a gear or, behind them, of a body on a shaft.
    pub fn member_name(&self, member: usize) -> &str {
        match self.gears.get(member) {
            Some(gear) => &gear.name,
            None => (self.bodies().nth(member - self.gears.len())).map_or("", |b| b.name.as_str()),
        }
    }
}
