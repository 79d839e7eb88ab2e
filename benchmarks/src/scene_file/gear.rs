//! `[gears.NAME]`: toothing, material, hub, mount, speed, loads.

use super::error::SceneError;
use super::geometry::geometry;
use super::profile;
use super::reader::{Entry, Key, Section, key};
use gearbench_models::geometry::{
    Gear, GearParams, Modifications, Rack, RackParams, ReliefShape, TipRelief,
};
use gearbench_models::spec::{Body, GearSpec, Mount};
use gearbench_models::stiffness::{Material, Property, StiffnessError};
use std::collections::BTreeMap;
use std::ops::Range;

const KIND: Key = key("kind", "\"gear\" (default) or \"rack\"");
const TEETH: Key = key("teeth", "number of teeth, for example 20");
const MODULE: Key = key("module_m", "normal module in metres, for example 0.004");
const PRESSURE_ANGLE: Key = key(
    "pressure_angle_deg",
    "normal pressure angle in degrees, default 20",
);
const HELIX_ANGLE: Key = key(
    "helix_angle_deg",
    "helix angle in degrees, right hand positive, default 0",
);
const FACE_WIDTH: Key = key("face_width_m", "face width in metres, for example 0.01");
const ADDENDUM: Key = key("addendum_factor", "addendum over module, default 1");
const DEDENDUM: Key = key("dedendum_factor", "dedendum over module, default 1.25");
const TIP_RADIUS: Key = key(
    "tip_radius_factor",
    "tip radius of the rack tool over module, default 0.38",
);
const THINNING: Key = key(
    "thinning_m",
    "reduction of the tooth thickness at the reference circle in metres, default 0",
);
const MATERIAL: Key = key(
    "material",
    "\"steel\" (default), \"steel-iso6336\", or { young_pa, poisson, density_kg_m3 }",
);
const LOADS: Key = key("loads", "list of loads, for example [{ torque_nm = 10.0 }]");
const POSITION: Key = key(
    "position_m",
    "[x, y] of the axis in metres; left out, the mesh places the gear",
);

pub(super) static GEAR: &[Key] = &[
    KIND,
    TEETH,
    MODULE,
    PRESSURE_ANGLE,
    key("profile_shift", "profile shift coefficient x, default 0"),
    HELIX_ANGLE,
    FACE_WIDTH,
    ADDENDUM,
    DEDENDUM,
    TIP_RADIUS,
    THINNING,
    key("bore_radius_m", "bore radius in metres, default 0 (solid)"),
    key(
        "tip_relief",
        "{ amount_m, start_radius_m, shape = \"linear\" or \"parabolic\" }",
    ),
    key(
        "profile_crowning_m",
        "material removed at tip and root by profile crowning in metres, default 0",
    ),
    key(
        "lead_crowning_m",
        "material removed at both face ends by lead crowning in metres, default 0",
    ),
    MATERIAL,
    key(
        "inertia_kgm2",
        "inertia about the axis in kg m^2; left out, that of the toothing",
    ),
    key(
        "added_inertia_kgm2",
        "inertia added at the hub in kg m^2, default 0",
    ),
    key(
        "mount",
        "\"revolute\" (default), \"fixed\" or { driven = { speed_rad_s = 100.0 } }",
    ),
    POSITION,
    key(
        "speed_rad_s",
        "initial angular velocity in rad/s, counter-clockwise positive, default 0",
    ),
    LOADS,
];

pub(super) static RACK: &[Key] = &[
    KIND,
    TEETH,
    MODULE,
    PRESSURE_ANGLE,
    HELIX_ANGLE,
    FACE_WIDTH,
    ADDENDUM,
    DEDENDUM,
    TIP_RADIUS,
    THINNING,
    key(
        "body_height_m",
        "height of the body below the root line in metres, default one and a half modules",
    ),
    MATERIAL,
    key("mass_kg", "mass in kg; left out, that of the toothed body"),
    key("added_mass_kg", "mass added in kg, default 0"),
    key(
        "mount",
        "\"prismatic\" (default), \"fixed\" or { driven = { speed_m_s = 1.0 } }",
    ),
    POSITION,
    key(
        "facing_deg",
        "direction from the body to the teeth in degrees; left out, towards the gear",
    ),
    key(
        "speed_m_s",
        "initial speed in m/s, counter-clockwise positive as seen from the gear, default 0",
    ),
    LOADS,
];

pub(super) static RELIEF: &[Key] = &[
    key(
        "amount_m",
        "material removed at the tip, normal to the flank, in metres",
    ),
    key(
        "start_radius_m",
        "radius at which the relief starts in metres",
    ),
    key("shape", "\"linear\" (default) or \"parabolic\""),
];

pub(super) static ELASTIC: &[Key] = &[
    key("young_pa", "Young's modulus in pascal, for example 2.1e11"),
    key("poisson", "Poisson's ratio, for example 0.3"),
    key("density_kg_m3", "density in kg/m^3, for example 7850"),
];

/// A gear as read, before the meshes have placed it.
#[derive(Clone, Debug)]
pub(super) struct GearDraft {
    pub(super) spec: GearSpec,
    /// Position given in the file.
    pub(super) position: Option<[f64; 2]>,
    /// Facing of a rack given in the file [rad].
    pub(super) facing: Option<f64>,
    pub(super) place: Place,
}

/// Where a table and its keys stand in the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Place {
    pub(super) header: Range<usize>,
    pub(super) keys: BTreeMap<String, Range<usize>>,
}

impl Place {
    pub(super) fn of(entry: &Entry<'_>) -> Result<Self, SceneError> {
        let keys = super::reader::in_order(entry.source(), entry.raw_table()?)
            .iter()
            .map(|e| (e.name.to_owned(), e.key_range().start..e.span().end))
            .collect();
        Ok(Place {
            header: entry.span(),
            keys,
        })
    }

    /// The first of several keys that is in the file, else the header.
    pub(super) fn first(&self, keys: &[&str]) -> Range<usize> {
        keys.iter()
            .find_map(|k| self.keys.get(*k))
            .unwrap_or(&self.header)
            .clone()
    }
}

/// Reads one gear or rack.
pub(super) fn gear(entry: &Entry<'_>) -> Result<GearDraft, SceneError> {
    let name = entry.name;
    let kind = super::reader::in_order(entry.source(), entry.raw_table()?)
        .into_iter()
        .find(|e| e.name == "kind");
    let rack = match kind {
        Some(kind) => kind.word(&[("gear", false), ("rack", true)])?,
        None => false,
    };
    let section = entry.section(format!("[gears.{name}]"), if rack { RACK } else { GEAR })?;
    let place = Place::of(entry)?;
    let body = if rack {
        read_rack(&section, &place)?
    } else {
        read_gear(&section, &place)?
    };
    let mount = match section.get("mount") {
        Some(m) => profile::mount(&m, rack)?,
        None if rack => Mount::Prismatic,
        None => Mount::Revolute,
    };
    let (inertia, added, speed) = if rack {
        ("mass_kg", "added_mass_kg", "speed_m_s")
    } else {
        ("inertia_kgm2", "added_inertia_kgm2", "speed_rad_s")
    };
    let speed = match section.get(speed) {
        Some(s) => moving(&s, &mount)?,
        None => 0.0,
    };
    let bounded = |key: &str, least: &str, ok: &dyn Fn(f64) -> bool| match section.get(key) {
        None => Ok(None),
        Some(e) => match e.number()? {
            x if ok(x) => Ok(Some(x)),
            x => Err(e.error(
                format!("`{key}` is {x}, expected {least}"),
                format!("expected {least}"),
                "leave it out to take the default",
            )),
        },
    };
    let spec = GearSpec {
        name: name.to_owned(),
        body,
        material: section
            .get("material")
            .map_or(Ok(Material::STEEL), |e| material(&e))?,
        inertia: bounded(inertia, "more than zero", &|x| x > 0.0)?,
        added_inertia: bounded(added, "zero or more", &|x| x >= 0.0)?.unwrap_or(0.0),
        mount,
        position: [0.0; 2],
        facing: 0.0,
        speed,
        loads: section
            .get("loads")
            .map_or(Ok(Vec::new()), |e| profile::loads(&e, rack))?,
    };
    let position = section
        .get("position_m")
        .map(|e| e.fixed::<2>())
        .transpose()?;
    let facing = if rack {
        section.maybe_number("facing_deg")?.map(f64::to_radians)
    } else {
        None
    };
    Ok(GearDraft {
        spec,
        position,
        facing,
        place,
    })
}

/// An initial speed, which only a free hub has.
fn moving(entry: &Entry<'_>, mount: &Mount) -> Result<f64, SceneError> {
    let speed = entry.number()?;
    match mount {
        Mount::Driven(_) => Err(entry.error(
            format!(
                "`{}` stands beside a driven mount, which sets the speed",
                entry.name
            ),
            "remove this",
            "the motion stands in `mount = { driven = .. }`",
        )),
        Mount::Fixed if speed != 0.0 => Err(entry.error(
            format!("`{}` is {speed}, but the mount is fixed", entry.name),
            "remove this",
            "use the mount \"revolute\" (a rack: \"prismatic\") for a body that moves freely",
        )),
        _ => Ok(speed),
    }
}

fn read_gear(s: &Section<'_>, place: &Place) -> Result<Body, SceneError> {
    let default = GearParams::default();
    let params = GearParams {
        teeth: s.need("teeth")?.whole()?,
        module: s.number("module_m")?,
        pressure_angle: degrees(s, "pressure_angle_deg", default.pressure_angle)?,
        profile_shift: s.number_or("profile_shift", 0.0)?,
        helix_angle: degrees(s, "helix_angle_deg", 0.0)?,
        face_width: s.number("face_width_m")?,
        addendum: s.number_or("addendum_factor", default.addendum)?,
        dedendum: s.number_or("dedendum_factor", default.dedendum)?,
        tip_radius: s.number_or("tip_radius_factor", default.tip_radius)?,
        thinning: s.number_or("thinning_m", 0.0)?,
        bore_radius: s.number_or("bore_radius_m", 0.0)?,
        modifications: Modifications {
            tip_relief: s.get("tip_relief").map(|e| tip_relief(&e)).transpose()?,
            profile_crowning: s.number_or("profile_crowning_m", 0.0)?,
            lead_crowning: s.number_or("lead_crowning_m", 0.0)?,
        },
    };
    Gear::new(params)
        .map(Body::Gear)
        .map_err(|e| geometry(s, place, &e))
}

fn read_rack(s: &Section<'_>, place: &Place) -> Result<Body, SceneError> {
    let default = RackParams::default();
    let module = s.number("module_m")?;
    let params = RackParams {
        teeth: s.need("teeth")?.whole()?,
        module,
        pressure_angle: degrees(s, "pressure_angle_deg", default.pressure_angle)?,
        face_width: s.number("face_width_m")?,
        addendum: s.number_or("addendum_factor", default.addendum)?,
        dedendum: s.number_or("dedendum_factor", default.dedendum)?,
        tip_radius: s.number_or("tip_radius_factor", default.tip_radius)?,
        thinning: s.number_or("thinning_m", 0.0)?,
        body_height: s.number_or("body_height_m", 1.5 * module)?,
        helix_angle: degrees(s, "helix_angle_deg", 0.0)?,
    };
    Rack::new(params)
        .map(Body::Rack)
        .map_err(|e| geometry(s, place, &e))
}

/// An angle, degrees in the file and radians inside.
fn degrees(s: &Section<'_>, name: &str, default: f64) -> Result<f64, SceneError> {
    Ok(s.maybe_number(name)?.map_or(default, f64::to_radians))
}

fn tip_relief(entry: &Entry<'_>) -> Result<TipRelief, SceneError> {
    let s = entry.section("`tip_relief`", RELIEF)?;
    Ok(TipRelief {
        amount: s.number("amount_m")?,
        start_radius: s.number("start_radius_m")?,
        shape: match s.get("shape") {
            Some(e) => e.word(&[
                ("linear", ReliefShape::Linear),
                ("parabolic", ReliefShape::Parabolic),
            ])?,
            None => ReliefShape::Linear,
        },
    })
}

fn material(entry: &Entry<'_>) -> Result<Material, SceneError> {
    if !entry.is_table() {
        return entry.word(&[
            ("steel", Material::STEEL),
            ("steel-iso6336", Material::STEEL_ISO),
        ]);
    }
    let s = entry.section("`material`", ELASTIC)?;
    let material = Material {
        young: s.number("young_pa")?,
        poisson: s.number("poisson")?,
        density: s.number("density_kg_m3")?,
    };
    material.check().map_err(|e| {
        let key = match &e {
            StiffnessError::Material { property, .. } => match property {
                Property::Young => "young_pa",
                Property::Poisson => "poisson",
                Property::Density => "density_kg_m3",
            },
            _ => "young_pa",
        };
        match s.get(key) {
            Some(at) => at.error(
                e.to_string(),
                "this value",
                "steel has young_pa = 2.1e11, poisson = 0.3, density_kg_m3 = 7850",
            ),
            None => s.error(e.to_string(), "here", ""),
        }
    })?;
    Ok(material)
}
