//! Shafts of a scene as bodies and elements: nodes at stations, ends of sections and divisions, with the lumped mass
//! of the shaft; and stages as elements between members of different shafts.
//!
//! Gears keep their places in the scene. Bodies without teeth follow them, those with names first, then the nodes within
//! sections; all of these are rigid bodies on hubs of their own.

use super::beam::{self, LumpedMass, Mode};
use super::consistency::{axis_of, check_names, gears_of, rigid_mount, share_mount};
use super::guides::Guided;
use super::links::Origin;
use crate::Vec3;
use crate::error::{BuildError, GearPart};
use crate::gear::parameters::ModelParameters;
use crate::gear::rigid::{Rigid, RigidParameters};
use crate::gear::table::Model;
use crate::kinematics::Hub;
use crate::scene::hubs::{LateralBody, lateral_of, round_tensor};
use crate::scene::members::SceneGear;
use crate::spec::{
    BodySpec, Freedom, GearSpec, Load, OutOfPlaneSpec, SceneSpec, Section, ShaftDamping, ShaftSpec,
    StationMember, effective_radius, initial_speed,
};
use std::borrow::Cow;

/// Distance relative to the length of a shaft within which two positions coincide.
const SAME: f64 = 1e-9;

/// An element between two members.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Element {
    pub members: [usize; 2],
    pub modes: Vec<Mode>,
    pub origin: Origin,
    pub damping: ElementDamping,
    /// True if it is the first element between a station and the next.
    pub begins: bool,
    /// Axes of its ends.
    pub axes: [[Vec3; 3]; 2],
}

/// Damping of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene) enum ElementDamping {
    /// The damping of its shaft.
    OfShaft,
    /// Its own damping over stiffness [s].
    Time(f64),
}

/// A body on a shaft, before it becomes a member of the scene.
#[derive(Clone, Debug)]
pub(in crate::scene) struct ShaftBody {
    pub name: String,
    pub hub: Hub,
    /// Length by which its rotation moves flanks [m].
    pub radius: f64,
    pub loads: Vec<Load>,
    pub speed: f64,
}

impl ShaftBody {
    /// Returns the body as a member of a scene.
    pub fn member(&self) -> SceneGear {
        let model = Rigid::new(self.hub.clone(), self.radius);
        SceneGear::new(
            &self.name,
            RigidParameters::MODEL,
            Box::new(model),
            &self.loads,
        )
    }
}

/// All shafts of a scene.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct Plan {
    /// Members behind the gears.
    pub bodies: Vec<ShaftBody>,
    pub elements: Vec<Element>,
    pub damping: Vec<ShaftDamping>,
    /// Number of spans between stations, each of which reports its torque.
    pub spans: usize,
    /// Guides of the members.
    pub guides: Vec<Guided>,
}

/// A node of a shaft.
struct Node {
    place: f64,
    station: Option<usize>,
    lump: LumpedMass,
    /// Index among the members of the scene.
    member: usize,
}

/// Returns the error of a gear whose modes move with the hub in its own direction alone.
fn moves_sideways(name: &str) -> BuildError {
    let why = (
        "an elastic gear on a shaft needs a hub without out-of-plane motion, but this hub can move",
        "remove its bearing and directions, or use a rigid gear, movable teeth or `fe`",
    );
    BuildError::gear(name, GearPart::Mount, why).of_model()
}

impl Plan {
    /// Refuses elastic gears with out-of-plane freedom on shafts: modes move their hubs, which links between hubs do
    /// not include.
    pub fn check(&self, gears: &[SceneGear]) -> Result<(), BuildError> {
        let joined = self.elements.iter().flat_map(|e| e.members);
        for gear in joined.map(|member| &gears[member]) {
            if gear.model.displacement().is_some() && gear.model.hub().lateral.is_some() {
                return Err(moves_sideways(&gear.name));
            }
        }
        Ok(())
    }

    /// Refuses such elastic gears before any gear is meshed.
    ///
    /// # Errors
    /// A gear on a shaft whose model has modes and whose hub moves sideways.
    pub fn check_models(
        &self,
        spec: &SceneSpec,
        hubs: &[Hub],
        rows: &[&Model],
    ) -> Result<(), BuildError> {
        let joined = self.elements.iter().flat_map(|e| e.members);
        let mut gears = joined.filter(|member| *member < spec.gears.len());
        match gears.find(|i| rows[*i].properties.modes && hubs[*i].lateral.is_some()) {
            Some(i) => Err(moves_sideways(&spec.gears[i].name)),
            None => Ok(()),
        }
    }

    /// Builds the plan of a scene, and the scene whose gears include the lumped inertia of their shafts.
    pub fn of(spec: &SceneSpec) -> Result<(Cow<'_, SceneSpec>, Plan), BuildError> {
        let mut plan = Plan::default();
        if !spec.joins_members() {
            return Ok((Cow::Borrowed(spec), plan));
        }
        check_names(spec)?;
        let mut with = spec.clone();
        let mut named = spec.gears.len();
        let mut unnamed = named + spec.bodies().count();
        let mut within = Vec::new();
        for (index, shaft) in spec.shafts.iter().enumerate() {
            shaft.check()?;
            let axes = axis_of(spec, shaft)?;
            let nodes = nodes(shaft, &mut named, &mut unnamed);
            share_mount(&mut with, shaft)?;
            let bends = bends(spec, shaft);
            let radius = (shaft.stations.iter())
                .find_map(|s| match s.carries {
                    StationMember::Gear(i) => Some(effective_radius(&spec.gears[i].body)),
                    StationMember::Body(_) => None,
                })
                .unwrap_or(1.0);
            for node in &nodes {
                let station = node.station.map(|s| &shaft.stations[s].carries);
                if let Some(StationMember::Gear(i)) = station {
                    add_to_gear(&mut with.gears[*i], &node.lump);
                    continue;
                }
                let own = BodySpec::new(&format!("{} {}", shaft.name, node.member), 0.0);
                let mut body = match station {
                    Some(StationMember::Body(body)) => body.as_ref().clone(),
                    _ => BodySpec {
                        speed: shaft_speed(spec, shaft),
                        ..own
                    },
                };
                if let Some(mount) = rigid_mount(spec, shaft) {
                    body.mount = mount;
                }
                let centre = axes.1 + (node.place - axes.2) * axes.0[2];
                let built = shaft_body(shaft, &body, node, (&axes.0, centre), (bends, radius))?;
                match node.station {
                    Some(_) => plan.bodies.push(built),
                    None => within.push(built),
                }
            }
            plan.add_elements(shaft, index, &nodes, [axes.0; 2]);
            plan.damping.push(shaft.damping);
        }
        plan.bodies.append(&mut within);
        plan.add_stages(spec)?;
        Ok((Cow::Owned(with), plan))
    }

    /// Adds the stages without teeth, whose ends turn about the axes of their own members.
    fn add_stages(&mut self, spec: &SceneSpec) -> Result<(), BuildError> {
        let gears = spec.gears.len();
        for (index, stage) in spec.stages.iter().enumerate() {
            if spec.stages[..index].iter().any(|s| s.name == stage.name) {
                return Err(BuildError::stage(
                    &stage.name,
                    ("another stage has this name", "rename one"),
                ));
            }
            stage.check(spec)?;
            let axes = stage.members.map(|m| match spec.gears.get(m) {
                Some(gear) => gear.axes,
                None => self.bodies[m - gears].hub.axes,
            });
            self.spans += 1;
            self.elements.push(Element {
                members: stage.members,
                modes: vec![beam::stage(stage.ratio, stage.stiffness)],
                origin: Origin::Stage(index),
                damping: ElementDamping::Time(stage.damping),
                begins: true,
                axes,
            });
        }
        Ok(())
    }

    fn add_elements(
        &mut self,
        shaft: &ShaftSpec,
        index: usize,
        nodes: &[Node],
        axes: [[Vec3; 3]; 2],
    ) {
        for pair in nodes.windows(2) {
            let length = pair[1].place - pair[0].place;
            let section = section_at(shaft, 0.5 * (pair[0].place + pair[1].place));
            let modes = section.map_or_else(
                || beam::rigid(length),
                |section| beam::elastic(section, length),
            );
            let own = section.and_then(|s| s.damping);
            // Torques are reported between stations; unloaded ends have none.
            let begins = pair[0]
                .station
                .is_some_and(|s| s + 1 < shaft.stations.len());
            self.spans += usize::from(begins);
            self.elements.push(Element {
                members: [pair[0].member, pair[1].member],
                modes,
                origin: Origin::Shaft(index),
                damping: own.map_or(ElementDamping::OfShaft, ElementDamping::Time),
                begins,
                axes,
            });
        }
    }
}

/// Returns the nodes of a shaft in order.
fn nodes(shaft: &ShaftSpec, named: &mut usize, unnamed: &mut usize) -> Vec<Node> {
    let mut places: Vec<(f64, Option<usize>)> = (shaft.stations.iter().enumerate())
        .map(|(k, s)| (s.place, Some(k)))
        .collect();
    let mut from = 0.0;
    for section in &shaft.sections {
        let n = section.divisions;
        places.extend((0..=n).map(|k| (from + section.length * k as f64 / n as f64, None)));
        from += section.length;
    }
    // Stations come before the ends of sections at the same place, which are then left out.
    let same = SAME * shaft.length();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<(f64, Option<usize>)> = Vec::new();
    for (place, station) in places {
        match kept.last_mut() {
            Some(last) if place - last.0 <= same && (last.1.is_none() || station.is_none()) => {
                if station.is_some() {
                    *last = (place, station);
                }
            }
            _ => kept.push((place, station)),
        }
    }
    let mut nodes: Vec<Node> = Vec::new();
    for (place, station) in kept {
        let next = |count: &mut usize| {
            *count += 1;
            *count - 1
        };
        let member = match station.map(|s| &shaft.stations[s].carries) {
            Some(StationMember::Gear(i)) => *i,
            Some(StationMember::Body(_)) => next(named),
            None => next(unnamed),
        };
        nodes.push(Node {
            place,
            station,
            lump: LumpedMass::default(),
            member,
        });
    }
    for i in 1..nodes.len() {
        let length = nodes[i].place - nodes[i - 1].place;
        let middle = 0.5 * (nodes[i].place + nodes[i - 1].place);
        if let Some(section) = section_at(shaft, middle) {
            let half = beam::lump(section, length);
            nodes[i - 1].lump.add(&half);
            nodes[i].lump.add(&half);
        }
    }
    nodes
}

fn section_at(shaft: &ShaftSpec, place: f64) -> Option<&Section> {
    let mut from = 0.0;
    shaft.sections.iter().find(|s| {
        from += s.length;
        place < from
    })
}

/// Returns true if a member of the shaft has out-of-plane freedom: then all members do, except where their mounts fix
/// them.
fn bends(spec: &SceneSpec, shaft: &ShaftSpec) -> bool {
    gears_of(spec, shaft).any(|(g, _)| g.lateral.is_some())
        || shaft.bodies().any(|b| b.lateral.is_some())
}

/// Returns the initial speed of the shaft: that of the first rotating member.
fn shaft_speed(spec: &SceneSpec, shaft: &ShaftSpec) -> f64 {
    let speeds = shaft.stations.iter().map(|s| match &s.carries {
        StationMember::Gear(i) => initial_speed(&spec.gears[*i].mount, spec.gears[*i].speed),
        StationMember::Body(body) => initial_speed(&body.mount, body.speed),
    });
    speeds.into_iter().find(|s| *s != 0.0).unwrap_or(0.0)
}

/// Adds the lumped inertia of the shaft to a gear.
fn add_to_gear(gear: &mut GearSpec, lump: &LumpedMass) {
    let tensor = round_tensor(gear);
    gear.added_inertia += lump.polar;
    if let Some(lateral) = &mut gear.lateral {
        let own = lateral.inertia.unwrap_or(tensor);
        let ring = Vec3::new(lump.across, lump.across, lump.polar);
        lateral.inertia = Some(own + nalgebra::Matrix3::from_diagonal(&ring));
        lateral.added_mass += lump.mass;
    }
}

/// Returns the hub of a body.
fn shaft_body(
    shaft: &ShaftSpec,
    body: &BodySpec,
    node: &Node,
    (axes, centre): (&[Vec3; 3], Vec3),
    (bends, radius): (bool, f64),
) -> Result<ShaftBody, BuildError> {
    let inertia = body.inertia + node.lump.polar;
    if inertia <= 0.0 {
        return Err(shaft.refuse((
            format!(
                "at {} m there is no inertia: neither `{}` nor the shaft has any",
                node.place, body.name
            ),
            "give the body an inertia, or the shaft sections with a diameter and a density",
        )));
    }
    let mut hub = Hub::new(body.mount.clone(), centre, None, inertia);
    hub.axes = *axes;
    if bends {
        let free = || {
            Box::new(OutOfPlaneSpec {
                directions: [const { Freedom::Free }; 6],
                ..OutOfPlaneSpec::default()
            })
        };
        let mut lateral = body.lateral.clone().unwrap_or_else(free);
        let half = 0.5 * body.inertia;
        let own = Vec3::new(half, half, body.inertia);
        let ring = Vec3::new(node.lump.across, node.lump.across, node.lump.polar);
        let own = lateral
            .inertia
            .unwrap_or(nalgebra::Matrix3::from_diagonal(&own));
        lateral.added_mass += node.lump.mass;
        lateral.inertia = Some(own + nalgebra::Matrix3::from_diagonal(&ring));
        let of = LateralBody {
            name: &body.name,
            mount: &body.mount,
            speed: body.speed,
            mass: 0.0,
            tensor: nalgebra::Matrix3::zeros(),
        };
        hub.lateral = lateral_of(&of, &lateral, &mut hub)
            .map_err(|e| {
                shaft.refuse((
                    format!("body `{}`: {}", body.name, e.reason.cause),
                    e.reason.help,
                ))
            })?
            .map(std::sync::Arc::new);
    }
    Ok(ShaftBody {
        name: body.name.clone(),
        hub,
        radius,
        loads: body.loads.clone(),
        speed: initial_speed(&body.mount, body.speed),
    })
}
