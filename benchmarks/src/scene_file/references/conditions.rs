//! Conditions of a reference that differ from its scene, and the scene under these conditions.
//!
//! ```toml
//! [[references]]
//! name = "fast"
//! csv = "press_60.csv"
//! duration_s = 1e-4
//! gears.pinion.speed_rad_s = 60.0
//! ```

use super::super::reading::Place;
use super::super::reading::keys::keys;
use super::super::reading::suggest::there_are;
use super::super::{SceneError, SceneFile};
use super::{ReferenceTable, SceneParts};
use gearbench_models::spec::{Body, Load, Mount, Profile, SceneSpec, layout_axes, mesh_layout};

keys! {
    /// Conditions of one gear that differ from the scene in a reference.
    struct GearConditionTable {
        /// initial speed in rad/s, or the constant speed of a driven gear
        speed_rad_s: Option<f64>,
        /// the same of a rack in m/s
        speed_m_s: Option<f64>,
        /// constant torque in N m in place of the gear's loads
        torque_nm: Option<f64>,
        /// constant force in N in place of a rack's loads
        force_n: Option<f64>,
    }
}

/// Conditions of one gear that differ from the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConditionsOfGear {
    /// Index of the gear.
    pub gear: usize,
    /// Initial speed, or the constant speed of a driven gear [rad/s]; of a rack [m/s].
    pub speed: Option<f64>,
    /// Constant torque in place of the loads of the gear [N m]; force of a rack [N].
    pub load: Option<f64>,
}

/// Conditions of a reference that differ from the scene; `None` means equal to the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceConditions {
    /// Simulated time [s].
    pub duration: Option<f64>,
    /// Gap of all meshes at the start [m].
    pub gap: Option<f64>,
    /// Path coordinate at the start of the only mesh [m].
    pub path_coordinate: Option<f64>,
    /// Centre distance of the only mesh [m].
    pub centre_distance: Option<f64>,
    /// Differing conditions of gears, in the order of the gears.
    pub gears: Vec<ConditionsOfGear>,
}

/// Reads and checks the conditions of a reference.
pub(super) fn read(
    keys: &ReferenceTable,
    beside: &SceneParts<'_>,
    at: &Place<'_>,
) -> Result<ReferenceConditions, SceneError> {
    let mut gears: Vec<ConditionsOfGear> = Vec::new();
    for (name, own) in &keys.gears.0 {
        let place = at.key("gears").key(name);
        let found = beside.spec.gears.iter().position(|g| g.name == *name);
        let Some(gear) = found else {
            let known: Vec<String> = beside.spec.gears.iter().map(|g| g.name.clone()).collect();
            return place.refuse(
                format!("there is no gear `{name}`"),
                "not known",
                there_are(name, &known),
            );
        };
        let rack = matches!(beside.spec.gears[gear].body, Body::Rack(_));
        let (speed, load, foreign) = match rack {
            false => (own.speed_rad_s, own.torque_nm, ["speed_m_s", "force_n"]),
            true => (own.speed_m_s, own.force_n, ["speed_rad_s", "torque_nm"]),
        };
        if let Some(key) = foreign.into_iter().find(|key| place.has(key)) {
            let (is, takes) = match rack {
                false => ("a gear", "`speed_rad_s` and `torque_nm`"),
                true => ("a rack", "`speed_m_s` and `force_n`"),
            };
            return place.key(key).refuse(
                format!("`{name}` is {is}"),
                "not a key of this body",
                format!("use {takes}"),
            );
        }
        gears.push(ConditionsOfGear { gear, speed, load });
    }
    let conditions = ReferenceConditions {
        duration: keys.duration_s.map(f64::from),
        gap: keys.gap_m,
        path_coordinate: keys.path_coordinate_m,
        centre_distance: keys.centre_distance_m.map(f64::from),
        gears,
    };
    let mut spec = beside.spec.clone();
    match conditions.apply(&mut spec) {
        Ok(()) => Ok(conditions),
        Err((key, why, help)) => {
            let place = match key.split_once('.') {
                Some((gear, key)) => at.key("gears").key(gear).first(&[key]),
                None => at.first(&[key.as_str()]),
            };
            place.refuse(why, "not possible", help)
        }
    }
}

/// Key with the error, message and help.
pub type ConditionError = (String, String, String);

impl ReferenceConditions {
    /// Applies the conditions to a scene.
    ///
    /// # Errors
    /// The key that cannot be fulfilled, the reason and help.
    pub fn apply(&self, spec: &mut SceneSpec) -> Result<(), ConditionError> {
        for own in &self.gears {
            let Some(gear) = spec.gears.get_mut(own.gear) else {
                continue;
            };
            let rack = matches!(gear.body, Body::Rack(_));
            let key = |what: &str| format!("{}.{what}", gear.name);
            let speed_key = if rack { "speed_m_s" } else { "speed_rad_s" };
            let load_key = if rack { "force_n" } else { "torque_nm" };
            if let Some(speed) = own.speed {
                match &gear.mount {
                    Mount::Fixed if speed != 0.0 => {
                        return Err((
                            key(speed_key),
                            format!("`{}` is fixed", gear.name),
                            "remove the speed".into(),
                        ));
                    }
                    Mount::Driven(_) => gear.mount = Mount::Driven(Profile::Constant(speed)),
                    _ => gear.speed = speed,
                }
            }
            if let Some(load) = own.load {
                if matches!(gear.mount, Mount::Driven(_) | Mount::Fixed) {
                    return Err((
                        key(load_key),
                        format!(
                            "`{}` is fixed or driven, so that a load has no effect",
                            gear.name
                        ),
                        "give the load of a gear that can move".into(),
                    ));
                }
                gear.loads = match load == 0.0 {
                    true => Vec::new(),
                    false => vec![Load::Applied(Profile::Constant(load))],
                };
            }
        }
        if let Some(distance) = self.centre_distance {
            let [mesh] = spec.meshes.as_slice() else {
                return Err((
                    "centre_distance_m".into(),
                    "the scene has several meshes, but the distance belongs to one mesh".into(),
                    "write one scene for each distance".into(),
                ));
            };
            let [a, b] = mesh.gears;
            let refuse = |e: &dyn std::fmt::Display| {
                let help = "give a distance of the axes at which the flanks can mesh";
                (
                    "centre_distance_m".to_owned(),
                    e.to_string(),
                    help.to_owned(),
                )
            };
            let direction = mesh_layout(&spec.gears[a], &spec.gears[b])
                .map_err(|e| refuse(&e))?
                .direction;
            let from = spec.gears[a].position;
            let [x, y, _] = layout_axes(&spec.gears[a], &spec.gears[b]);
            let to = distance * (direction.cos() * x + direction.sin() * y);
            spec.gears[b].position = [0, 1, 2].map(|k| from[k] + to[k]);
            mesh_layout(&spec.gears[a], &spec.gears[b]).map_err(|e| refuse(&e))?;
        }
        if self.path_coordinate.is_some() && spec.meshes.len() > 1 {
            return Err((
                "path_coordinate_m".into(),
                "the scene has several meshes, but the path coordinate belongs to one mesh".into(),
                "write one scene for each start".into(),
            ));
        }
        for mesh in &mut spec.meshes {
            let [a, b] = mesh.gears;
            let layout = mesh_layout(&spec.gears[a], &spec.gears[b]);
            if let Some(gap) = self.gap {
                mesh.start.gap = gap;
                if layout
                    .as_ref()
                    .is_ok_and(|l| gap > l.pair.backlash_normal() * (1.0 + 1e-9))
                {
                    return Err((
                        "gap_m".into(),
                        format!("the gap {gap:e} m is larger than the normal backlash"),
                        "use a smaller gap".into(),
                    ));
                }
            }
            if let Some(x) = self.path_coordinate {
                mesh.start.path_coordinate = Some(x);
                if layout.is_ok_and(|l| !(l.path[0]..=l.path[1]).contains(&x)) {
                    return Err((
                        "path_coordinate_m".into(),
                        format!("the path coordinate {x:e} m lies outside the path of contact"),
                        "remove it to start at the position of the scene".into(),
                    ));
                }
            }
        }
        Ok(())
    }

    /// The conditions as lines of a reference in a scene file.
    pub fn lines(&self, spec: &SceneSpec) -> Vec<String> {
        let mut lines = Vec::new();
        let mut add = |key: &str, x: Option<f64>| {
            lines.extend(x.map(|x| format!("{key} = {x:?}")));
        };
        add("duration_s", self.duration);
        add("gap_m", self.gap);
        add("path_coordinate_m", self.path_coordinate);
        add("centre_distance_m", self.centre_distance);
        for own in &self.gears {
            let Some(gear) = spec.gears.get(own.gear) else {
                continue;
            };
            let [speed, load] = match gear.body {
                Body::Gear(_) => ["speed_rad_s", "torque_nm"],
                Body::Rack(_) => ["speed_m_s", "force_n"],
            };
            add(&format!("gears.{}.{speed}", gear.name), own.speed);
            add(&format!("gears.{}.{load}", gear.name), own.load);
        }
        lines
    }
}

/// The conditions of a run by the keys of a scene: `gearbench reference` writes them to its file, and they are compared
/// with the scene when that file is read.
pub fn stated(spec: &SceneSpec) -> Vec<(String, f64)> {
    let mut all = Vec::new();
    for g in &spec.gears {
        let mut add = |key: &str, x: f64| all.push((format!("gears.{}.{key}", g.name), x));
        let speed = match (&g.body, &g.mount) {
            (_, Mount::Driven(Profile::Constant(speed))) => *speed,
            _ => g.speed,
        };
        let load: f64 = (g.loads.iter())
            .filter_map(|l| match l {
                Load::Applied(Profile::Constant(x)) => Some(*x),
                _ => None,
            })
            .sum();
        match &g.body {
            Body::Gear(body) => {
                let p = body.params();
                add("teeth", p.teeth.into());
                add("module_m", p.module);
                add("pressure_angle_deg", p.pressure_angle.to_degrees());
                add("profile_shift", p.profile_shift);
                add("helix_angle_deg", p.helix_angle.to_degrees());
                add("face_width_m", p.face_width);
                add(
                    "inertia_kgm2",
                    g.inertia
                        .unwrap_or(body.mass_properties(g.material.density).izz),
                );
                add("speed_rad_s", speed);
                add("torque_nm", load);
            }
            Body::Rack(body) => {
                let p = body.params();
                add("teeth", p.teeth.into());
                add("module_m", p.module);
                add("pressure_angle_deg", p.pressure_angle.to_degrees());
                add("helix_angle_deg", p.helix_angle.to_degrees());
                add("face_width_m", p.face_width);
                add("speed_m_s", speed);
                add("force_n", load);
            }
        }
        add("young_pa", g.material.young);
    }
    for m in &spec.meshes {
        let [a, b] = m.gears;
        if let Ok(layout) = mesh_layout(&spec.gears[a], &spec.gears[b]) {
            let names = [a, b].map(|i| spec.gears[i].name.as_str());
            let key = format!("meshes.{}-{}.centre_distance_m", names[0], names[1]);
            all.push((key, layout.distance));
        }
    }
    all
}

impl SceneFile {
    /// Returns the scene under other conditions.
    ///
    /// # Errors
    /// As [`ReferenceConditions::apply`].
    pub fn with(&self, conditions: &ReferenceConditions) -> Result<SceneFile, ConditionError> {
        let mut other = self.clone();
        conditions.apply(&mut other.spec)?;
        other.duration = conditions.duration.unwrap_or(self.duration);
        Ok(other)
    }
}
