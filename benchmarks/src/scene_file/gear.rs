//! The table `[gears.NAME]`: toothing, material, hub, mount, speed, loads.

mod params;

use super::deviations::{DeviationTable, deviations};
use super::error::SceneError;
use super::geometry::geometry;
use super::material::{MaterialChoice, material};
use super::measured::DataFiles;
use super::modifications::{EndReliefTable, MeasuredFlanks, PerSide, TopographyTable, topography};
use super::out_of_plane::{
    BearingTable, DirectionTable, MisalignmentTable, OutOfPlaneTable, Position, out_of_plane,
};
use super::plausibility::pressure_angle;
use super::profile::{GearLoad, GearMount, RackLoad, RackMount};
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::{Degrees, NotNegative, Positive, is_default};
use gearbench_models::Vec3;
use gearbench_models::geometry::{Gear, Rack, ReliefShape};
use gearbench_models::spec::{Body, GearSpec, Guide, Load, Mount, SpinTerms, UPRIGHT};
use serde::{Deserialize, Serialize};

/// Keys of a gear or of a rack.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename = "<kind=gear>", rename_all = "kebab-case")]
pub enum ToothedTable {
    /// A gear, external, internal or conical.
    Gear(Box<GearTable>),
    /// A rack.
    Rack(Box<RackTable>),
}

keys! {
    /// The table `[gears.NAME]` of a gear.
    #[derive(Default)]
    struct GearTable {
        /// number of teeth, for example 20
        teeth: u32,
        /// normal module in metres, for example 0.004
        module_m: f64,
        /// normal pressure angle in degrees, default 20
        pressure_angle_deg: Option<Degrees>,
        /// profile shift coefficient x, default 0
        #[serde(default, skip_serializing_if = "is_default")]
        profile_shift: f64,
        /// helix angle in degrees, right hand positive, default 0
        helix_angle_deg: Option<Degrees>,
        /// angle in degrees by whose tangent the profile shift, in metres, grows along the axis: a conical gear (beveloid), `profile_shift` being that of the middle of the face; default 0
        profile_shift_angle_deg: Option<Degrees>,
        /// angle of the tip cone of a conical gear in degrees, default the profile-shift angle; `addendum_factor` is that of the middle of the face
        tip_cone_angle_deg: Option<Degrees>,
        /// face width in metres, for example 0.01
        face_width_m: f64,
        /// addendum over module, default 1
        addendum_factor: Option<f64>,
        /// dedendum over module, default 1.25
        dedendum_factor: Option<f64>,
        /// tip radius of the tool over module, default 0.38, of the cutter of an internal gear 0.25
        tip_radius_factor: Option<f64>,
        /// reduction of the tooth thickness at the reference circle in metres, default 0
        #[serde(default, skip_serializing_if = "is_default")]
        thinning_m: f64,
        /// bore radius in metres, default 0 (solid: the elastic body then has a seat of half the root radius)
        #[serde(default, skip_serializing_if = "is_default")]
        bore_radius_m: f64,
        /// true for an internal gear (a ring gear): dedendum and tip radius factors are those of its cutter, a positive profile shift thickens its teeth and moves their tips inwards; default false
        #[serde(default, skip_serializing_if = "is_default")]
        internal: bool,
        /// teeth of the pinion-type cutter of an internal gear, default two fifths of those of the gear
        cutter_teeth: Option<u32>,
        /// profile shift coefficient of the cutter of an internal gear, default 0
        cutter_profile_shift: Option<f64>,
        /// tip radius of an internal gear in metres, in place of `addendum_factor`
        tip_circle_radius_m: Option<f64>,
        /// root radius of an internal gear in metres, in place of `dedendum_factor`
        root_circle_radius_m: Option<f64>,
        /// outer radius of the rim of an internal gear in metres, where its body is held; default three and a half modules over the root
        rim_radius_m: Option<f64>,
        /// { amount_m, start_radius_m, shape = "linear" or "parabolic" }
        tip_relief: Option<Box<ReliefTable>>,
        /// material removed at tip and root by profile crowning in metres, default 0
        #[serde(default, skip_serializing_if = "is_default")]
        profile_crowning_m: f64,
        /// material removed at both face ends by lead crowning in metres, default 0
        #[serde(default, skip_serializing_if = "is_default")]
        lead_crowning_m: f64,
        /// relief at the ends of the face: { low = { amount_m, length_m, shape = "linear" or "parabolic" }, high = { .. } }
        end_relief: Option<EndReliefTable>,
        /// material removed towards the upper end of the face (below 0 the lower one), growing linearly from the other, in metres: a number or { left, right }, default 0
        helix_slope_m: Option<PerSide>,
        /// how much more the tip has removed over the form circle at the upper end of the face than at the lower one, in metres: a number or { left, right }, default 0
        twist_m: Option<PerSide>,
        /// measured flanks on a grid: { both = "flank.csv", unit_m = 1e-6 }, or left and right as lists of rows
        topography: Option<Box<TopographyTable>>,
        /// deviations of single teeth: { class = 6, seed = 1 } of ISO 1328-1, or measured
        deviations: Option<Box<DeviationTable>>,
        /// "steel" (default), "steel-iso6336", or { young_pa, poisson, density_kg_m3 }
        #[serde(default, skip_serializing_if = "is_default")]
        material: MaterialChoice,
        /// inertia about the axis in kg m^2; left out, that of the toothing
        inertia_kgm2: Option<Positive>,
        /// inertia added at the hub in kg m^2, default 0
        added_inertia_kgm2: Option<NotNegative>,
        /// "revolute" (default), "fixed", { driven = { speed_rad_s = 100.0 } }, or { guided = { stiffness_nm_per_rad, damping_nms_per_rad, friction_nm, stick_rad } }
        #[serde(default, skip_serializing_if = "is_default")]
        mount: GearMount,
        /// [x, y] of the axis, or [x, y, z] of the middle of the face width on it, in metres; left out, the mesh places the gear
        position_m: Option<Position>,
        /// direction of the axis, default [0, 0, 1]
        axis: Option<[f64; 3]>,
        /// small tilt of the axis, for example { plane_of_action = 0.03 }
        misalignment_deg: Option<MisalignmentTable>,
        /// mass in kg, for hubs that move sideways; left out, that of the toothing
        mass_kg: Option<Positive>,
        /// mass added in kg, for hubs that move sideways, default 0
        added_mass_kg: Option<NotNegative>,
        /// springs and dampers to the ground that let the hub move in its other directions, for example { stiffness = [1e8, 1e8, 5e7, 1e5, 1e5, 0.0] }
        bearing: Option<BearingTable>,
        /// directions of the hub that are held, free or driven, for example { z = "held" }
        directions: Option<DirectionTable>,
        /// centre of mass from the hub in its axes at the start in metres, default [0, 0, 0]
        centre_of_mass_m: Option<[f64; 3]>,
        /// inertia tensor about the centre of mass in the axes of the hub at the start, three rows of three; left out, that of a round body
        inertia_tensor_kgm2: Option<[[f64; 3]; 3]>,
        /// gyroscopic, centrifugal and Coriolis terms: "auto" (default: where the speed is more than a thousandth of the lowest tilting frequency), "on" or "off"
        spin_terms: Option<SpinTerms>,
        /// initial angular velocity in rad/s, counter-clockwise positive, default 0
        speed_rad_s: Option<f64>,
        /// list of loads, for example [{ torque_nm = 10.0 }]
        loads: Option<Vec<GearLoad>>,
    }

    /// The table `[gears.NAME]` of a rack, with `kind = "rack"`.
    #[derive(Default)]
    struct RackTable {
        /// number of teeth, for example 20
        teeth: u32,
        /// normal module in metres, for example 0.004
        module_m: f64,
        /// normal pressure angle in degrees, default 20
        pressure_angle_deg: Option<Degrees>,
        /// helix angle in degrees, right hand positive, default 0
        helix_angle_deg: Option<Degrees>,
        /// face width in metres, for example 0.01
        face_width_m: f64,
        /// addendum over module, default 1
        addendum_factor: Option<f64>,
        /// dedendum over module, default 1.25
        dedendum_factor: Option<f64>,
        /// tip radius of the rack tool over module, default 0.38
        tip_radius_factor: Option<f64>,
        /// reduction of the tooth thickness at the reference circle in metres, default 0
        #[serde(default, skip_serializing_if = "is_default")]
        thinning_m: f64,
        /// height of the body below the root line in metres, default one and a half modules
        body_height_m: Option<f64>,
        /// "steel" (default), "steel-iso6336", or { young_pa, poisson, density_kg_m3 }
        #[serde(default, skip_serializing_if = "is_default")]
        material: MaterialChoice,
        /// mass in kg; left out, that of the toothed body
        mass_kg: Option<Positive>,
        /// mass added in kg, default 0
        added_mass_kg: Option<NotNegative>,
        /// "prismatic" (default), "fixed", { driven = { speed_m_s = 1.0 } }, or { guided = { stiffness_n_per_m, damping_ns_per_m, friction_n, stick_m } }
        #[serde(default, skip_serializing_if = "is_default")]
        mount: RackMount,
        /// [x, y], or [x, y, z], of the middle of its reference line in metres; left out, the mesh places the rack
        position_m: Option<Position>,
        /// springs and dampers to the ground that let the hub move in its other directions, for example { stiffness = [1e8, 1e8, 5e7, 1e5, 1e5, 0.0] }
        bearing: Option<BearingTable>,
        /// directions of the hub that are held, free or driven, for example { z = "held" }
        directions: Option<DirectionTable>,
        /// centre of mass from the hub in its axes at the start in metres, default [0, 0, 0]
        centre_of_mass_m: Option<[f64; 3]>,
        /// inertia tensor about the centre of mass in the axes of the hub at the start, three rows of three; left out, that of a round body
        inertia_tensor_kgm2: Option<[[f64; 3]; 3]>,
        /// gyroscopic, centrifugal and Coriolis terms: "auto" (default: where the speed is more than a thousandth of the lowest tilting frequency), "on" or "off"
        spin_terms: Option<SpinTerms>,
        /// direction from the body to the teeth in degrees; left out, towards the gear
        facing_deg: Option<Degrees>,
        /// initial speed in m/s, positive as the pitch line of a gear in front of its teeth that turns counter-clockwise, default 0
        speed_m_s: Option<f64>,
        /// list of loads, for example [{ force_n = 10.0 }]
        loads: Option<Vec<RackLoad>>,
    }

    /// Tip relief of a gear.
    struct ReliefTable {
        /// material removed at the tip, normal to the flank, in metres
        amount_m: f64,
        /// radius at which the relief starts in metres
        start_radius_m: f64,
        /// "linear" (default) or "parabolic"
        shape: Option<ReliefShape>,
    }
}

/// A gear of the file before the meshes determine its position.
#[derive(Clone, Debug)]
pub(super) struct GearDraft {
    pub(super) spec: GearSpec,
    /// Position given in the file.
    pub(super) position: Option<[f64; 3]>,
    /// Direction of the axis given in the file.
    pub(super) axis: Option<Vec3>,
    /// Misalignment given in the file.
    pub(super) misalignment: Option<MisalignmentTable>,
    /// Facing of a rack given in the file [rad].
    pub(super) facing: Option<f64>,
}

/// Keys that gears and racks share: mount, speed, inertia, position, loads.
struct Hub {
    mount: (Mount, Option<Guide>),
    /// Key of the initial speed, and its value.
    speed: (&'static str, Option<f64>),
    inertia: Option<Positive>,
    added_inertia: Option<NotNegative>,
    material: MaterialChoice,
    position: Option<Position>,
    axis: Option<[f64; 3]>,
    misalignment: Option<MisalignmentTable>,
    facing: Option<Degrees>,
    lateral: OutOfPlaneTable,
    /// Index of the own motion among the six directions of the hub.
    own: usize,
    loads: Vec<Load>,
}

/// Checks the name of a gear, which is also part of the names of columns and FMU variables.
pub(super) fn check_name(name: &str, at: &Place<'_>) -> Result<(), SceneError> {
    if !name.trim().is_empty() && name.len() <= 60 && !name.chars().any(char::is_control) {
        return Ok(());
    }
    at.refuse(
        format!("the gear has the name {name:?}, which cannot be part of a column name"),
        "not a valid name",
        "give 1 to 60 characters, for example [gears.pinion]",
    )
}

/// Reads the loads of a member; `read` reads one at its place.
pub(super) fn loads<L>(
    list: Option<Vec<L>>,
    read: impl Fn(L, &Place<'_>) -> Result<Load, SceneError>,
    at: &Place<'_>,
) -> Result<Vec<Load>, SceneError> {
    let all = list.into_iter().flatten().enumerate();
    all.map(|(i, load)| read(load, &at.key("loads").member(i)))
        .collect()
}

/// Checks and builds one gear or rack.
pub(super) fn gear(
    name: &str,
    keys: ToothedTable,
    files: &DataFiles<'_>,
    at: &Place<'_>,
) -> Result<GearDraft, SceneError> {
    let angle = match &keys {
        ToothedTable::Gear(keys) => keys.pressure_angle_deg,
        ToothedTable::Rack(keys) => keys.pressure_angle_deg,
    };
    if let Some(angle) = angle {
        pressure_angle(angle.radians(), at)?;
    }
    if let ToothedTable::Gear(keys) = &keys
        && !keys.internal
    {
        let of_ring = [
            "cutter_teeth",
            "cutter_profile_shift",
            "tip_circle_radius_m",
            "root_circle_radius_m",
            "rim_radius_m",
        ];
        if let Some(key) = of_ring.iter().find(|key| at.has(key)) {
            return at.key(key).refuse(
                format!("`{key}` is a key of internal gears"),
                "this gear is external",
                "add `internal = true`, or leave it out",
            );
        }
    }
    let measured = match &keys {
        ToothedTable::Gear(keys) => {
            topography(keys.topography.as_deref(), files, &at.key("topography"))?
        }
        ToothedTable::Rack(_) => MeasuredFlanks::default(),
    };
    let body = match &keys {
        ToothedTable::Gear(keys) => {
            let deviations = deviations(name, keys.deviations.as_deref(), &at.key("deviations"))?;
            Gear::new(keys.params(deviations, measured)).map(Body::Gear)
        }
        ToothedTable::Rack(keys) => Rack::new(keys.params()).map(Body::Rack),
    };
    let body = body.map_err(|e| geometry(at, &e))?;
    let hub = match keys {
        ToothedTable::Gear(keys) => Hub {
            mount: keys.mount.parts(files, &at.key("mount"))?,
            speed: ("speed_rad_s", keys.speed_rad_s),
            inertia: keys.inertia_kgm2,
            added_inertia: keys.added_inertia_kgm2,
            material: keys.material,
            position: keys.position_m,
            axis: keys.axis,
            misalignment: keys.misalignment_deg,
            facing: None,
            lateral: OutOfPlaneTable {
                bearing: keys.bearing,
                directions: keys.directions,
                mass: keys.mass_kg,
                added_mass: keys.added_mass_kg,
                inertia: keys.inertia_tensor_kgm2,
                centre_of_mass: keys.centre_of_mass_m,
                spin: keys.spin_terms,
            },
            own: 5,
            loads: loads(keys.loads, |load, place| load.load(files, place), at)?,
        },
        ToothedTable::Rack(keys) => Hub {
            mount: keys.mount.parts(files, &at.key("mount"))?,
            speed: ("speed_m_s", keys.speed_m_s),
            inertia: keys.mass_kg,
            added_inertia: keys.added_mass_kg,
            material: keys.material,
            position: keys.position_m,
            axis: None,
            misalignment: None,
            facing: keys.facing_deg,
            lateral: OutOfPlaneTable {
                bearing: keys.bearing,
                directions: keys.directions,
                mass: keys.mass_kg,
                added_mass: keys.added_mass_kg,
                inertia: keys.inertia_tensor_kgm2,
                centre_of_mass: keys.centre_of_mass_m,
                spin: keys.spin_terms,
            },
            own: 0,
            loads: loads(keys.loads, |load, place| load.load(files, place), at)?,
        },
    };
    let (key, speed) = hub.speed;
    Ok(GearDraft {
        position: hub.position.map(|p| p.0),
        misalignment: hub.misalignment,
        axis: axis(hub.axis, &at.key("axis"))?,
        facing: hub.facing.map(Degrees::radians),
        spec: GearSpec {
            name: name.to_owned(),
            body,
            material: material(&hub.material, &at.key("material"))?,
            inertia: hub.inertia.map(f64::from),
            added_inertia: hub.added_inertia.map_or(0.0, f64::from),
            speed: initial_speed(speed, &hub.mount.0, key, at)?,
            mount: hub.mount.0,
            guide: hub.mount.1,
            lateral: out_of_plane(hub.lateral, hub.own, files, at)?,
            position: [0.0; 3],
            axes: UPRIGHT,
            facing: 0.0,
            loads: hub.loads,
        },
    })
}

/// Normalises a given axis; refuses the zero vector.
fn axis(given: Option<[f64; 3]>, at: &Place<'_>) -> Result<Option<Vec3>, SceneError> {
    let Some(given) = given else {
        return Ok(None);
    };
    let length = Vec3::from(given).norm();
    if !(length.is_finite() && length > 0.0) {
        return at.refuse(
            "the direction of the axis is zero",
            "no direction",
            "give a vector such as [0.0, 0.0, 1.0]",
        );
    }
    Ok(Some(Vec3::from(given) / length))
}

/// Reads an initial speed, which only a free hub has.
pub(super) fn initial_speed(
    speed: Option<f64>,
    mount: &Mount,
    key: &str,
    at: &Place<'_>,
) -> Result<f64, SceneError> {
    match (speed, mount) {
        (Some(_), Mount::Driven(_)) => at.key(key).refuse(
            format!("`{key}` is given, but the driven mount prescribes the speed"),
            "remove this",
            "give the motion in `mount = { driven = .. }`",
        ),
        (Some(speed), Mount::Fixed) if speed != 0.0 => at.key(key).refuse(
            format!("`{key}` is {speed}, but the mount is fixed"),
            "remove this",
            "use the mount \"revolute\" (a rack: \"prismatic\") for a body that moves freely",
        ),
        (speed, _) => Ok(speed.unwrap_or(0.0)),
    }
}
