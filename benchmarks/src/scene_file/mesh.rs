//! The list `[[meshes]]`: pairs of gears, distance and start. It determines the positions of the gears.
//!
//! A gear without `position_m` is placed by its first mesh: at `centre_distance_m`, or at the distance that gives the
//! normal backlash `backlash_m`, in the direction `direction_deg` from its mate. The first gear of the first mesh is at
//! the origin unless the file gives its position. Gears of one shaft are on one axis, at their distances on the shaft.

use super::error::SceneError;
use super::gear::GearDraft;
use super::geometry::keys_of;
use super::out_of_plane::{MisalignmentTable, misaligned};
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::{Degrees, GearName, Positive, is_default};
use super::shaft::{ShaftGears, place_by_shaft};
use gearbench_models::Vec3;
use gearbench_models::error::Reason;
use gearbench_models::geometry::{Gear, GeometryError, Pair, Rack, Side};
use gearbench_models::spec::{
    Body, Freedom, GearSpec, MeshSpec, SceneSpec, Start, UPRIGHT, check_axes as check_spec_axes,
    is_internal, layout_axes, mesh_layout, pair_of as at_positions, turned_to,
};

keys! {
    /// A pair of meshing gears.
    #[derive(Default)]
    struct MeshTable {
        /// the two names, for example ["pinion", "wheel"]; a rack comes second
        gears: [GearName; 2],
        /// distance of the axes (to the reference line of a rack) in metres
        centre_distance_m: Option<Positive>,
        /// normal backlash in metres, from which the centre distance follows
        backlash_m: Option<f64>,
        /// direction from the first gear to the second in degrees, default 0
        direction_deg: Option<Degrees>,
        /// { flank = "left" or "right", gap_m, path_coordinate_m, loaded = true }
        start: Option<StartTable>,
    }

    /// The start of a mesh.
    #[derive(Default)]
    struct StartTable {
        /// "left" (default; drives when the first gear turns counter-clockwise) or "right"
        flank: Option<Side>,
        /// gap of that flank along its normal in metres, default 0
        #[serde(default, skip_serializing_if = "is_default")]
        gap_m: f64,
        /// path coordinate of the pair from the first gear's tangent point in metres; left out, the pitch point
        path_coordinate_m: Option<f64>,
        /// true: the whole scene starts in the equilibrium of its loads, default false
        #[serde(default, skip_serializing_if = "is_default")]
        loaded: bool,
    }
}

/// Checks all meshes and sets the positions of the gears.
pub(super) fn meshes(
    list: &[MeshTable],
    gears: &mut [GearDraft],
    shafts: &[ShaftGears],
    root: &Place<'_>,
) -> Result<Vec<MeshSpec>, SceneError> {
    direct(gears);
    let mut meshes: Vec<MeshSpec> = Vec::new();
    let mut placed: Vec<bool> = gears.iter().map(|g| g.position.is_some()).collect();
    let mut seen = vec![false; gears.len()];
    let all = root.key("meshes");
    for (i, keys) in list.iter().enumerate() {
        let at = all.member(i);
        let pair = pair_of(keys, gears, &at.key("gears"))?;
        let same = |m: &MeshSpec| m.gears == pair || m.gears == [pair[1], pair[0]];
        if let Some(other) = meshes.iter().position(same) {
            return Err(at.key("gears").against(
                (&all.member(other).key("gears"), "first here"),
                "these two gears have two meshes",
                "again here",
                "remove one of the two meshes",
            ));
        }
        place_by_shaft(shafts, gears, &mut placed, pair);
        place_gears(keys, gears, pair, &mut placed, &at)?;
        let built = pair_at(&gears[pair[0]], &gears[pair[1]], &at)?;
        let again = pair.map(|i| std::mem::replace(&mut seen[i], true));
        if keys.start.is_some() && again == [true; 2] {
            return at.key("start").refuse(
                "earlier meshes already determine the angles of both gears",
                "conflicting start",
                "remove `start` here; the mesh closes a loop, and the other meshes determine its start",
            );
        }
        meshes.push(MeshSpec {
            gears: pair,
            start: start_of(keys.start.as_ref(), &built, &at.key("start"))?,
        });
    }
    match seen.iter().position(|s| !s) {
        None => Ok(meshes),
        Some(i) => {
            let name = &gears[i].spec.name;
            root.key("gears").key(name).refuse(
                format!("gear `{name}` is in no mesh"),
                "this gear",
                format!("add a [[meshes]] with `{name}`, or remove the gear"),
            )
        }
    }
}

/// Sets missing axes of gears to the axis of the first gear that has one.
fn direct(gears: &mut [GearDraft]) {
    let Some(common) = gears.iter().find_map(|g| g.axis) else {
        return;
    };
    let upright = turned_to(&UPRIGHT, &common);
    for gear in gears {
        if !matches!(gear.spec.body, Body::Rack(_)) {
            gear.spec.axes = turned_to(&upright, &gear.axis.unwrap_or(common));
        }
    }
}

/// Indices of the two gears of a mesh.
fn pair_of(
    keys: &MeshTable,
    gears: &[GearDraft],
    at: &Place<'_>,
) -> Result<[usize; 2], SceneError> {
    let [one, two] = &keys.gears;
    let index = |name: &GearName| gears.iter().position(|g| g.spec.name == name.0);
    // Other names are refused when they are read.
    let pair = [one, two].map(|name| index(name).unwrap_or_default());
    if pair[0] == pair[1] {
        return at.refuse(
            "a gear cannot mesh with itself",
            "the same gear twice",
            "name two gears",
        );
    }
    if let [Body::Rack(_), second] = pair.map(|i| &gears[i].spec.body) {
        let way_out = match second {
            Body::Gear(_) => format!("write gears = [\"{}\", \"{}\"]", two.0, one.0),
            Body::Rack(_) => "two racks cannot mesh; one of them has to be a gear".to_owned(),
        };
        let message = "the first gear of a mesh must not be a rack";
        return at.member(0).refuse(message, "a rack", way_out);
    }
    Ok(pair)
}

/// Sets the positions of gears that have none.
fn place_gears(
    keys: &MeshTable,
    gears: &mut [GearDraft],
    [a, b]: [usize; 2],
    placed: &mut [bool],
    at: &Place<'_>,
) -> Result<(), SceneError> {
    if !placed[a] && !placed[b] {
        placed[a] = true;
        gears[a].position = Some([0.0; 3]);
    }
    if placed[a] && placed[b] {
        let places = ["centre_distance_m", "backlash_m", "direction_deg"];
        if let Some(key) = places.into_iter().find(|key| at.has(key)) {
            let all = at.root().key("gears");
            let own = [b, a].map(|i| &gears[i].spec.name);
            let own = own.into_iter().find(|name| all.key(name).has("position_m"));
            return at.key(key).refuse(
                format!("`{key}` is given, but the positions of both gears are known"),
                "too much",
                match own {
                    Some(name) => format!("remove it, or remove `position_m` of `{name}`"),
                    None => {
                        "remove it: earlier meshes determine the positions of both gears, and this mesh closes a loop"
                            .into()
                    }
                },
            );
        }
        let (pa, pb) = (
            gears[a].position.unwrap_or_default(),
            gears[b].position.unwrap_or_default(),
        );
        let [x, y, _] = in_axes(&layout_axes(&gears[a].spec, &gears[b].spec), pa, pb);
        set_facing(&mut gears[b], y.atan2(x));
        return Ok(());
    }
    let distance = match (keys.centre_distance_m, keys.backlash_m) {
        (Some(distance), None) => distance.0,
        (None, Some(_)) if [a, b].iter().any(|i| is_conical(&gears[*i].spec.body)) => {
            return at.key("backlash_m").refuse(
                "the backlash of conical gears does not determine their positions",
                "no position follows from this",
                "give `centre_distance_m` for parallel axes, or `position_m` and `axis` of the gears",
            );
        }
        (None, Some(backlash)) => for_backlash(&gears[a].spec.body, &gears[b].spec.body, backlash)
            .map_err(|e| refusal(&gears[a], &gears[b], &e, at))?,
        (Some(_), Some(_)) => {
            return Err(at.key("backlash_m").against(
                (&at.key("centre_distance_m"), "this"),
                "centre distance and backlash are both given",
                "and this",
                "remove one of them: it follows from the other",
            ));
        }
        (None, None) => {
            return at.refuse(
                format!("the position of `{}` is not given", gears[b].spec.name),
                "in this mesh",
                match gears.iter().find(|g| g.position == Some([0.0; 3])) {
                    Some(first) if is_internal(&gears[b].spec.body) => format!(
                        "add `position_m = [0.0, 0.0]` to `{}` if it is on the axis of `{}`, else `centre_distance_m` or \
                         `backlash_m` here",
                        gears[b].spec.name, first.spec.name
                    ),
                    _ => "add `centre_distance_m` or `backlash_m` here, or `position_m = [x, y]` of the gear"
                        .to_owned(),
                },
            );
        }
    };
    let direction = keys.direction_deg.map_or(0.0, Degrees::radians);
    let (known, new, sign) = if placed[a] { (a, b, 1.0) } else { (b, a, -1.0) };
    let from = gears[known].position.unwrap_or_default();
    let [x, y, _] = gears[known].spec.axes;
    let to = sign * distance * (direction.cos() * x + direction.sin() * y);
    gears[new].position = Some([0, 1, 2].map(|k| from[k] + to[k]));
    placed[new] = true;
    set_facing(&mut gears[b], direction);
    Ok(())
}

fn is_conical(body: &Body) -> bool {
    matches!(body, Body::Gear(gear) if gear.is_conical())
}

/// Components of the vector from one position to another in a set of axes.
fn in_axes(axes: &[Vec3; 3], from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    axes.map(|axis| axis.dot(&(Vec3::from(to) - Vec3::from(from))))
}

/// Turns a rack towards its gear, unless the file sets its direction.
fn set_facing(second: &mut GearDraft, direction: f64) {
    second.spec.facing = second.facing.unwrap_or(direction + std::f64::consts::PI);
}

/// Centre distance of a pair for a normal backlash [m].
fn for_backlash(a: &Body, b: &Body, backlash: f64) -> Result<f64, GeometryError> {
    match (a, b) {
        (Body::Gear(a), Body::Gear(b)) => {
            // The circumferential backlash that belongs to a normal one depends on the working pressure
            // angle, and so on the distance: a contraction, since backlash moves that angle little.
            let mut alpha = a.transverse_pressure_angle();
            let mut distance = 0.0;
            for _ in 0..50 {
                let circumferential = backlash / (alpha.cos() * a.base_helix_angle().cos());
                distance = Pair::centre_distance_for_backlash(a, b, circumferential)?;
                let base_sum = a.sign() * a.r_base() + b.sign() * b.r_base();
                alpha = (base_sum.abs() / distance).min(1.0).acos();
            }
            Ok(distance)
        }
        (Body::Gear(gear), Body::Rack(rack)) => Ok(rack_distance(gear, rack, backlash)),
        // A rack as the first gear is refused before.
        (Body::Rack(_), _) => Ok(f64::NAN),
    }
}

/// Every metre that a rack is moved away opens both flanks by `sin(alpha_t)` in the transverse plane; at the
/// nominal distance `r + x m` the backlash is the thinning of both.
fn rack_distance(gear: &Gear, rack: &Rack, backlash: f64) -> f64 {
    let alpha = gear.transverse_pressure_angle();
    let nominal = gear.r_reference() + gear.params().profile_shift * gear.params().module;
    let thinned = (gear.params().thinning + rack.params().thinning) * alpha.cos();
    nominal + (backlash / gear.base_helix_angle().cos() - thinned) / (2.0 * alpha.sin())
}

/// The pair of gears at their positions.
fn pair_at(a: &GearDraft, b: &GearDraft, at: &Place<'_>) -> Result<Pair, SceneError> {
    let [one, two] = [a, b].map(|g| GearSpec {
        position: g.position.unwrap_or_default(),
        ..g.spec.clone()
    });
    at_positions(&one, &two).map_err(|e| refusal(a, b, &e, at))
}

/// The error of a pair: at the two keys that disagree, or at the key that sets the distance.
fn refusal(a: &GearDraft, b: &GearDraft, e: &GeometryError, at: &Place<'_>) -> SceneError {
    let Reason { cause, help } = e.reason();
    // The geometry counts the gears of a pair, the scene names them.
    let own = |text: &str| {
        text.replace("gear 1", &format!("`{}`", a.spec.name))
            .replace("gear 2", &format!("`{}`", b.spec.name))
            .replace("the rack", &format!("`{}`", b.spec.name))
    };
    let message = format!("`{}` and `{}`: {}", a.spec.name, b.spec.name, own(&cause));
    let help = match e {
        GeometryError::Interference {
            tip_of, reduce_by, ..
        } => {
            let of = if *tip_of == "gear 1" { a } else { b };
            shorter_addendum(of, *reduce_by)
        }
        _ => own(&help),
    };
    let [a, b] = [a, b].map(|g| at.root().key("gears").key(&g.spec.name));
    if matches!(e, GeometryError::CrossedAxes { .. }) {
        let given = [&b, &a].into_iter().find(|g| g.has("axis"));
        let place = given.map_or_else(|| b.clone(), |g| g.key("axis"));
        return place.error(message, "does not mesh", help);
    }
    if matches!(
        e,
        GeometryError::UnequalModules { .. }
            | GeometryError::UnequalPressureAngles { .. }
            | GeometryError::HelixMismatch { .. }
    ) {
        let other = (&a.first(keys_of(e)), "differs from this one");
        return (b.first(keys_of(e))).against(other, message, "this one", help);
    }
    let own = ["centre_distance_m", "backlash_m"];
    let cause = if !own.iter().any(|key| at.has(key)) && b.has("position_m") {
        b.key("position_m")
    } else {
        at.first(&["centre_distance_m", "backlash_m", "gears"])
    };
    cause.error(message, "does not mesh", help)
}

/// Key and value that shorten the addendum of a gear by a length [m].
fn shorter_addendum(gear: &GearDraft, reduce_by: f64) -> String {
    let (addendum, module) = match &gear.spec.body {
        Body::Gear(g) => (g.params().addendum, g.params().module),
        Body::Rack(r) => (r.params().addendum, r.params().module),
    };
    let name = &gear.spec.name;
    let factor = ((addendum - reduce_by.abs() / module) * 1e4).floor() * 1e-4;
    let other = "change profile shift or distance";
    match factor > 0.0 {
        true => format!(
            "give `{name}` addendum_factor = {factor:.4}, now {addendum} ({:.3e} m less), or {other}",
            reduce_by.abs()
        ),
        false => other.to_owned(),
    }
}

fn start_of(keys: Option<&StartTable>, pair: &Pair, at: &Place<'_>) -> Result<Start, SceneError> {
    let side = keys.and_then(|k| k.flank).unwrap_or(Side::Left);
    let gap = keys.map_or(0.0, |k| k.gap_m);
    let path_coordinate = keys.and_then(|k| k.path_coordinate_m);
    let backlash = pair.backlash_normal();
    if at.has("gap_m") && gap > backlash * (1.0 + 1e-9) {
        return at.key("gap_m").refuse(
            format!("the gap {gap:.4e} m is larger than the normal backlash {backlash:.4e} m"),
            "the opposite flanks would overlap",
            "use a smaller gap, a larger centre distance or thinner teeth",
        );
    }
    let [start, end] = [pair.s_start(), pair.s_end()];
    match path_coordinate {
        Some(x) if !(start..=end).contains(&x) => at.key("path_coordinate_m").refuse(
            format!("the path coordinate {x:.6e} m lies outside the path of contact"),
            format!("expected {start:.6e} to {end:.6e} m"),
            "remove it to start at the pitch point",
        ),
        _ => Ok(Start {
            side,
            gap,
            path_coordinate,
            loaded: keys.is_some_and(|k| k.loaded),
        }),
    }
}

/// Tilts the axes of gears by their misalignments, each in the plane of action of its first mesh.
pub(super) fn misalign<'k>(
    spec: &mut SceneSpec,
    misalignments: impl Iterator<Item = Option<&'k MisalignmentTable>>,
    at: &Place<'_>,
) -> Result<(), SceneError> {
    let mut axes: Vec<Vec3> = spec.gears.iter().map(|g| g.axes[2]).collect();
    for (i, keys) in misalignments.enumerate() {
        let Some(keys) = keys else { continue };
        let name = &spec.gears[i].name;
        let at = at.key(name).key("misalignment_deg");
        let mesh = spec.meshes.iter().find(|m| m.gears.contains(&i));
        let layout = mesh.map(|m| mesh_layout(&spec.gears[m.gears[0]], &spec.gears[m.gears[1]]));
        let (Some(mesh), Some(Ok(layout))) = (mesh, layout) else {
            return at.refuse(
                "no mesh determines the direction of the axis",
                "this",
                "give the direction as `axis`",
            );
        };
        let angle = layout.direction + std::f64::consts::FRAC_PI_2 - layout.working_pressure_angle;
        let [x, y, _] = layout_axes(&spec.gears[mesh.gears[0]], &spec.gears[mesh.gears[1]]);
        let line = angle.cos() * x + angle.sin() * y;
        let towards = if mesh.gears[0] == i { line } else { -line };
        axes[i] = misaligned(axes[i], towards, keys, &at)?;
    }
    for (gear, axis) in spec.gears.iter_mut().zip(axes) {
        gear.axes = turned_to(&gear.axes, &axis);
    }
    Ok(())
}

/// Number of times at which driven tilts are checked over a simulation.
const TILT_SAMPLES: usize = 1000;

/// Axis of a gear at a time, with prescribed tilts; free directions follow the bearings.
fn axis_at(gear: &GearSpec, t: f64) -> Vec3 {
    let turned = |i: usize| match gear.lateral.as_deref().map(|l| &l.directions[i]) {
        Some(Freedom::Driven(speed)) => speed.integral(t),
        _ => 0.0,
    };
    let [x, y, z] = gear.axes;
    nalgebra::Rotation3::new(x * turned(3) + y * turned(4)) * z
}

/// Refuses cylindrical gears in mesh whose axes cross, from the start or by prescribed tilts within `duration` [s].
pub(super) fn check_axes(
    spec: &SceneSpec,
    duration: f64,
    at: &Place<'_>,
) -> Result<(), SceneError> {
    for mesh in &spec.meshes {
        let gears = mesh.gears.map(|i| &spec.gears[i]);
        let tilts = |g: &&GearSpec| {
            let driven = |d: &Freedom| matches!(d, Freedom::Driven(_));
            (g.lateral.as_deref()).is_some_and(|l| l.directions[3..5].iter().any(driven))
        };
        let samples = if gears.iter().any(tilts) {
            TILT_SAMPLES
        } else {
            0
        };
        for i in 0..=samples {
            let t = duration * i as f64 / samples.max(1) as f64;
            let [one, two] = gears.map(|g| axis_at(g, t));
            let Err(e) = check_spec_axes(gears.map(|g| &g.body), [&one, &two]) else {
                continue;
            };
            let Reason { cause, help } = e.reason();
            let names = gears.map(|g| at.key(&g.name));
            let keys: &[&str] = match i {
                0 => &["misalignment_deg", "axis"],
                _ => &["directions"],
            };
            let found = [1, 0].into_iter().find_map(|k| {
                let given = keys.iter().find(|key| names[k].has(key))?;
                Some(names[k].key(given))
            });
            let place = found.unwrap_or_else(|| names[1].clone());
            let when = match i {
                0 => String::new(),
                _ => format!(" at t = {t:.4e} s, by driven tilts"),
            };
            return place.refuse(
                format!("`{}` and `{}`: {cause}{when}", gears[0].name, gears[1].name),
                "does not mesh",
                help,
            );
        }
    }
    Ok(())
}
