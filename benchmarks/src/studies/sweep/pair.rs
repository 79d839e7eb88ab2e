//! The mesh that is swept: the load of its flanks at a speed, and the scene at that speed.
//!
//! What acts on a hub is a constant torque, harmonics, and a viscous load at the speed that is swept. The loads of two
//! free gears balance, or the speed would drift. Constant torques do at every speed or at none; a viscous load grows with
//! it, and then the other gear, the one that drives, is given the torque that holds the speed. What damping takes from
//! the vibration of two free gears comes from their rotation: while they settle their speed is brought back now and then,
//! and both are driven by what they lost, in proportion to their inertias, which presses nothing ([`Pair::correct_speed`]).

use crate::experiment::configuration::Configuration;
use crate::experiment::error::StudyError;
use crate::studies::sweep::end_state::EndState;
use crate::studies::sweep::plan::Plan;
use gearbench_integrators::State;
use gearbench_models::scene::{Scene, SceneGear};
use gearbench_models::spec::{
    Body, GearSpec, Load, MeshLayout, Mount, Profile, SceneSpec, mesh_layout, signed_base_radius,
};
use gearbench_reports::numbers::short;
use std::f64::consts::TAU;

/// Imbalance of the loads' power, over the larger one, that keeps a speed.
const BALANCE: f64 = 1e-6;

/// Mean load on a hub: a constant torque and viscous damping.
#[derive(Clone, Copy, Debug)]
struct MeanLoad {
    /// Constant part of the torque [N m].
    constant: f64,
    /// Viscous damping of the rotation [N m s/rad].
    viscous: f64,
}

impl MeanLoad {
    fn of(gear: &GearSpec) -> Self {
        let mut mean = MeanLoad {
            constant: 0.0,
            viscous: 0.0,
        };
        for load in &gear.loads {
            match load {
                Load::Applied(p) => mean.constant += p.settled(),
                Load::Viscous(c) => mean.viscous += c,
            }
        }
        mean
    }

    fn at(&self, speed: f64) -> f64 {
        self.constant - self.viscous * speed
    }
}

/// Gear pair of a sweep, with its loads.
pub struct Pair {
    pub layout: MeshLayout,
    /// Signed transverse base radii of both gears [m].
    pub base_radii: [f64; 2],
    /// Numbers of teeth of both gears.
    pub teeth: [usize; 2],
    /// Sign of the flank in contact, in the sense of rotation of the first gear.
    pub sign: f64,
    /// Path coordinate of the reference pair at zero displacement [m].
    pub start: f64,
    loads: [MeanLoad; 2],
    /// Index of the gear whose own load does not determine the contact force: it is driven, or keeps the speed.
    holds: Option<usize>,
    /// True if both gears are free to turn.
    free: bool,
    /// Mesh frequency at the scene's own speed [Hz].
    own: f64,
}

/// Speed of a gear at the start, as its scene has it [rad/s].
fn own_speed(gear: &GearSpec) -> f64 {
    match &gear.mount {
        Mount::Driven(speed) => speed.value(0.0),
        _ => gear.speed,
    }
}

/// Mesh frequency at the speeds of a scene [Hz]: by the gear whose speed is given.
fn own_frequency(speeds: [f64; 2], teeth: [usize; 2]) -> f64 {
    let of = |i: usize| teeth[i] as f64 * speeds[i].abs() / TAU;
    if speeds[0] == 0.0 { of(1) } else { of(0) }
}

impl Pair {
    fn of(spec: &SceneSpec) -> Result<Self, String> {
        let ([a, b], [mesh]) = (spec.gears.as_slice(), spec.meshes.as_slice()) else {
            return Err(format!(
                "a sweep needs one mesh of two gears, but the scene has {} gears and {} meshes",
                spec.gears.len(),
                spec.meshes.len()
            ));
        };
        if let Some(shaft) = spec.shafts.first() {
            return Err(format!(
                "a sweep needs two gears without shafts, but the scene has the shaft `{}`",
                shaft.name
            ));
        }
        if let Some(stage) = spec.stages.first() {
            return Err(format!(
                "a sweep needs two gears without stages, but the scene has the stage `{}`",
                stage.name
            ));
        }
        if let Some(guided) = [a, b].iter().find(|g| g.guide.is_some()) {
            return Err(format!(
                "a sweep needs gears that rotate freely, but `{}` has a guide",
                guided.name
            ));
        }
        let (Body::Gear(first), Body::Gear(second)) = (&a.body, &b.body) else {
            return Err("a sweep needs two gears; a rack has a limited travel".into());
        };
        if let Some(held) = [a, b].iter().find(|g| matches!(g.mount, Mount::Fixed)) {
            return Err(format!(
                "`{}` is fixed, so that the gears cannot rotate",
                held.name
            ));
        }
        let layout = mesh_layout(a, b).map_err(|e| e.to_string())?;
        let sign = mesh.start.side.sign();
        let base_radii = [&a.body, &b.body].map(signed_base_radius);
        let loads = [a, b].map(MeanLoad::of);
        let driven = [a, b].map(|g| matches!(g.mount, Mount::Driven(_)));
        let viscous = loads.map(|l| l.viscous > 0.0);
        // Both torques press the flanks together along the line of action.
        let [fa, fb] = [0, 1].map(|i| sign * loads[i].constant / base_radii[i]);
        let holds = match (driven, viscous) {
            ([true, true], _) => {
                return Err("both gears are driven, so that no gear can vibrate".into());
            }
            ([true, false], _) => Some(0),
            ([false, true], _) => Some(1),
            (_, [false, true] | [true, true]) => Some(0),
            (_, [true, false]) => Some(1),
            _ if (fa - fb).abs() > BALANCE * fa.abs().max(fb.abs()) => {
                return Err(format!(
                    "the constant torques {} and {} N m are not balanced, so that the speed would drift; {} N m on `{}` needs {} N m on `{}`",
                    short(loads[0].constant, 5),
                    short(loads[1].constant, 5),
                    short(loads[0].constant, 5),
                    a.name,
                    short(loads[0].constant * base_radii[1] / base_radii[0], 8),
                    b.name,
                ));
            }
            _ => None,
        };
        let teeth = [first, second].map(|g| g.teeth() as usize);
        let pair = Pair {
            start: mesh.start.path_coordinate.unwrap_or(layout.pitch_point),
            layout,
            base_radii,
            teeth,
            sign,
            loads,
            holds,
            free: [a, b].iter().all(|g| matches!(g.mount, Mount::Revolute)),
            own: own_frequency([a, b].map(own_speed), teeth),
        };
        // The force of a viscous load depends on the swept speeds.
        let rest = pair.own_force();
        if rest <= 0.0 && viscous == [false; 2] {
            return Err(format!(
                "the loads cause {rest:.4} N on the flank of the start; a sweep needs torques that load this flank"
            ));
        }
        Ok(pair)
    }

    /// Returns the number of mesh cycles in a number of turns of the first gear of a scene.
    pub fn cycles_of(spec: &SceneSpec, turns: usize) -> usize {
        match spec.gears.first().map(|g| &g.body) {
            Some(Body::Gear(first)) => turns * first.teeth() as usize,
            _ => turns,
        }
    }

    /// Returns the pair of a model, or the reason why it cannot be swept.
    pub fn of_entry(plan: &Plan, entry: &Configuration) -> Result<Self, StudyError> {
        Pair::in_scene(&plan.conditions.name, &entry.scene)
    }

    pub fn in_scene(name: &str, spec: &SceneSpec) -> Result<Self, StudyError> {
        Pair::of(spec).map_err(|why| {
            let why = format!("the scene `{name}` cannot be swept: {why}");
            let help = "`gearbench init pair` writes a scene that can be swept, with comments";
            StudyError::Scene(why, help)
        })
    }

    /// Computes the force in the transverse plane at a mesh frequency [N]: torque over base radius.
    pub fn force(&self, frequency: f64) -> f64 {
        let pressing = match self.holds {
            Some(0) => 1,
            _ => 0,
        };
        let torque = self.loads[pressing].at(self.speeds(frequency)[pressing]);
        self.sign * torque / self.base_radii[pressing]
    }

    /// Returns an error for speeds at which the loads do not load the flank of the start.
    pub fn check_speeds(
        &self,
        name: &str,
        mut frequencies: impl Iterator<Item = f64>,
    ) -> Result<(), StudyError> {
        match frequencies.find(|f| self.force(*f) <= 0.0) {
            None => Ok(()),
            Some(f) => Err(StudyError::Scene(
                format!(
                    "the scene `{name}` cannot be swept to {f:.0} Hz: there the loads cause {:.4} N on the flank of the start",
                    self.force(f)
                ),
                "give a range of speeds in which the flank remains loaded despite the viscous loads",
            )),
        }
    }

    /// Returns the force in the transverse plane at the speed of the scene [N].
    pub fn own_force(&self) -> f64 {
        self.force(self.own)
    }

    /// Speeds of both gears at a mesh frequency [rad/s].
    fn speeds(&self, frequency: f64) -> [f64; 2] {
        let first = self.sign * TAU * frequency / self.teeth[0] as f64;
        [first, -first * self.base_radii[0] / self.base_radii[1]]
    }

    /// Returns the scene at a speed with its teeth in contact and its loads rising from zero until `rise` [s]; or,
    /// after an earlier run of the same gears, from its end state under the whole loads.
    pub fn scene(
        &self,
        spec: &SceneSpec,
        frequency: f64,
        rise: f64,
        from: Option<&EndState>,
    ) -> SceneSpec {
        let mut spec = spec.clone();
        spec.meshes[0].start.gap = 0.0;
        let speeds = self.speeds(frequency);
        for (i, (g, speed)) in spec.gears.iter_mut().zip(speeds).enumerate() {
            g.speed = speed;
            let driven = matches!(g.mount, Mount::Driven(_));
            if driven {
                g.mount = Mount::Driven(match from {
                    None => Profile::Constant(speed),
                    Some(end) => constant_speed_from(end.t, end.driven[i], speed),
                });
            }
            let lost = self.loads[i].viscous * speed;
            let full = if self.holds == Some(i) && !driven {
                self.sign * self.force(frequency) * self.base_radii[i] + lost
            } else {
                self.loads[i].constant
            };
            g.loads.retain_mut(|l| match l {
                Load::Applied(Profile::Harmonic { mean, .. }) => {
                    *mean = 0.0;
                    true
                }
                Load::Applied(_) => false,
                Load::Viscous(_) => true,
            });
            if full != 0.0 || lost != 0.0 {
                g.loads.push(Load::Applied(match from {
                    None => Profile::Ramp {
                        from: lost,
                        to: full,
                        start: 0.0,
                        end: rise,
                    },
                    Some(_) => Profile::Constant(full),
                }));
            }
        }
        spec
    }

    /// True if no motion is prescribed, so that damping losses decelerate the gears.
    pub fn is_free(&self) -> bool {
        self.free
    }

    /// Returns the scene with torques for an acceleration of the first gear [rad/s^2]. They are in proportion to the
    /// inertias of `built`, so that they do not load the contact.
    pub fn driven_by(&self, spec: &SceneSpec, built: &Scene, drive: f64) -> SceneSpec {
        let mut spec = spec.clone();
        if drive != 0.0 {
            for ((gear, ratio), of) in spec.gears.iter_mut().zip(self.ratios()).zip(built.gears()) {
                let torque = of.model.hub().hub.inertia * ratio * drive;
                gear.loads.push(Load::Applied(Profile::Constant(torque)));
            }
        }
        spec
    }

    /// Common rotation of free gears whose hubs have turned by `angles` [rad], as a turn of the first [rad].
    fn common_rotation(&self, scene: &Scene, angles: [f64; 2]) -> f64 {
        let (mut turned, mut inertia) = (0.0, 0.0);
        for ((gear, ratio), angle) in scene.gears().iter().zip(self.ratios()).zip(angles) {
            let own = gear.model.hub().hub.inertia * ratio;
            turned += own * angle;
            inertia += own * ratio;
        }
        turned / inertia
    }

    /// Corrects the common rotation of free gears to a mesh frequency, by the rotation of their hubs in the last
    /// `period` [s], a mesh cycle: within a cycle it varies, the more the slower they turn, as the teeth store energy
    /// and return it. The vibration of the gears is kept. Returns the excess speed of the first gear [rad/s].
    pub fn correct_speed(
        &self,
        scene: &Scene,
        state: &mut State,
        frequency: f64,
        angles: [[f64; 2]; 2],
        period: f64,
    ) -> f64 {
        let ratios = self.ratios();
        let [before, now] = angles.map(|a| self.common_rotation(scene, a));
        let off = (now - before) / period - self.speeds(frequency)[0];
        for (gear, ratio) in scene.gears().iter().zip(ratios) {
            turn_faster(gear, state, -ratio * off);
        }
        off
    }

    /// Speeds of both gears by unit speed of the first.
    fn ratios(&self) -> [f64; 2] {
        [1.0, -self.base_radii[0] / self.base_radii[1]]
    }

    /// Returns the state in which a run in a scene of this mesh starts: assembled, or the end of another run, turning
    /// at the new speed. Only the rigid rotation changes: the vibration of the gears is kept.
    pub fn start(&self, scene: &Scene, frequency: f64, from: Option<&EndState>) -> State {
        let mut state = scene.initial();
        let Some(end) = from.filter(|e| e.q.len() == state.q.len()) else {
            return state;
        };
        state.t = end.t;
        state.q.clone_from(&end.q);
        state.v.clone_from(&end.v);
        state.discrete.clone_from(&end.discrete);
        let (before, now) = (self.speeds(end.frequency), self.speeds(frequency));
        for (i, gear) in scene.gears().iter().enumerate() {
            if gear.model.hub().is_free() {
                turn_faster(gear, &mut state, now[i] - before[i]);
            }
        }
        state
    }
}

/// Adds a rigid rotation to the velocities of a gear, with all that turns with its hub.
fn turn_faster(gear: &SceneGear, state: &mut State, by: f64) {
    let range = gear.range();
    let (mut q, mut v) = (vec![0.0; range.len()], vec![0.0; range.len()]);
    let mut discrete = vec![0.0; gear.model.hub().discrete];
    gear.model.initialise(by, &mut q, &mut v, &mut discrete);
    for (own, more) in state.v[range].iter_mut().zip(v) {
        *own += more;
    }
}

/// A speed that is constant from a time on, at which it has come as far as `turned`.
fn constant_speed_from(t: f64, turned: f64, speed: f64) -> Profile {
    if t <= 0.0 {
        return Profile::Constant(speed);
    }
    // Whatever it was before: constant over the first half, then a line to the new speed.
    let before = (turned - 0.25 * t * speed) / (0.75 * t);
    Profile::table(vec![0.5 * t, t], vec![before, speed])
}

#[cfg(test)]
mod tests;
