//! `[[meshes]]`: which gears mesh, at which distance, and where they start. Places the gears.
//!
//! A gear without `position_m` is placed by its first mesh: at `centre_distance_m`, or at the distance that
//! leaves the normal backlash `backlash_m`, in the direction `direction_deg` from its mate. The first gear
//! of the first mesh stands at the origin unless it says otherwise.

use super::error::{SceneError, Source};
use super::gear::{GearDraft, Place};
use super::geometry::keys_of;
use super::reader::{Entry, Key, Section, key};
use super::suggest;
use gearbench_models::error::Reason;
use gearbench_models::geometry::{Gear, GeometryError, Pair, Rack, Side};
use gearbench_models::spec::{Body, MeshSpec, Start};

pub(super) static MESH: &[Key] = &[
    key(
        "gears",
        "the two names, for example [\"pinion\", \"wheel\"]; a rack comes second",
    ),
    key(
        "start",
        "{ flank = \"left\" or \"right\", gap_m, path_coordinate_m }",
    ),
    key(
        "centre_distance_m",
        "distance of the axes (to the reference line of a rack) in metres",
    ),
    key(
        "backlash_m",
        "normal backlash in metres, from which the centre distance follows",
    ),
    key(
        "direction_deg",
        "direction from the first gear to the second in degrees, default 0",
    ),
];

pub(super) static START: &[Key] = &[
    key(
        "flank",
        "\"left\" (default; drives when the first gear turns counter-clockwise) or \"right\"",
    ),
    key(
        "gap_m",
        "gap of that flank along the line of action in metres, default 0",
    ),
    key(
        "path_coordinate_m",
        "path coordinate of the pair from the first gear's tangent point in metres; left out, the pitch point",
    ),
];

/// A mesh as read, with its place in the file.
#[derive(Clone, Debug)]
pub(super) struct MeshDraft {
    pub(super) spec: MeshSpec,
    pub(super) place: Place,
    /// Place of the start, if it is given.
    pub(super) start: Option<Place>,
}

/// Path of contact and backlash, which a start must respect.
struct Path {
    ends: [f64; 2],
    backlash: f64,
}

/// Reads all meshes and places the gears.
pub(super) fn meshes(
    list: &[Entry<'_>],
    gears: &mut [GearDraft],
) -> Result<Vec<MeshDraft>, SceneError> {
    let mut drafts: Vec<MeshDraft> = Vec::new();
    let mut placed: Vec<bool> = gears.iter().map(|g| g.position.is_some()).collect();
    let mut seen = vec![false; gears.len()];
    for entry in list {
        let section = entry.section("[[meshes]]", MESH)?;
        let place = Place::of(entry)?;
        let pair = pair_of(&section, gears)?;
        if let Some(other) = drafts
            .iter()
            .find(|d| d.spec.gears == pair || d.spec.gears == [pair[1], pair[0]])
        {
            return Err(section
                .source
                .error(
                    place.first(&["gears"]),
                    "these two gears mesh twice",
                    "again here",
                    "remove one of the two meshes",
                )
                .and(other.place.first(&["gears"]), "first here"));
        }
        put(&section, &place, gears, pair, &mut placed)?;
        let path = path_of(section.source, &place, &gears[pair[0]], &gears[pair[1]])?;
        let [again_a, again_b] = pair.map(|i| std::mem::replace(&mut seen[i], true));
        let start = section.get("start");
        if let (Some(start), true, true) = (start, again_a, again_b) {
            return Err(start.error(
                "both gears have their angle from earlier meshes",
                "this start cannot be met",
                "remove `start` here; the mesh closes a loop and starts where the others put it",
            ));
        }
        drafts.push(MeshDraft {
            spec: MeshSpec {
                gears: pair,
                start: start_of(start, &path)?,
            },
            start: start.map(|s| Place::of(&s)).transpose()?,
            place,
        });
    }
    if let Some(i) = seen.iter().position(|s| !s)
        && let Some(first) = list.first()
    {
        let name = &gears[i].spec.name;
        return Err(first.source().error(
            gears[i].place.header.clone(),
            format!("gear `{name}` takes part in no mesh"),
            "this gear",
            format!("add a [[meshes]] with `{name}`, or remove the gear"),
        ));
    }
    Ok(drafts)
}

/// Indices of the two gears.
fn pair_of(section: &Section<'_>, gears: &[GearDraft]) -> Result<[usize; 2], SceneError> {
    let entry = section.need("gears")?;
    let members = entry.list()?;
    let [one, two] = members.as_slice() else {
        return Err(entry.error(
            format!("a mesh joins two gears, not {}", members.len()),
            "expected two names",
            "for example gears = [\"pinion\", \"wheel\"]; a gear may stand in several meshes",
        ));
    };
    let names: Vec<&str> = gears.iter().map(|g| g.spec.name.as_str()).collect();
    let index = |member: &Entry<'_>| {
        let name = member.text()?;
        names.iter().position(|n| *n == name).ok_or_else(|| {
            let near = suggest::nearest(name, &names)
                .map_or(String::new(), |n| format!("did you mean `{n}`? "));
            member.error(
                format!("there is no gear `{name}`"),
                "not a gear of this scene",
                format!("{near}there are {}", names.join(", ")),
            )
        })
    };
    let pair = [index(one)?, index(two)?];
    if pair[0] == pair[1] {
        return Err(entry.error(
            "a gear cannot mesh with itself",
            "twice the same",
            "name two gears",
        ));
    }
    if let [Body::Rack(_), second] = pair.map(|i| &gears[i].spec.body) {
        let way_out = match second {
            Body::Gear(_) => format!(
                "write gears = [\"{}\", \"{}\"]",
                names[pair[1]], names[pair[0]]
            ),
            Body::Rack(_) => "two racks do not mesh; one of them must be a gear".to_owned(),
        };
        return Err(one.error(
            "the first gear of a mesh may not be a rack",
            "a rack",
            way_out,
        ));
    }
    Ok(pair)
}

/// Gives positions to gears that have none.
fn put(
    section: &Section<'_>,
    place: &Place,
    gears: &mut [GearDraft],
    [a, b]: [usize; 2],
    placed: &mut [bool],
) -> Result<(), SceneError> {
    if !placed[a] && !placed[b] {
        placed[a] = true;
        gears[a].position = Some([0.0; 2]);
    }
    if placed[a] && placed[b] {
        for name in ["centre_distance_m", "backlash_m", "direction_deg"] {
            if let Some(entry) = section.get(name) {
                return Err(section.source.error(
                    entry.key_range(),
                    format!("`{name}` is given, but both gears have a position already"),
                    "too much",
                    format!(
                        "remove it, or remove `position_m` of `{}`",
                        gears[b].spec.name
                    ),
                ));
            }
        }
        let (pa, pb) = (
            gears[a].position.unwrap_or_default(),
            gears[b].position.unwrap_or_default(),
        );
        set_facing(&mut gears[b], (pb[1] - pa[1]).atan2(pb[0] - pa[0]));
        return Ok(());
    }
    let distance = match (section.get("centre_distance_m"), section.get("backlash_m")) {
        (Some(d), None) => {
            let distance = d.number()?;
            if distance <= 0.0 {
                return Err(d.error(
                    format!("the centre distance is {distance} m"),
                    "expected more than zero",
                    "give the distance of the axes in metres",
                ));
            }
            distance
        }
        (None, Some(j)) => for_backlash(&gears[a].spec.body, &gears[b].spec.body, j.number()?)
            .map_err(|e| refusal(section.source, place, &gears[a], &gears[b], &e))?,
        (Some(d), Some(j)) => {
            return Err(section
                .source
                .error(
                    j.key_range(),
                    "centre distance and backlash are both given",
                    "and this",
                    "remove one: the other follows from it",
                )
                .and(d.key_range(), "this"));
        }
        (None, None) => {
            return Err(section.error(
                format!("where `{}` stands is not given", gears[b].spec.name),
                "in this mesh",
                "add `centre_distance_m` or `backlash_m` here, or `position_m` to the gear",
            ));
        }
    };
    let direction = section.number_or("direction_deg", 0.0)?.to_radians();
    let (known, new, sign) = if placed[a] { (a, b, 1.0) } else { (b, a, -1.0) };
    let from = gears[known].position.unwrap_or_default();
    gears[new].position = Some([
        from[0] + sign * distance * direction.cos(),
        from[1] + sign * distance * direction.sin(),
    ]);
    placed[new] = true;
    set_facing(&mut gears[b], direction);
    Ok(())
}

/// A rack faces its gear unless it says otherwise.
fn set_facing(second: &mut GearDraft, direction: f64) {
    second.spec.facing = second.facing.unwrap_or(direction + std::f64::consts::PI);
}

/// Distance at which a pair has a normal backlash [m].
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
                alpha = ((a.r_base() + b.r_base()) / distance).min(1.0).acos();
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

fn path_of(
    source: &Source,
    place: &Place,
    a: &GearDraft,
    b: &GearDraft,
) -> Result<Path, SceneError> {
    let (pa, pb) = (
        a.position.unwrap_or_default(),
        b.position.unwrap_or_default(),
    );
    let (dx, dy) = (pb[0] - pa[0], pb[1] - pa[1]);
    let path = match (&a.spec.body, &b.spec.body) {
        (Body::Gear(one), Body::Gear(two)) => Pair::new(one, two, dx.hypot(dy)).map(|p| Path {
            ends: [p.s_start(), p.s_end()],
            backlash: p.backlash_base(),
        }),
        (Body::Gear(gear), Body::Rack(rack)) => {
            let direction = b.spec.facing + std::f64::consts::PI;
            Pair::new(gear, rack, dx * direction.cos() + dy * direction.sin()).map(|p| Path {
                ends: [p.s_start(), p.s_end()],
                backlash: p.backlash_base(),
            })
        }
        (Body::Rack(_), _) => Ok(Path {
            ends: [0.0; 2],
            backlash: 0.0,
        }),
    };
    path.map_err(|e| refusal(source, place, a, b, &e))
}

/// A refusal of a pair: at the two keys that disagree, or at what sets the distance.
fn refusal(
    source: &Source,
    place: &Place,
    a: &GearDraft,
    b: &GearDraft,
    e: &GeometryError,
) -> SceneError {
    let Reason { cause, help } = e.reason();
    let message = format!("`{}` and `{}`: {cause}", a.spec.name, b.spec.name);
    if matches!(
        e,
        GeometryError::UnequalModules { .. }
            | GeometryError::UnequalPressureAngles { .. }
            | GeometryError::HelixMismatch { .. }
    ) {
        let keys = keys_of(e);
        return source
            .error(b.place.first(keys), message, "this one", help)
            .and(a.place.first(keys), "differs from this one");
    }
    let own = ["centre_distance_m", "backlash_m"];
    let span = if own.iter().any(|k| place.keys.contains_key(*k)) {
        place.first(&own)
    } else if b.place.keys.contains_key("position_m") {
        b.place.first(&["position_m"])
    } else {
        place.first(&["gears"])
    };
    source.error(span, message, "does not mesh", help)
}

fn start_of(entry: Option<Entry<'_>>, path: &Path) -> Result<Start, SceneError> {
    let Some(entry) = entry else {
        return Ok(Start {
            side: Side::Left,
            gap: 0.0,
            path_coordinate: None,
        });
    };
    let s = entry.section("`start`", START)?;
    let side = match s.get("flank") {
        Some(e) => e.word(&[("left", Side::Left), ("right", Side::Right)])?,
        None => Side::Left,
    };
    let gap = s.number_or("gap_m", 0.0)?;
    if let Some(e) = s.get("gap_m")
        && gap > path.backlash * (1.0 + 1e-9)
    {
        return Err(e.error(
            format!(
                "the gap {gap:.4e} m is larger than the backlash {:.4e} m",
                path.backlash
            ),
            "the other flanks would overlap",
            "use a smaller gap, a larger centre distance or thinner teeth",
        ));
    }
    let path_coordinate = s.maybe_number("path_coordinate_m")?;
    if let (Some(e), Some(x)) = (s.get("path_coordinate_m"), path_coordinate)
        && !(path.ends[0]..=path.ends[1]).contains(&x)
    {
        return Err(e.error(
            format!("the path coordinate {x:.6e} m lies outside the path of contact"),
            format!("expected {:.6e} to {:.6e} m", path.ends[0], path.ends[1]),
            "leave it out to start at the pitch point",
        ));
    }
    Ok(Start {
        side,
        gap,
        path_coordinate,
    })
}
