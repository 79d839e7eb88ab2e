//! Loads, prescribed motions and mounts of a gear.
//!
//! ```toml
//! loads = [{ torque_nm = 10.0 }, { viscous_nms_per_rad = 0.01 }]
//! loads = [{ ramp = { from_nm = 0.0, to_nm = 10.0, start_s = 0.0, end_s = 0.05 } }]
//! loads = [{ table = { time_s = [0.0, 0.1], torque_nm = [0.0, 10.0] } }]
//! mount = { driven = { speed_rad_s = 100.0 } }      # ramp and table as above, with speeds
//! ```
//!
//! A rack takes forces [N] and speeds [m/s] instead.

use super::error::SceneError;
use super::reader::{Entry, Key, key};
use gearbench_models::spec::{Load, Mount, Profile};

/// The keys of a profile in one unit: constant, ramp and table.
struct Unit {
    constant: &'static str,
    from: &'static str,
    to: &'static str,
    keys: &'static [Key],
    ramp: &'static [Key],
    table: &'static [Key],
    viscous: &'static str,
}

const START: Key = key("start_s", "time at which the ramp starts in seconds");
const END: Key = key("end_s", "time at which the ramp ends in seconds");
const TIME: Key = key("time_s", "list of ascending times in seconds");

static TORQUE: Unit = Unit {
    constant: "torque_nm",
    from: "from_nm",
    to: "to_nm",
    keys: &[
        key(
            "torque_nm",
            "constant torque in newton metres, counter-clockwise positive",
        ),
        key("ramp", "{ from_nm, to_nm, start_s, end_s }"),
        key("table", "{ time_s = [..], torque_nm = [..] }"),
        key(
            "viscous_nms_per_rad",
            "torque -c omega, c in N m s/rad, zero or more",
        ),
    ],
    ramp: &[
        key("from_nm", "torque before the ramp in N m"),
        key("to_nm", "torque after the ramp in N m"),
        START,
        END,
    ],
    table: &[
        TIME,
        key("torque_nm", "list of torques in N m, one per time"),
    ],
    viscous: "viscous_nms_per_rad",
};

static FORCE: Unit = Unit {
    constant: "force_n",
    from: "from_n",
    to: "to_n",
    keys: &[
        key("force_n", "constant force along the slide in newton"),
        key("ramp", "{ from_n, to_n, start_s, end_s }"),
        key("table", "{ time_s = [..], force_n = [..] }"),
        key("viscous_ns_per_m", "force -c v, c in N s/m, zero or more"),
    ],
    ramp: &[
        key("from_n", "force before the ramp in N"),
        key("to_n", "force after the ramp in N"),
        START,
        END,
    ],
    table: &[TIME, key("force_n", "list of forces in N, one per time")],
    viscous: "viscous_ns_per_m",
};

static TURNING: Unit = Unit {
    constant: "speed_rad_s",
    from: "from_rad_s",
    to: "to_rad_s",
    keys: &[
        key(
            "speed_rad_s",
            "constant angular velocity in rad/s, counter-clockwise positive",
        ),
        key("ramp", "{ from_rad_s, to_rad_s, start_s, end_s }"),
        key("table", "{ time_s = [..], speed_rad_s = [..] }"),
    ],
    ramp: &[
        key("from_rad_s", "speed before the ramp in rad/s"),
        key("to_rad_s", "speed after the ramp in rad/s"),
        START,
        END,
    ],
    table: &[
        TIME,
        key("speed_rad_s", "list of speeds in rad/s, one per time"),
    ],
    viscous: "",
};

static SLIDING: Unit = Unit {
    constant: "speed_m_s",
    from: "from_m_s",
    to: "to_m_s",
    keys: &[
        key("speed_m_s", "constant speed along the slide in m/s"),
        key("ramp", "{ from_m_s, to_m_s, start_s, end_s }"),
        key("table", "{ time_s = [..], speed_m_s = [..] }"),
    ],
    ramp: &[
        key("from_m_s", "speed before the ramp in m/s"),
        key("to_m_s", "speed after the ramp in m/s"),
        START,
        END,
    ],
    table: &[
        TIME,
        key("speed_m_s", "list of speeds in m/s, one per time"),
    ],
    viscous: "",
};

/// All key tables of loads and mounts.
#[cfg(test)]
pub(super) fn tables() -> impl Iterator<Item = &'static [Key]> {
    [&TORQUE, &FORCE, &TURNING, &SLIDING]
        .into_iter()
        .flat_map(|u| [u.keys, u.ramp, u.table])
        .chain([MOUNT])
}

/// The only key of a table `{ key = .. }`, read as a profile; `None` for the viscous key.
fn profile(entry: &Entry<'_>, unit: &Unit) -> Result<Option<Profile>, SceneError> {
    let keys = match entry.name {
        "ramp" => unit.ramp,
        "table" => unit.table,
        name if name == unit.constant => return Ok(Some(Profile::Constant(entry.number()?))),
        _ => return Ok(None),
    };
    let section = entry.section(format!("`{}`", entry.name), keys)?;
    let profile = if entry.name == "ramp" {
        Profile::Ramp {
            from: section.number(unit.from)?,
            to: section.number(unit.to)?,
            start: section.number("start_s")?,
            end: section.number("end_s")?,
        }
    } else {
        Profile::Table {
            time: section.need("time_s")?.numbers()?,
            value: section.need(unit.constant)?.numbers()?,
        }
    };
    match profile.problem() {
        Some(problem) => Err(entry.error(
            problem,
            "this one",
            "times ascend, and every time has its value",
        )),
        None => Ok(Some(profile)),
    }
}

/// The loads of a gear or rack.
pub(super) fn loads(entry: &Entry<'_>, rack: bool) -> Result<Vec<Load>, SceneError> {
    let unit = if rack { &FORCE } else { &TORQUE };
    entry
        .list()?
        .iter()
        .map(|member| {
            let only = member.section("a load", unit.keys)?.only()?;
            if let Some(profile) = profile(&only, unit)? {
                return Ok(Load::Applied(profile));
            }
            let c = only.number()?;
            if c < 0.0 {
                return Err(only.error(
                    format!("`{}` is {c}: a viscous load may not drive", unit.viscous),
                    "expected zero or more",
                    "the load is -c times the speed; give a positive c",
                ));
            }
            Ok(Load::Viscous(c))
        })
        .collect()
}

const MOUNT: &[Key] = &[key(
    "driven",
    "{ speed_rad_s = .. } (a rack: { speed_m_s = .. }), or a ramp or table of it",
)];

/// The mount of a gear or rack.
pub(super) fn mount(entry: &Entry<'_>, rack: bool) -> Result<Mount, SceneError> {
    let refused = |mount: &str, way_out: &str| {
        Err(entry.error(
            format!(
                "{} cannot have the mount \"{mount}\"",
                if rack { "a rack" } else { "a gear" }
            ),
            "here",
            way_out,
        ))
    };
    if entry.is_table() {
        let driven = entry.section("`mount`", MOUNT)?.only()?;
        let unit = if rack { &SLIDING } else { &TURNING };
        let only = driven.section("`driven`", unit.keys)?.only()?;
        // Every key of a speed is a profile: it has no viscous one.
        return Ok(profile(&only, unit)?.map_or(Mount::Fixed, Mount::Driven));
    }
    match entry.text()? {
        "fixed" => Ok(Mount::Fixed),
        "revolute" if rack => refused(
            "revolute",
            "a rack slides: use \"prismatic\", \"fixed\" or { driven = .. }",
        ),
        "revolute" => Ok(Mount::Revolute),
        "prismatic" if rack => Ok(Mount::Prismatic),
        "prismatic" => refused(
            "prismatic",
            "a gear turns: use \"revolute\", \"fixed\" or { driven = .. }",
        ),
        "driven" => refused(
            "driven",
            "a driven mount needs its motion: mount = { driven = { speed_rad_s = 100.0 } }",
        ),
        other => Err(entry.unknown_word(other, &["fixed", "revolute", "prismatic", "driven"])),
    }
}
