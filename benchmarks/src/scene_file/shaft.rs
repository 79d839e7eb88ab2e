//! The list `[[shafts]]`: gears and bodies that rotate together, on a rigid shaft or an elastic beam.
//!
//! ```toml
//! [[shafts]]
//! name = "input"
//! carries = [
//!     { body = "motor", at_m = 0.0, inertia_kgm2 = 2e-3, loads = [{ torque_nm = 30.0 }] },
//!     { gear = "pinion", at_m = 0.2 },
//! ]
//! sections = [{ length_m = 0.2, diameter_m = 0.03 }]       # none: a rigid shaft
//! damping_ratio = 0.01                                     # of sections that do not give their own
//! ```

use super::error::SceneError;
use super::gear::{GearDraft, initial_speed, loads};
use super::material::{MaterialChoice, material};
use super::measured::DataFiles;
use super::out_of_plane::{BearingTable, DirectionTable, OutOfPlaneTable, out_of_plane};
use super::profile::{GearLoad, GearMount};
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::{Count, GearName, NotNegative, Positive, is_default};
use gearbench_models::spec::{
    BodySpec, Mount, SceneSpec, Section, SectionKind, ShaftDamping, ShaftSpec, SpinTerms, Station,
    StationMember, initial_speed as speed_at_start, signed_effective_radius,
};

keys! {
    /// A shaft with its gears and bodies.
    #[derive(Default)]
    struct ShaftTable {
        /// name of the shaft, for example "input"
        name: String,
        /// gears and bodies on it from one end to the other: { gear = "pinion", at_m = 0.2 } and { body = "motor", at_m = 0.0, inertia_kgm2 = 0.01 }
        carries: Vec<StationTable>,
        /// list of { length_m, diameter_m } from the place 0 on; left out, the shaft is rigid
        sections: Option<Vec<SectionTable>>,
        /// damping ratio at the lowest frequencies of the shaft with its gears and bodies, default 0
        damping_ratio: Option<NotNegative>,
        /// damping over stiffness in seconds, in place of a ratio
        damping_s: Option<NotNegative>,
        /// initial speed in rad/s of all on it that do not give their own
        speed_rad_s: Option<f64>,
    }

    /// A gear or a body on a shaft.
    #[derive(Default)]
    struct StationTable {
        /// name of a gear
        gear: Option<GearName>,
        /// name of a body without teeth, which this introduces
        body: Option<String>,
        /// place along the shaft in metres
        at_m: f64,
        /// inertia of the body about the axis in kg m^2, in addition to that of the shaft, default 0
        inertia_kgm2: Option<NotNegative>,
        /// of a body: "revolute" (default), "fixed" or { driven = { speed_rad_s = 100.0 } }
        mount: Option<GearMount>,
        /// initial speed of the body in rad/s
        speed_rad_s: Option<f64>,
        /// list of loads on the body, for example [{ torque_nm = 10.0 }]
        loads: Option<Vec<GearLoad>>,
        /// springs and dampers to the ground, for example { stiffness = [1e8, 1e8, 5e7, 0.0, 0.0, 0.0] }; the shaft then bends
        bearing: Option<BearingTable>,
        /// directions of the body that are held or driven, for example { z = "held" }; the others are free
        directions: Option<DirectionTable>,
        /// mass of the body in kg, where the shaft bends, default 0
        mass_kg: Option<Positive>,
        /// its inertia tensor in kg m^2, three rows of three; left out, that of a thin disc
        inertia_tensor_kgm2: Option<[[f64; 3]; 3]>,
        /// its centre of mass from the axis in metres, default [0, 0, 0]
        centre_of_mass_m: Option<[f64; 3]>,
        /// "auto" (default), "on" or "off"
        spin_terms: Option<SpinTerms>,
        /// of a body: names of the gears whose axes go round with it, which makes it a planet carrier
        planets: Option<Vec<GearName>>,
    }

    /// A section of an elastic shaft.
    #[derive(Default)]
    struct SectionTable {
        /// length in metres
        length_m: Positive,
        /// outer diameter in metres
        diameter_m: Option<Positive>,
        /// inner diameter in metres, default 0
        inner_diameter_m: Option<NotNegative>,
        /// "steel" (default), "steel-iso6336", or { young_pa, poisson, density_kg_m3 }
        #[serde(default, skip_serializing_if = "is_default")]
        material: MaterialChoice,
        /// beam elements, default 1
        divisions: Option<Count<1, 200>>,
        /// in place of a diameter: a coupling without mass that only resists twist, in N m/rad over its length
        stiffness_nm_per_rad: Option<Positive>,
        /// damping over stiffness of this section in seconds, in place of that of the shaft
        damping_s: Option<NotNegative>,
        /// damper of a coupling in N m s/rad over its length, in place of that of the shaft
        damping_nms_per_rad: Option<NotNegative>,
    }
}

/// Gears of a shaft by index, with their positions along it [m].
pub(super) type ShaftGears = Vec<(usize, f64)>;

/// Checks all shafts; sets the speeds of gears that have none.
pub(super) fn shafts(
    list: Vec<ShaftTable>,
    gears: &mut [GearDraft],
    files: &DataFiles<'_>,
    all: &Place<'_>,
) -> Result<Vec<ShaftSpec>, SceneError> {
    (list.into_iter().enumerate())
        .map(|(i, keys)| shaft(keys, gears, files, &all.member(i)))
        .collect()
}

/// Groups of gears on one axis.
pub(super) fn groups(shafts: &[ShaftSpec]) -> Vec<ShaftGears> {
    let of = |shaft: &ShaftSpec| {
        let gears = shaft.stations.iter().filter_map(|s| match s.carries {
            StationMember::Gear(i) => Some((i, s.place)),
            StationMember::Body(_) => None,
        });
        gears.collect()
    };
    shafts.iter().map(of).collect()
}

/// Sets the position of gears from the position of their shaft.
pub(super) fn place_by_shaft(
    groups: &[ShaftGears],
    gears: &mut [GearDraft],
    placed: &mut [bool],
    which: [usize; 2],
) {
    for i in which
        .into_iter()
        .filter(|i| !placed[*i])
        .collect::<Vec<_>>()
    {
        let Some(group) = groups.iter().find(|g| g.iter().any(|(k, _)| *k == i)) else {
            continue;
        };
        let own = group.iter().find(|(k, _)| *k == i).map_or(0.0, |g| g.1);
        if let Some(&(mate, place)) = group.iter().find(|(k, _)| placed[*k]) {
            let from = gears[mate].position.unwrap_or_default();
            let along = (own - place) * gears[mate].spec.axes[2];
            gears[i].position = Some([0, 1, 2].map(|k| from[k] + along[k]));
            placed[i] = true;
        }
    }
}

fn shaft(
    keys: ShaftTable,
    gears: &mut [GearDraft],
    files: &DataFiles<'_>,
    at: &Place<'_>,
) -> Result<ShaftSpec, SceneError> {
    let damping = match (keys.damping_ratio, keys.damping_s) {
        (Some(_), Some(_)) => {
            return Err(at.key("damping_s").against(
                (&at.key("damping_ratio"), "this"),
                "two values of damping are given",
                "and this",
                "give a ratio or a time",
            ));
        }
        (Some(ratio), None) => ShaftDamping::Ratio(ratio.0),
        (None, Some(time)) => ShaftDamping::Time(time.0),
        (None, None) => ShaftDamping::None,
    };
    let mut stations = Vec::new();
    for (i, station) in keys.carries.into_iter().enumerate() {
        let place = at.key("carries").member(i);
        stations.push(Station {
            place: station.at_m,
            carries: carried(station, keys.speed_rad_s, (&mut *gears, files), &place)?,
        });
    }
    let sections = keys.sections.unwrap_or_default().into_iter().enumerate();
    let sections = sections.map(|(i, s)| section(s, &at.key("sections").member(i)));
    Ok(ShaftSpec {
        name: keys.name,
        stations,
        sections: sections.collect::<Result<_, _>>()?,
        damping,
    })
}

fn carried(
    keys: StationTable,
    speed: Option<f64>,
    (gears, files): (&mut [GearDraft], &DataFiles<'_>),
    at: &Place<'_>,
) -> Result<StationMember, SceneError> {
    let name = match (keys.gear, keys.body) {
        (Some(gear), None) => {
            let of_body = [
                "inertia_kgm2",
                "mount",
                "speed_rad_s",
                "loads",
                "bearing",
                "directions",
                "mass_kg",
                "inertia_tensor_kgm2",
                "centre_of_mass_m",
                "spin_terms",
                "planets",
            ];
            if let Some(key) = of_body.into_iter().find(|key| at.has(key)) {
                return at.key(key).refuse(
                    format!("`{key}` is given for a gear"),
                    "a key of bodies",
                    format!("give it in [gears.{}]", gear.0),
                );
            }
            // Other names are refused when they are read.
            let found = gears.iter().position(|g| g.spec.name == gear.0);
            let index = found.unwrap_or_default();
            let spec = &mut gears[index].spec;
            if let Some(speed) = speed.filter(|_| spec.speed == 0.0)
                && matches!(spec.mount, Mount::Revolute)
            {
                spec.speed = speed;
            }
            return Ok(StationMember::Gear(index));
        }
        (None, Some(body)) => body,
        (gear, _) => {
            let (what, help) = match gear {
                Some(_) => ("`gear` and `body` are both given", "keep one"),
                None => (
                    "neither a gear nor a body",
                    "give gear = \"..\" or body = \"..\"",
                ),
            };
            return at.refuse(what, "one of them", help);
        }
    };
    let fits = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    if name.is_empty() || name.len() > 60 || !name.chars().all(fits) {
        return at.key("body").refuse(
            "the name of a body has to be valid in column names",
            "not a valid name",
            "give 1 to 60 letters, digits, `_`, `-`",
        );
    }
    let (mount, guide) = match keys.mount {
        Some(mount) => mount.parts(files, &at.key("mount"))?,
        None => (Mount::Revolute, None),
    };
    let own = match (&mount, keys.speed_rad_s) {
        (Mount::Revolute, None) => speed,
        (_, own) => own,
    };
    let sideways = keys.bearing.is_some()
        || keys.directions.is_some()
        || keys.mass_kg.is_some()
        || keys.inertia_tensor_kgm2.is_some()
        || keys.centre_of_mass_m.is_some()
        || keys.spin_terms.is_some();
    let lateral = if sideways {
        let keys = OutOfPlaneTable {
            // Directions without a bearing are free.
            bearing: Some(keys.bearing.unwrap_or_default()),
            directions: keys.directions,
            mass: keys.mass_kg,
            added_mass: None,
            inertia: keys.inertia_tensor_kgm2,
            centre_of_mass: keys.centre_of_mass_m,
            spin: keys.spin_terms,
        };
        out_of_plane(keys, 5, files, at)?
    } else {
        None
    };
    Ok(StationMember::Body(Box::new(BodySpec {
        name,
        inertia: keys.inertia_kgm2.map_or(0.0, f64::from),
        speed: initial_speed(own, &mount, "speed_rad_s", at)?,
        mount,
        guide,
        lateral,
        loads: loads(keys.loads, |load, place| load.load(files, place), at)?,
        planets: (keys.planets.iter().flatten())
            .filter_map(|planet| gears.iter().position(|g| g.spec.name == planet.0))
            .collect(),
    })))
}

/// Sets the speed of planets that give none to rolling on the first gear that they mesh with.
pub(super) fn roll_planets(spec: &mut SceneSpec, gears: &Place<'_>) {
    let turning = |spec: &SceneSpec| -> Vec<(Vec<usize>, f64)> {
        let carriers = spec.bodies().filter(|b| !b.planets.is_empty());
        carriers
            .map(|b| (b.planets.clone(), speed_at_start(&b.mount, b.speed)))
            .collect()
    };
    for (planets, carrier) in turning(spec) {
        // One after the other: the second of two planets in mesh rolls on the first.
        let mut known: Vec<usize> = (0..spec.gears.len())
            .filter(|g| !planets.contains(g) || gears.key(&spec.gears[*g].name).has("speed_rad_s"))
            .collect();
        while let Some((planet, mate)) = spec.meshes.iter().find_map(|mesh| {
            match mesh
                .gears
                .map(|g| (planets.contains(&g), known.contains(&g)))
            {
                [(true, false), (_, true)] => Some((mesh.gears[0], mesh.gears[1])),
                [(_, true), (true, false)] => Some((mesh.gears[1], mesh.gears[0])),
                _ => None,
            }
        }) {
            let of = |g: usize| {
                let g = &spec.gears[g];
                (
                    signed_effective_radius(&g.body),
                    speed_at_start(&g.mount, g.speed),
                )
            };
            let ((own, _), (radius, speed)) = (of(planet), of(mate));
            spec.gears[planet].speed = carrier - radius / own * (speed - carrier);
            known.push(planet);
        }
    }
}

/// Reads the damping over stiffness of a section; `None` where it has that of its shaft.
fn own_damping(keys: &SectionTable, at: &Place<'_>) -> Result<Option<f64>, SceneError> {
    let time = keys.damping_s.as_ref().map(|t| t.0);
    let Some(damper) = keys.damping_nms_per_rad.as_ref().map(|c| c.0) else {
        return Ok(time);
    };
    let own = at.key("damping_nms_per_rad");
    if time.is_some() {
        return Err(own.against(
            (&at.key("damping_s"), "this"),
            "two values of damping are given",
            "and this",
            "give a time or a damper",
        ));
    }
    match keys.stiffness_nm_per_rad.as_ref() {
        Some(stiffness) => Ok(Some(damper / stiffness.0)),
        None => own.refuse(
            "a damper is given for a section with a diameter",
            "of couplings alone",
            "give `damping_s`, damping over stiffness",
        ),
    }
}

fn section(keys: SectionTable, at: &Place<'_>) -> Result<Section, SceneError> {
    let damping = own_damping(&keys, at)?;
    let kind = match (keys.diameter_m, keys.stiffness_nm_per_rad) {
        (Some(outer), None) => SectionKind::Round {
            diameters: [outer.0, keys.inner_diameter_m.map_or(0.0, f64::from)],
            material: material(&keys.material, &at.key("material"))?,
        },
        (None, Some(stiffness)) => {
            if let Some(key) = ["inner_diameter_m", "material"]
                .into_iter()
                .find(|key| at.has(key))
            {
                return at.key(key).refuse(
                    format!("`{key}` has no effect on a coupling"),
                    "this key",
                    "give a diameter in place of the stiffness, or remove it",
                );
            }
            SectionKind::Coupling {
                stiffness: stiffness.0,
            }
        }
        (outer, _) => {
            let what = match outer {
                Some(_) => "a diameter and a torsional stiffness are both given",
                None => "a section has neither a diameter nor a torsional stiffness",
            };
            return at.refuse(
                what,
                "this section",
                "give diameter_m or stiffness_nm_per_rad",
            );
        }
    };
    Ok(Section {
        length: keys.length_m.0,
        kind,
        divisions: keys.divisions.map_or(1, |n| n.0),
        damping,
    })
}
