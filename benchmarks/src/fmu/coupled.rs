//! A scene with the inputs of a host: an additional load on every free hub, and a prescribed motion of every hub that
//! the host moves.
//!
//! Added loads are zero until a host sets them, so that the scene by itself runs as it does without a host.

use super::interface::Interface;
use crate::scene_file::{ModelChoice, SceneError, SceneFile, did_you_mean};
use crate::small_signals::{Patience, assemble};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, Mount, Profile, SceneSpec, StationMember, initial_speed};

/// Quantity of the scene on which an input of a host acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputQuantity {
    /// A load of a member, by its index among the loads of the member.
    Load(usize),
    /// The prescribed motion of the hub.
    Motion,
}

/// A member of the scene on which the host acts.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// Index of the member: the gears of the scene first, then the bodies.
    pub member: usize,
    /// Name of the member, as in the scene.
    pub name: String,
    /// Load or motion that the inputs set.
    pub acts: InputQuantity,
    /// True if the member translates: forces and displacements in place of torques and angles.
    pub slides: bool,
    /// Initial speed of a moved hub [rad/s] or [m/s].
    pub speed: f64,
}

/// A scene with its ports and the variables of its FMU.
pub struct Coupled {
    /// The assembled scene with the added loads.
    pub scene: Scene,
    /// Ports of the host.
    pub ports: Vec<Port>,
    /// The variables of the model description.
    pub interface: Interface,
}

impl Coupled {
    /// Assembles a model of a scene, with hubs that the host moves.
    ///
    /// # Errors
    /// A gear that does not exist or cannot be moved, or a model that cannot be assembled.
    pub fn assemble(
        file: &SceneFile,
        choice: &ModelChoice,
        moved: &[String],
    ) -> Result<Self, SceneError> {
        let mut spec = file.spec_for(choice);
        for name in moved {
            move_by_host(&mut spec, name)?;
        }
        let loaded = load_all(&mut spec);
        let patience = Patience::until(&file.context.interruption);
        let scene = assemble(&spec, &choice.modelling, &file.context.models, &patience)
            .map_err(|e| file.locate_in(&choice.label, &e))?;
        let mut ports = Vec::new();
        for (member, gear) in scene.gears().iter().enumerate() {
            let hub = gear.model.hub();
            let load = loaded.iter().find(|(name, _)| *name == gear.name);
            let acts = match load {
                Some(&(_, place)) => InputQuantity::Load(place),
                None if moved.contains(&gear.name) => InputQuantity::Motion,
                None => continue,
            };
            ports.push(Port {
                member,
                name: gear.name.clone(),
                acts,
                slides: hub.slide.is_some(),
                speed: hub.speed(0.0, &[0.0]),
            });
        }
        let interface = Interface::of(&spec, &scene, &ports);
        Ok(Coupled {
            scene,
            ports,
            interface,
        })
    }
}

/// Prescribes the motion of a gear.
fn move_by_host(spec: &mut SceneSpec, name: &str) -> Result<(), SceneError> {
    let refuse = |why: String, help: &str| Err(SceneError::plain(why, help));
    let Some(gear) = spec.gears.iter().position(|g| g.name == *name) else {
        let names: Vec<&str> = spec.gears.iter().map(|g| g.name.as_str()).collect();
        return Err(SceneError::plain(
            format!("the scene has no gear `{name}` that a host could move"),
            format!(
                "{}the scene has {}",
                did_you_mean(name, &names),
                names.join(", ")
            ),
        ));
    };
    let stations = spec.shafts.iter().flat_map(|s| &s.stations);
    let mut on_shafts = stations.map(|s| &s.carries);
    if on_shafts.any(|c| matches!(c, StationMember::Gear(g) if *g == gear)) {
        return refuse(
            format!("`{name}` is on a shaft of the scene, which determines its motion"),
            "model the shaft in the host, or apply a torque to a member on the shaft",
        );
    }
    let planets = spec.bodies().flat_map(|b| &b.planets);
    let carried: Vec<usize> = planets.copied().collect();
    let mut meshes = spec.meshes.iter().filter(|m| m.gears.contains(&gear));
    if meshes.any(|m| m.gears.iter().any(|g| carried.contains(g))) {
        return refuse(
            format!("`{name}` belongs to a planetary set, whose gears a host cannot move"),
            "apply a torque to it, or drive it in the scene",
        );
    }
    let gear = &mut spec.gears[gear];
    let speed = initial_speed(&gear.mount, gear.speed);
    // Its loads stay: a damping at the load of a mesh is made of them.
    gear.mount = Mount::Driven(Profile::Constant(speed));
    Ok(())
}

/// Adds a load to every free gear and body; returns the name of the member and the index of the load.
fn load_all(spec: &mut SceneSpec) -> Vec<(String, usize)> {
    let mut loaded = Vec::new();
    let mut add = |name: &str, mount: &Mount, loads: &mut Vec<Load>| {
        if matches!(mount, Mount::Revolute | Mount::Prismatic) {
            loaded.push((name.to_owned(), loads.len()));
            loads.push(Load::Applied(Profile::Constant(0.0)));
        }
    };
    for g in &mut spec.gears {
        add(&g.name, &g.mount, &mut g.loads);
    }
    for station in spec.shafts.iter_mut().flat_map(|s| &mut s.stations) {
        if let StationMember::Body(b) = &mut station.carries {
            add(&b.name, &b.mount, &mut b.loads);
        }
    }
    loaded
}
