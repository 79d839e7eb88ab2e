//! Planetary sets of a scene: the carrier, the gears on it, and the gears that they mesh with.

use crate::Vec3;
use crate::error::{BuildError, GearPart, Reason};
use crate::gear::table::Model;
use crate::scene::members::SceneGear;
use crate::spec::{
    Body, BodySpec, Freedom, GearSpec, Mount, SceneSpec, StationMember, initial_speed,
};
use std::borrow::Cow;

/// Largest distance of gears of a set from the axis of their carrier [m], and the largest sine between axes.
const OFF_AXIS: f64 = 1e-6;

/// A member of a scene that a rigid link to the ground fixes or drives.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Ground {
    pub member: usize,
    pub mount: Mount,
}

/// A planetary set: a carrier and its gears.
#[derive(Clone, Debug)]
pub(super) struct PlanetarySet {
    /// Index of the carrier among the members of the scene.
    pub body: usize,
    /// Gears, and whether they are on the carrier.
    pub gears: Vec<(usize, bool)>,
}

/// All planetary sets of a scene.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct PlanetarySets {
    pub(super) all: Vec<PlanetarySet>,
    /// Set of each mesh.
    pub(super) of_mesh: Vec<Option<usize>>,
    pub ground: Vec<Ground>,
}

/// Returns the bodies that carry planets, with their numbers behind the gears.
fn carriers(spec: &SceneSpec) -> impl Iterator<Item = (usize, &BodySpec)> {
    let first = spec.gears.len();
    let bodies = spec.bodies().enumerate();
    bodies
        .filter(|(_, body)| !body.planets.is_empty())
        .map(move |(k, body)| (first + k, body))
}

/// Returns the planetary sets of a scene, and the scene modified for them: gears of a set rotate freely, with their
/// fixed or driven mounts replaced by links; carriers have the mass of planets on rigid pins.
///
/// # Errors
/// A set that is none.
pub(in crate::scene) fn grounded(
    spec: &SceneSpec,
) -> Result<(Cow<'_, SceneSpec>, PlanetarySets), BuildError> {
    let mut sets = PlanetarySets {
        of_mesh: vec![None; spec.meshes.len()],
        ..PlanetarySets::default()
    };
    if carriers(spec).next().is_none() {
        return Ok((Cow::Borrowed(spec), sets));
    }
    let mut with = spec.clone();
    let mut owner: Vec<Option<usize>> = vec![None; spec.gears.len()];
    for (k, (_, body)) in carriers(spec).enumerate() {
        for &planet in &body.planets {
            let Some(slot) = owner.get_mut(planet) else {
                return Err(BuildError::scene(format!(
                    "there is no gear number {planet}"
                )));
            };
            if slot.replace(k).is_some() {
                return Err(refuse(
                    &spec.gears[planet],
                    (
                        "it is on two carriers, or twice on the same carrier",
                        "name it once, among the `planets` of one body",
                    ),
                ));
            }
        }
    }
    for (k, (member, body)) in carriers(spec).enumerate() {
        let mut gears: Vec<(usize, bool)> = body.planets.iter().map(|p| (*p, true)).collect();
        for (mesh, of_mesh) in spec.meshes.iter().zip(&mut sets.of_mesh) {
            if !mesh.gears.iter().any(|g| owner[*g] == Some(k)) {
                continue;
            }
            *of_mesh = Some(k);
            for &gear in &mesh.gears {
                match owner[gear] {
                    Some(other) if other != k => {
                        return Err(refuse(
                            &spec.gears[gear],
                            (
                                "planets of two carriers mesh with each other",
                                "let them mesh with gears that are not on a carrier",
                            ),
                        ));
                    }
                    None if !gears.iter().any(|g| g.0 == gear) => gears.push((gear, false)),
                    _ => {}
                }
            }
        }
        let central = check(spec, body, &gears)?;
        let (centre, axis) = (Vec3::from(central.position), central.axes[2]);
        let pinned = gears
            .iter()
            .filter(|(g, on)| *on && is_pinned(&spec.gears[*g]));
        let pinned: Vec<usize> = pinned.map(|g| g.0).collect();
        let weights = pinned.iter().map(|g| {
            let gear = &spec.gears[*g];
            let off = Vec3::from(gear.position) - centre;
            (mass_of(gear), off)
        });
        let weights: Vec<(f64, Vec3)> = weights.collect();
        let extra: f64 = weights
            .iter()
            .map(|(m, off)| m * off.cross(&axis).norm_squared())
            .sum();
        let total: f64 = weights.iter().map(|w| w.0).sum();
        let moment: Vec3 = weights.iter().map(|(m, off)| *m * off).sum();
        let moves = body.lateral.is_some();
        if moves && moment.norm() > OFF_AXIS * total {
            return Err(of_body(
                body,
                (
                    "it can move out of plane, but the planets on its rigid pins are not balanced",
                    "give the planets bearings, or fix the out-of-plane directions of the carrier",
                ),
            ));
        }
        for own in bodies_mut(&mut with).filter(|b| b.name == body.name) {
            own.inertia += extra;
            if let Some(lateral) = &mut own.lateral {
                lateral.added_mass += total;
            }
            if let Some(mount) = set_free(&mut own.mount, &mut own.speed) {
                sets.ground.push(Ground { member, mount });
            }
        }
        for (gear, _) in &gears {
            let own = &mut with.gears[*gear];
            if let Some(mount) = set_free(&mut own.mount, &mut own.speed) {
                sets.ground.push(Ground {
                    member: *gear,
                    mount,
                });
            }
        }
        sets.all.push(PlanetarySet {
            body: member,
            gears,
        });
    }
    shared(spec, &sets)?;
    Ok((Cow::Owned(with), sets))
}

impl PlanetarySets {
    /// Returns true for a scene without carriers.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Refuses full finite elements in a planetary set before any gear is meshed.
    ///
    /// # Errors
    /// A gear of a set whose model is of full order.
    pub fn check_models(&self, spec: &SceneSpec, rows: &[&Model]) -> Result<(), BuildError> {
        let mut members = self.all.iter().flat_map(|set| &set.gears).map(|g| g.0);
        match members.find(|i| rows[*i].properties.full_order) {
            Some(i) => Err(full_order_in_set(&spec.gears[i].name)),
            None => Ok(()),
        }
    }

    /// Refuses hubs or shafts of gears of a set that sets do not support.
    pub fn check(&self, gears: &[SceneGear]) -> Result<(), BuildError> {
        for set in &self.all {
            let axes = &gears[set.body].model.hub().axes;
            let across = |g: &SceneGear| {
                let free = g.model.hub().free_directions();
                free.filter(|d| *d < 2).count() == 2
            };
            let moves = across(&gears[set.body]);
            for member in set.gears.iter().map(|g| g.0).chain([set.body]) {
                let g = &gears[member];
                let hub = g.model.hub();
                if g.model.large().is_some() {
                    return Err(full_order_in_set(&g.name));
                }
                let why: Option<Reason> = if !hub.is_free() {
                    Some(
                        (
                            "a rigid shaft fixes or drives it together with another member",
                            "fix or drive the gear of the planetary set itself, or its carrier",
                        )
                            .into(),
                    )
                } else if hub.axes != *axes {
                    Some(
                        (
                            "its axes are not those of its carrier",
                            "give all gears of a planetary set one axis and no misalignment",
                        )
                            .into(),
                    )
                } else if hub.free_directions().any(|d| d == 3 || d == 4) {
                    Some(
                        (
                            "it can tilt, but gears of a planetary set cannot",
                            "fix its tilts: directions = { tilt_x = \"held\", tilt_y = \"held\" }",
                        )
                            .into(),
                    )
                } else if hub.free_directions().filter(|d| *d < 2).count() == 1 {
                    Some(
                        (
                            "it can move in one radial direction but not in the other",
                            "free or fix both",
                        )
                            .into(),
                    )
                } else if moves && !across(g) && set.gears.contains(&(member, false)) {
                    Some(
                        (
                            "its carrier can move radially, but it cannot",
                            "give it a bearing, or fix the radial directions of the carrier",
                        )
                            .into(),
                    )
                } else {
                    None
                };
                if let Some(why) = why {
                    return Err(BuildError::gear(&g.name, GearPart::Mount, why));
                }
            }
        }
        Ok(())
    }
}

/// Returns the error of full finite elements in a planetary set, whose gears are described in the frame of the
/// carrier.
fn full_order_in_set(name: &str) -> BuildError {
    let why = (
        "full finite elements describe their nodes in space, and gears of a planetary set are described in the frame of its carrier",
        "use the model `elastic`, or remove the carrier, so that all gears rotate about fixed axes",
    );
    BuildError::gear(name, GearPart::Mount, why).of_model()
}

/// Frees a mount; returns the former fixed or driven mount.
fn set_free(mount: &mut Mount, speed: &mut f64) -> Option<Mount> {
    if matches!(mount, Mount::Revolute) {
        return None;
    }
    *speed = initial_speed(mount, *speed);
    Some(std::mem::replace(mount, Mount::Revolute))
}

fn bodies_mut(spec: &mut SceneSpec) -> impl Iterator<Item = &mut BodySpec> {
    let stations = spec.shafts.iter_mut().flat_map(|s| &mut s.stations);
    stations.filter_map(|s| match &mut s.carries {
        StationMember::Body(body) => Some(body.as_mut()),
        StationMember::Gear(_) => None,
    })
}

fn refuse(gear: &GearSpec, why: impl Into<Reason>) -> BuildError {
    BuildError::gear(&gear.name, GearPart::Mount, why)
}

fn of_body(body: &BodySpec, why: impl Into<Reason>) -> BuildError {
    BuildError::gear(&body.name, GearPart::Mount, why)
}

/// Returns true if the position of the gear on the carrier is fixed.
fn is_pinned(gear: &GearSpec) -> bool {
    let directions = gear.lateral.iter().flat_map(|l| &l.directions[..2]);
    directions.into_iter().all(|d| *d == Freedom::Fixed)
}

fn mass_of(gear: &GearSpec) -> f64 {
    let own = gear.lateral.as_ref().and_then(|l| l.mass);
    own.unwrap_or_else(|| gear.body.mass(gear.material.density))
}

/// Checks that a set has a gear on its axis, that all its gears that are not on the carrier are there, and that none
/// is a rack.
fn check<'a>(
    spec: &'a SceneSpec,
    body: &BodySpec,
    gears: &[(usize, bool)],
) -> Result<&'a GearSpec, BuildError> {
    let Some(central) = spec.centre_of(body) else {
        return Err(of_body(
            body,
            (
                "none of its planets meshes with a gear on the axis of the carrier",
                "add the mesh of a planet with a sun or a ring gear",
            ),
        ));
    };
    for (gear, on_carrier) in gears {
        let g = &spec.gears[*gear];
        if matches!(g.body, Body::Rack(_)) {
            return Err(refuse(
                g,
                (
                    "a rack cannot be part of a planetary set",
                    "let the rack mesh with another gear",
                ),
            ));
        }
        let off = Vec3::from(g.position) - Vec3::from(central.position);
        let off = off.cross(&central.axes[2]).norm();
        if !on_carrier && off > OFF_AXIS {
            return Err(refuse(
                g,
                (
                    format!(
                        "it meshes with a planet, but its axis is {off:.3e} m from the axis of the carrier `{}`",
                        body.name
                    ),
                    "name it among the `planets`, or give it the same position across the axis as the sun",
                ),
            ));
        }
        let driven = g.lateral.iter().flat_map(|l| &l.directions);
        if driven.into_iter().any(|d| matches!(d, Freedom::Driven(_))) {
            return Err(refuse(
                g,
                (
                    "a direction of a gear of a planetary set is driven",
                    "free or fix it",
                ),
            ));
        }
    }
    Ok(central)
}

/// Checks that a gear has one carrier in all its meshes.
fn shared(spec: &SceneSpec, sets: &PlanetarySets) -> Result<(), BuildError> {
    for (i, gear) in spec.gears.iter().enumerate() {
        let mut of = (spec.meshes.iter().zip(&sets.of_mesh))
            .filter(|(mesh, _)| mesh.gears.contains(&i))
            .map(|(_, set)| *set);
        let first = of.next().flatten();
        if of.any(|set| set != first) {
            return Err(refuse(
                gear,
                (
                    "it meshes with planets and with another gear, or with planets of two carriers",
                    "put two gears on a rigid shaft, one for each",
                ),
            ));
        }
    }
    Ok(())
}

impl Ground {
    /// Returns the prescribed speed and acceleration of the link.
    pub fn motion(&self, t: f64) -> [f64; 2] {
        match &self.mount {
            Mount::Driven(profile) => [profile.value(t), profile.slope(t)],
            _ => [0.0; 2],
        }
    }

    /// Returns the next breakpoint of the prescribed motion after `t`.
    pub fn next_breakpoint(&self, t: f64) -> f64 {
        match &self.mount {
            Mount::Driven(profile) => profile.next_breakpoint(t),
            _ => f64::INFINITY,
        }
    }
}
