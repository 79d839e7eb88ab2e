//! Warnings on initial speeds and loads that do not suit the gear train of a scene.
//!
//! **Speeds.** Flanks that approach each other at the start collide; flanks that separate cross the backlash and
//! collide on the other side. A warning names the speed and the order of the force, `F = v sqrt(k m)` of a mass `m` on
//! a spring `k`, with `k` the 14 N/(mm um) of face width that ISO 6336-1 gives as a mean value for steel gears. An
//! impact counts as intended, without a warning, if
//! - no load and no driven hub acts on the train: then nothing but an impact can happen in it;
//! - held hubs leave the gears no kinematically consistent motion;
//! - the mesh starts within its backlash, a quarter of it or more away from the flank.
//!
//! There is no warning on relative differences of speed below a thousandth, as from rounded input, and on impacts below
//! a tenth of the tooth force of the loads.
//!
//! **Loads.** A warning names loads on hubs with prescribed motion, loads that press the flank that is not in contact
//! at the start, loads that press no flank, and trains in which all loads drive. Only loads that keep their sign are
//! checked.

use super::SceneFile;
use super::error::SceneError;
use super::reading::Place;
use gearbench_models::geometry::Side;
use gearbench_models::spec::{
    Load, MeshSpec, Mount, Profile, Train, effective_radius, mesh_layout,
};
use gearbench_reports::numbers::short;

/// Relative difference of two speeds that counts as rounding.
const ROUNDING: f64 = 1e-3;
/// Impact force, relative to the force of the loads, below which no warning is given.
const SLIGHT: f64 = 0.1;
/// Gap at the start, relative to the backlash, from which on flanks are taken to be apart deliberately.
const APART: f64 = 0.25;
/// Stiffness of a tooth pair per face width [N/m^2]: mean value of ISO 6336-1 for steel.
const STIFFNESS: f64 = 14e9;
/// Normal force, relative to that of the loads alone, below which a flank counts as unloaded.
const NO_FORCE: f64 = 1e-6;

/// Formats a number for a scene file, without digits of rounding errors.
fn written(x: f64, digits: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", digits - 1).parse().unwrap_or(x);
    format!("{rounded:?}")
}

/// A gear train with the places of its members in the file.
struct Start<'s> {
    scene: &'s SceneFile,
    train: Train<'s>,
    root: Place<'s>,
    warnings: Vec<SceneError>,
}

/// Returns warnings on implausible speeds and loads of a scene.
pub(super) fn check(scene: &SceneFile) -> Vec<SceneError> {
    let mut start = Start {
        scene,
        train: Train::new(&scene.spec),
        root: scene.document.at(""),
        warnings: Vec::new(),
    };
    start.speeds();
    start.ineffective_loads();
    start.pressed_flanks();
    start.driving_loads();
    start.warnings
}

/// Sum of the loads at a speed of their hub, ramps at their final value; `None` if one changes its sign.
fn constant(loads: &[Load], speed: f64) -> Option<f64> {
    let of = |load: &Load| match load {
        Load::Viscous(c) => Some(-c * speed),
        Load::Applied(profile) => keeps_sign(profile).then(|| profile.settled()),
    };
    loads.iter().map(of).sum()
}

/// True if a function of time does not change its sign.
fn keeps_sign(profile: &Profile) -> bool {
    match profile {
        Profile::Constant(_) => true,
        Profile::Ramp { from, to, .. } => from * to >= 0.0,
        Profile::Table(table) => {
            let values = table.values();
            values.iter().all(|x| *x >= 0.0) || values.iter().all(|x| *x <= 0.0)
        }
        Profile::Harmonic {
            mean, amplitude, ..
        } => mean.abs() >= amplitude.abs(),
        Profile::Polynomial { .. } => false,
    }
}

fn is_driven(mount: &Mount) -> bool {
    matches!(mount, Mount::Driven(_))
}

impl Start<'_> {
    fn name(&self, member: usize) -> &str {
        self.scene.spec.member_name(member)
    }

    fn pair(&self, mesh: &MeshSpec) -> String {
        let [a, b] = mesh.gears.map(|g| self.name(g));
        format!("`{a}` and `{b}`")
    }

    /// Place of a member in the file: `[gears.NAME]`, or its station on a shaft.
    fn place(&self, member: usize) -> Place<'_> {
        let spec = &self.scene.spec;
        match spec.gears.get(member) {
            Some(gear) => self.root.key("gears").key(&gear.name),
            None => self.station(member).unwrap_or_else(|| self.root.clone()),
        }
    }

    /// Members on shafts, with the indices of shaft and station in the file.
    fn stations(&self) -> Vec<(usize, usize, usize)> {
        let shafts = self.scene.spec.members_of_shafts();
        let places = |(i, members): (usize, Vec<usize>)| {
            let members = members.into_iter().enumerate();
            members.map(move |(j, member)| (member, i, j))
        };
        shafts.into_iter().enumerate().flat_map(places).collect()
    }

    /// Place of a member among the stations of its shaft.
    fn station(&self, member: usize) -> Option<Place<'_>> {
        let found = self.stations().into_iter().find(|(own, ..)| *own == member);
        let shafts = self.root.key("shafts");
        found.map(|(_, i, j)| shafts.member(i).key("carries").member(j))
    }

    /// Place of the speed of a member in the file, if it is given.
    fn stated_speed(&self, member: usize) -> Option<Place<'_>> {
        let own = self.place(member);
        let keys: &[&str] = match is_driven(self.train.mount(member)) {
            true => &["mount"],
            false => &["speed_rad_s", "speed_m_s"],
        };
        let own = keys.iter().map(|key| own.key(key)).find(Place::exists);
        own.or_else(|| {
            let (_, shaft, _) = (self.stations().into_iter()).find(|(on, ..)| *on == member)?;
            let shaft = self.root.key("shafts").member(shaft);
            Some(shaft.key("speed_rad_s")).filter(Place::exists)
        })
    }

    /// Members whose speed the scene prescribes, the most binding first.
    fn order(&self) -> Vec<usize> {
        let members = 0..self.train.members();
        let driven = (members.clone()).filter(|i| is_driven(self.train.mount(*i)));
        let moving = |i: &usize| self.train.speed(*i) != 0.0 && self.stated_speed(*i).is_some();
        driven.chain(members.clone().filter(moving)).collect()
    }

    /// True if a load or a driven hub acts on the gear train of a member.
    fn is_driven_or_loaded(&self, member: usize) -> bool {
        let acts = |load: &Load| match load {
            Load::Applied(profile) => profile.greatest() != 0.0,
            Load::Viscous(c) => *c != 0.0,
        };
        self.train
            .joined(member)
            .into_iter()
            .any(|i| is_driven(self.train.mount(i)) || self.train.loads(i).iter().any(acts))
    }

    /// Warns of flanks that close or separate at the start.
    fn speeds(&mut self) {
        let in_step = self.train.in_step(&self.order());
        let spec = &self.scene.spec;
        let mut mentioned: Vec<usize> = Vec::new();
        let mut found = Vec::new();
        let mut placed = vec![false; spec.gears.len()];
        for (i, mesh) in spec.meshes.iter().enumerate() {
            let both = mesh.gears.map(|g| std::mem::replace(&mut placed[g], true)) == [true; 2];
            let held = mesh.gears.iter().all(|g| self.train.is_held(*g));
            if held || self.starts_apart(mesh) || !self.is_driven_or_loaded(mesh.gears[0]) {
                continue;
            }
            let actual: Vec<f64> = (0..self.train.members())
                .map(|m| self.train.speed(m))
                .collect();
            let (left, fastest) = self.train.approach(i, &actual);
            let mass = self.train.striking_mass(i);
            let [a, b] = mesh.gears.map(|g| &spec.gears[g].body);
            let width = a.face_width().min(b.face_width());
            let force = left.abs() * (STIFFNESS * width * mass).sqrt();
            let tooth_force = (mesh.gears.iter())
                .map(|g| {
                    let loads = spec.loads_at(*g).map(|l| l.greatest(in_step[*g]));
                    loads.sum::<f64>() / effective_radius(&spec.gears[*g].body)
                })
                .fold(0.0, f64::max);
            if left.abs() <= ROUNDING * fastest || force <= SLIGHT * tooth_force {
                continue;
            }
            let speed = short(left.abs(), 3);
            let pair = self.pair(mesh);
            let what = match (both, mesh.start.side.sign() * left > 0.0) {
                (true, _) => format!("the flanks of {pair} collide at {speed} m/s"),
                (_, true) => format!("the flanks of {pair} close at {speed} m/s at the start"),
                (_, false) => format!(
                    "the flanks of {pair} separate at {speed} m/s at the start, and the opposite flanks collide"
                ),
            };
            let what = match force.is_finite() {
                true => format!("{what}, an impact of the order of {} N", short(force, 2)),
                false => format!("{what}, and neither gear can move freely"),
            };
            let carrier = self.train.carrier_of(mesh);
            for member in mesh.gears.into_iter().chain(carrier) {
                let [own, right] = [self.train.speed(member), in_step[member]];
                let rolls = self.stated_speed(member).is_none()
                    && spec.bodies().any(|b| b.planets.contains(&member));
                let same = (own - right).abs() <= ROUNDING * own.abs().max(right.abs());
                if same || rolls || mentioned.contains(&member) {
                    continue;
                }
                mentioned.push(member);
                found.push(self.out_of_step(member, right, &what));
            }
        }
        self.warnings.extend(found);
    }

    fn out_of_step(&self, member: usize, right: f64, what: &str) -> SceneError {
        let rack = (self.scene.spec.gears.get(member))
            .is_some_and(|g| matches!(g.mount, Mount::Prismatic));
        let (key, unit) = match rack {
            true => ("speed_m_s", "m/s"),
            false => ("speed_rad_s", "rad/s"),
        };
        let (name, own) = (self.name(member), self.train.speed(member));
        let is = match own == 0.0 {
            true => format!("`{name}` is at rest"),
            false => format!("`{name}` starts at {} {unit}", written(own, 5)),
        };
        let place = match self.stated_speed(member) {
            Some(place) => place,
            None => self.place(member),
        };
        place.error(
            format!("{is}: {what}"),
            "speed does not match the train",
            format!(
                "the kinematics of the train give {key} = {}",
                written(right, 7)
            ),
        )
    }

    /// Warns of loads on hubs with prescribed motion.
    fn ineffective_loads(&mut self) {
        let mut found = Vec::new();
        for member in 0..self.train.members() {
            let given = match self.train.mount(member) {
                Mount::Driven(_) => "driven: its speed is given",
                Mount::Fixed => "fixed: it does not move",
                Mount::Revolute | Mount::Prismatic => continue,
            };
            if self.train.loads(member).is_empty() {
                continue;
            }
            found.push(self.place(member).key("loads").error(
                format!(
                    "the loads on `{}` have no effect: the hub is {given}",
                    self.name(member)
                ),
                "no effect",
                "remove the loads, or remove the mount and give the initial speed",
            ));
        }
        self.warnings.extend(found);
    }

    /// Loads of all members of a train at consistent speeds; `None` if one changes its sign, or none acts on a movable
    /// hub.
    fn loads_of(&self, train: &[usize], in_step: &[f64]) -> Option<Vec<f64>> {
        let mut loads = vec![0.0; self.train.members()];
        for member in train {
            let load = constant(self.train.loads(*member), in_step[*member])?;
            if matches!(
                self.train.mount(*member),
                Mount::Revolute | Mount::Prismatic
            ) {
                loads[*member] = load;
            }
        }
        loads.iter().any(|x| *x != 0.0).then_some(loads)
    }

    /// Warns of loads that press the flank that is not in contact at the start, or neither flank.
    fn pressed_flanks(&mut self) {
        let in_step = self.train.in_step(&self.order());
        let spec = &self.scene.spec;
        let mut placed = vec![false; spec.gears.len()];
        let mut found = Vec::new();
        let mut judged: Vec<usize> = Vec::new();
        for (i, mesh) in spec.meshes.iter().enumerate() {
            let both = mesh.gears.map(|g| std::mem::replace(&mut placed[g], true)) == [true; 2];
            let train = self.train.joined(mesh.gears[0]);
            let Some(loads) = self.loads_of(&train, &in_step) else {
                continue;
            };
            let forces = self.train.forces(&loads);
            let own = |m: &&MeshSpec| train.contains(&m.gears[0]);
            let alone = (spec.meshes.iter().filter(own))
                .flat_map(|m| m.gears)
                .map(|g| {
                    let loads = spec.loads_at(g).map(|l| l.greatest(in_step[g]));
                    loads.sum::<f64>() / effective_radius(&spec.gears[g].body)
                })
                .fold(0.0, f64::max);
            let all_free = (spec.meshes.iter().enumerate())
                .filter(|(_, m)| own(m))
                .all(|(j, _)| forces[j].abs() <= NO_FORCE * alone);
            if all_free {
                if !judged.contains(&train[0]) {
                    judged.push(train[0]);
                    found.push(self.load_place(&train).error(
                        format!("the loads act on no flank of {}", self.pair(mesh)),
                        "these loads",
                        "give a load on one gear and an opposing load on the other: balanced torques of a pair of \
                         gears have the ratio of their numbers of teeth and the same sign",
                    ));
                }
                continue;
            }
            let word = |side: Side| if side == Side::Left { "left" } else { "right" };
            let pressed = match forces[i] > 0.0 {
                true => Side::Left,
                false => Side::Right,
            };
            let start = mesh.start.side;
            let slight = forces[i].abs() <= NO_FORCE * alone;
            if both || slight || pressed == start || self.starts_apart(mesh) {
                continue;
            }
            let at = self.root.key("meshes").member(i);
            let at = match at.key("start").exists() {
                true => at.key("start").first(&["flank"]),
                false => at.key("gears"),
            };
            let (own, other) = (word(start), word(pressed));
            found.push(at.error(
                format!(
                    "the loads act on the {other} flanks of {}, which start on the {own} flanks: the flanks separate \
                     and cross the backlash",
                    self.pair(mesh)
                ),
                format!("the {own} flanks"),
                format!("write start = {{ flank = \"{other}\" }}, or change the sign of the load"),
            ));
        }
        self.warnings.extend(found);
    }

    /// True if the flanks of a mesh deliberately start apart, within the backlash.
    fn starts_apart(&self, mesh: &MeshSpec) -> bool {
        let [a, b] = mesh.gears.map(|g| &self.scene.spec.gears[g]);
        mesh_layout(a, b).is_ok_and(|l| mesh.start.gap >= APART * l.pair.backlash_normal())
    }

    /// Place of the loads of a train, the last ones in the file.
    fn load_place(&self, train: &[usize]) -> Place<'_> {
        let loaded = train
            .iter()
            .rev()
            .find(|m| !self.train.loads(**m).is_empty());
        loaded.map_or_else(|| self.root.clone(), |m| self.place(*m).key("loads"))
    }

    /// Warns if all loads of a train drive it: one of them has the wrong sign if it is meant as a brake.
    fn driving_loads(&mut self) {
        let in_step = self.train.in_step(&self.order());
        let (mut seen, mut found) = (vec![false; self.train.members()], Vec::new());
        for member in 0..self.train.members() {
            if seen[member] {
                continue;
            }
            let train = self.train.joined(member);
            train.iter().for_each(|m| seen[*m] = true);
            if train.iter().any(|m| is_driven(self.train.mount(*m))) {
                continue;
            }
            let Some(loads) = self.loads_of(&train, &in_step) else {
                continue;
            };
            let powers = train.iter().map(|m| (*m, loads[*m] * in_step[*m]));
            let powers: Vec<(usize, f64)> = powers.filter(|(_, p)| *p != 0.0).collect();
            if powers.len() < 2 || powers.iter().any(|(_, p)| *p < 0.0) {
                continue;
            }
            let names: Vec<String> =
                (powers.iter().map(|(m, _)| format!("`{}`", self.name(*m)))).collect();
            let last = powers[powers.len() - 1].0;
            found.push(self.place(last).key("loads").error(
                format!(
                    "all loads on {} act in the direction of motion, so that the train accelerates",
                    names.join(" and ")
                ),
                "acts in the direction of motion",
                format!(
                    "a braking load on `{}` has the opposite sign",
                    self.name(last)
                ),
            ));
        }
        self.warnings.extend(found);
    }
}
