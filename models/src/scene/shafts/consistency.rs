//! Consistency of the members of a shaft: unique names, one axis, and one motion where the shaft is rigid.

use crate::Vec3;
use crate::error::BuildError;
use crate::spec::{
    Body, Freedom, GearSpec, Mount, OutOfPlaneSpec, SceneSpec, ShaftSpec, Station, StationMember,
    UPRIGHT,
};

/// Largest distance of gears of a shaft from its axis [m], and the largest sine between axes.
const OFF_AXIS: f64 = 1e-6;

pub(super) fn check_names(spec: &SceneSpec) -> Result<(), BuildError> {
    let mut seen: Vec<&str> = spec.gears.iter().map(|g| g.name.as_str()).collect();
    let mut carried = vec![None; spec.gears.len()];
    for (k, shaft) in spec.shafts.iter().enumerate() {
        if spec.shafts[..k].iter().any(|s| s.name == shaft.name) {
            return Err(shaft.refuse(("another shaft has this name", "rename one")));
        }
        for station in &shaft.stations {
            match &station.carries {
                StationMember::Body(body) if seen.contains(&body.name.as_str()) => {
                    return Err(shaft.refuse((
                        format!("a gear or another body has the name `{}`", body.name),
                        "rename one",
                    )));
                }
                StationMember::Body(body) => seen.push(&body.name),
                StationMember::Gear(i) => {
                    let Some(other) = carried.get_mut(*i) else {
                        return Err(shaft.refuse(format!("there is no gear number {i}")));
                    };
                    let name = &spec.gears[*i].name;
                    if let Some(other) = other.replace(&shaft.name) {
                        return Err(shaft.refuse((
                            format!("the gear `{name}` is already on the shaft `{other}`"),
                            "a gear can be on one shaft only, once",
                        )));
                    }
                    if matches!(spec.gears[*i].body, Body::Rack(_)) {
                        return Err(shaft.refuse((
                            format!("`{name}` is a rack, which translates"),
                            "put gears on the shaft",
                        )));
                    }
                }
            }
        }
    }
    Ok(())
}

/// Returns the gears of a shaft with their positions.
pub(super) fn gears_of<'a>(
    spec: &'a SceneSpec,
    shaft: &'a ShaftSpec,
) -> impl Iterator<Item = (&'a GearSpec, f64)> {
    shaft.stations.iter().filter_map(|s| match s.carries {
        StationMember::Gear(i) => Some((&spec.gears[i], s.place)),
        StationMember::Body(_) => None,
    })
}

/// Returns the axes of a shaft, a point on it, and the position of that point: those of its first gear.
pub(super) fn axis_of(
    spec: &SceneSpec,
    shaft: &ShaftSpec,
) -> Result<([Vec3; 3], Vec3, f64), BuildError> {
    let Some((first, place)) = gears_of(spec, shaft).next() else {
        // A carrier has the axis of the gears that its planets mesh with.
        let carries = |s: &Station| match &s.carries {
            StationMember::Body(body) => Some((spec.centre_of(body)?, s.place)),
            StationMember::Gear(_) => None,
        };
        let carrier = shaft.stations.iter().find_map(carries);
        let of = |(g, place): (&GearSpec, f64)| (g.axes, Vec3::from(g.position), place);
        return Ok(carrier.map_or((UPRIGHT, Vec3::zeros(), 0.0), of));
    };
    let (axes, point) = (first.axes, Vec3::from(first.position));
    for (gear, _) in gears_of(spec, shaft).skip(1) {
        let off = (Vec3::from(gear.position) - point).cross(&axes[2]).norm();
        let tilted = gear.axes[2].cross(&axes[2]).norm();
        if off > OFF_AXIS || tilted > OFF_AXIS || gear.axes[2].dot(&axes[2]) < 0.0 {
            return Err(shaft.refuse((
                format!(
                    "`{}` is not on the axis of `{}`: its distance is {off:.3e} m, its tilt {tilted:.3e} rad",
                    gear.name, first.name
                ),
                "give both the same position_m across the axis, and the same axis",
            )));
        }
    }
    Ok((axes, point, place))
}

fn mounts<'a>(
    spec: &'a SceneSpec,
    shaft: &'a ShaftSpec,
) -> impl Iterator<Item = (&'a str, &'a Mount, f64)> {
    shaft.stations.iter().map(|s| match &s.carries {
        StationMember::Gear(i) => {
            let g = &spec.gears[*i];
            (g.name.as_str(), &g.mount, g.speed)
        }
        StationMember::Body(b) => (b.name.as_str(), &b.mount, b.speed),
    })
}

/// Returns the mount that fixes or drives a rigid shaft as a whole.
pub(super) fn rigid_mount(spec: &SceneSpec, shaft: &ShaftSpec) -> Option<Mount> {
    if !shaft.sections.is_empty() {
        return None;
    }
    let held = |m: &&Mount| matches!(m, Mount::Fixed | Mount::Driven(_));
    mounts(spec, shaft).map(|m| m.1).find(held).cloned()
}

/// Gives all members of a rigid shaft the mount of the one that is fixed or driven.
pub(super) fn share_mount(with: &mut SceneSpec, shaft: &ShaftSpec) -> Result<(), BuildError> {
    if !shaft.sections.is_empty() {
        return Ok(());
    }
    let moved = |l: &Option<Box<OutOfPlaneSpec>>| {
        let directions = l.iter().flat_map(|l| &l.directions);
        directions
            .into_iter()
            .any(|d| matches!(d, Freedom::Driven(_)))
    };
    let driven = gears_of(with, shaft).find(|(g, _)| moved(&g.lateral));
    let driven = driven.map(|(g, _)| g.name.as_str());
    let body = shaft.bodies().find(|b| moved(&b.lateral));
    if let Some(name) = driven.or(body.map(|b| b.name.as_str())) {
        return Err(shaft.refuse((
            format!("it is rigid, but a direction of `{name}` is driven"),
            "give the sections of an elastic shaft, or fix the direction",
        )));
    }
    let mut speed: Option<(&str, f64)> = None;
    for (name, mount, own) in mounts(with, shaft) {
        match (mount, speed) {
            (Mount::Revolute, Some((other, speed))) if speed != own => {
                return Err(shaft.refuse((
                    format!(
                        "it is rigid, but `{other}` starts at {speed} rad/s and `{name}` at {own} rad/s"
                    ),
                    "give both the same speed",
                )));
            }
            (Mount::Revolute, None) => speed = Some((name, own)),
            _ => {}
        }
    }
    let Some(shared) = rigid_mount(with, shaft) else {
        return Ok(());
    };
    if let Some((name, ..)) = mounts(with, shaft)
        .find(|(_, mount, _)| !matches!(mount, Mount::Revolute) && **mount != shared)
    {
        return Err(shaft.refuse((
            format!(
                "it is rigid, but the mount of `{name}` (fixed or driven) differs from the member before it"
            ),
            "fix or drive one of them, or give the sections of an elastic shaft",
        )));
    }
    for station in &shaft.stations {
        if let StationMember::Gear(i) = station.carries {
            with.gears[i].mount = shared.clone();
        }
    }
    Ok(())
}
