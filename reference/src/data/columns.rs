//! Assignment of columns to quantities: by the request of the user, otherwise by name.
//!
//! By default a column is recognised by the names of gearbench's own files (`docs/data.md`) and by those of the keys
//! of a scene: `t`, `force`, `speed_pinion`, each with its unit in brackets or as an ending.

use super::table::{Row, Rows, TableError, shown};
use super::units::{self, Dimension};
use super::{ForceKind, Quantity, Request, Subjects};
use std::f64::consts::TAU;

/// Role of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Time,
    Of(Quantity),
}

/// A column that is read.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub role: Role,
    /// Its place in a row.
    pub index: usize,
    /// Header of the column.
    pub name: String,
    /// Its unit as written; `None` until a line of units has been looked for.
    pub unit: Option<(String, f64)>,
    /// Which part of a contact force it is.
    pub kind: ForceKind,
}

/// All columns of a table, and those that are passed over.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    pub read: Vec<Column>,
    pub passed_over: Vec<String>,
}

impl Role {
    pub fn dimension(self, subjects: &Subjects) -> Dimension {
        match self {
            Role::Time => Dimension::Time,
            Role::Of(quantity) => subjects.dimension(quantity),
        }
    }

    pub fn told(self, subjects: &Subjects) -> String {
        match self {
            Role::Time => "time".into(),
            Role::Of(quantity) => subjects.told(quantity),
        }
    }
}

/// The names that a column may have without its unit, the best first, and which part of a force it then is.
fn names(role: Role, subjects: &Subjects) -> Vec<(String, ForceKind)> {
    let normal = |names: Vec<String>| -> Vec<(String, ForceKind)> {
        names.into_iter().map(|n| (n, ForceKind::Normal)).collect()
    };
    // Names without gears are of the first mesh.
    let of_mesh = |m: usize, words: &[&str]| -> Vec<String> {
        let [a, b] = (subjects.meshes.get(m))
            .map_or(["", ""], |mesh| mesh.gears.each_ref().map(String::as_str));
        let named = words.iter().map(|w| format!("{w}_{a}_{b}"));
        let of_first = words.iter().filter(|_| m == 0).map(|w| (*w).to_owned());
        named.chain(of_first).collect()
    };
    let of_gear = |g: usize, words: &[&str], by_number: &[&str]| -> Vec<String> {
        let name = subjects.gears.get(g).map_or("", |g| g.name.as_str());
        let named = words.iter().map(|w| format!("{w}_{name}"));
        let numbered = subjects.gears.get(g).is_some_and(|g| g.toothed);
        let by_number = by_number.iter().filter(|_| numbered);
        let by_number = by_number.map(|w| w.replace('#', &(g + 1).to_string()));
        named.chain(by_number).collect()
    };
    match role {
        Role::Time => normal(
            ["time", "t", "roll_angle", "mesh_cycle", "mesh_cycles"]
                .map(str::to_owned)
                .to_vec(),
        ),
        Role::Of(Quantity::Force(m)) => {
            let mut all = normal(of_mesh(
                m,
                &["contact_force", "force", "normal_force", "fn"],
            ));
            let words = [
                "transverse_force",
                "contact_force_transverse",
                "force_transverse",
            ];
            let transverse = of_mesh(m, &words);
            all.extend(transverse.into_iter().map(|n| (n, ForceKind::Transverse)));
            all
        }
        Role::Of(Quantity::TransmissionError(m)) => normal(of_mesh(m, &["transmission_error"])),
        Role::Of(Quantity::Speed(g)) => {
            let by_number = ["omega#", "omega#_mean", "speed#"];
            normal(of_gear(g, &["speed", "omega", "hub_speed"], &by_number))
        }
        Role::Of(Quantity::Angle(g)) => {
            let words = ["hub_angle", "hub_displacement", "angle"];
            normal(of_gear(g, &words, &["angle#"]))
        }
        Role::Of(Quantity::Torque(g)) => {
            normal(of_gear(g, &["contact_torque", "torque"], &["torque#"]))
        }
        Role::Of(Quantity::MountTorque(g)) => normal(of_gear(g, &["mount_torque"], &[])),
        Role::Of(Quantity::ShaftTorque(s)) => {
            let [a, b] = (subjects.spans.get(s))
                .map_or(["", ""], |names| names.each_ref().map(String::as_str));
            normal(vec![format!("shaft_torque_{a}_{b}")])
        }
    }
}

/// Lower case, everything that joins words a `_`.
fn plain(name: &str) -> String {
    let joined = name.trim().to_lowercase();
    joined.replace([' ', '.', '-'], "_")
}

/// A header that is the column of a role: its rank among the names, the kind of force, its unit.
fn known_as(
    header: &str,
    role: Role,
    subjects: &Subjects,
) -> Option<(usize, ForceKind, Option<String>)> {
    let dimension = role.dimension(subjects);
    let (name, unit) = units::split(header);
    let rank = |stem: &str| {
        let stem = plain(stem);
        let mut all = names(role, subjects).into_iter().enumerate();
        all.find(|(_, (n, _))| plain(n) == stem)
            .map(|(rank, (_, kind))| (rank, kind))
    };
    if let Some((rank, kind)) = rank(name) {
        return Some((rank, kind, unit.map(str::to_owned)));
    }
    if unit.is_some() {
        return None;
    }
    // An angular velocity is a rack's speed too, over the reference radius of its mate.
    let dimensions = match dimension {
        Dimension::Velocity => vec![dimension, Dimension::Turning],
        Dimension::Time => vec![dimension, Dimension::Angle],
        Dimension::Length
            if matches!(
                role,
                Role::Of(Quantity::Angle(_) | Quantity::TransmissionError(_))
            ) =>
        {
            vec![dimension, Dimension::Angle]
        }
        _ => vec![dimension],
    };
    dimensions.into_iter().find_map(|d| {
        let (stem, ending, _) = units::ending(name, d)?;
        rank(stem).map(|(rank, kind)| (rank, kind, Some(format!("_{ending}"))))
    })
}

/// Units of the abscissa that count mesh cycles.
const CYCLES: [&str; 2] = ["cycle", "cycles"];

/// The factor of a unit of a column as written in its header or by the user; of a rack, angular velocities count by the
/// radius of its mate, of a transmission error angles by the base radius of the mesh's second gear, and of the abscissa
/// angles of rotation of the first gear, or mesh cycles, by its speed.
pub(super) fn factor(role: Role, unit: &str, subjects: &Subjects) -> Option<f64> {
    let dimension = role.dimension(subjects);
    let of = |dimension| match unit.strip_prefix('_') {
        Some(_) => {
            let name = format!("x{unit}");
            units::ending(&name, dimension)
                .filter(|(stem, ..)| *stem == "x")
                .map(|(.., factor)| factor)
        }
        None => units::factor(unit, dimension),
    };
    if role == Role::Time
        && let Some(turning) = subjects.turning.filter(|t| t.speed != 0.0)
    {
        let angle = match CYCLES.contains(&unit.trim_start_matches('_')) {
            true => Some(TAU / f64::from(turning.teeth)),
            false => match unit.strip_prefix('_') {
                Some(_) => units::ending(&format!("x{unit}"), Dimension::Angle)
                    .filter(|(stem, ..)| *stem == "x")
                    .map(|(.., factor)| factor),
                None => units::factor(unit, Dimension::Angle),
            },
        };
        if let Some(angle) = angle {
            return Some(angle / turning.speed.abs());
        }
    }
    let radius = match role {
        Role::Of(Quantity::Speed(g) | Quantity::Angle(g)) => subjects.gears.get(g)?.slides,
        Role::Of(Quantity::TransmissionError(m)) => subjects.meshes.get(m)?.base_radius,
        _ => None,
    };
    let turned = match dimension {
        Dimension::Velocity => Some(Dimension::Turning),
        Dimension::Length => Some(Dimension::Angle),
        _ => None,
    };
    of(dimension).or_else(|| Some(radius? * of(turned?)?))
}

/// The columns of a line of names.
pub(super) fn columns(
    rows: &Rows<'_>,
    head: &Row,
    request: &Request,
    subjects: &Subjects,
) -> Result<Columns, TableError> {
    let headers: Vec<&str> = head.cells.iter().collect();
    let roles = || std::iter::once(Role::Time).chain(subjects.quantities().map(Role::Of));
    let mut found = Columns::default();
    for role in roles() {
        let column = match request.column_of(role) {
            Some(wanted) => Some(named(rows, head, wanted)?),
            // Who names columns wants these, and the time is found by its name where it is not among them.
            None if !request.columns.is_empty() && role != Role::Time => None,
            None => {
                let known = (headers.iter().enumerate())
                    .filter_map(|(i, h)| known_as(h, role, subjects).map(|k| (i, k)));
                known
                    .min_by_key(|(i, (rank, ..))| (*rank, *i))
                    .map(|(i, (_, kind, unit))| (i, kind, unit))
            }
        };
        let Some((index, kind, unit)) = column else {
            continue;
        };
        let name = headers[index].to_owned();
        if let Some(other) = found.read.iter().find(|c| c.index == index) {
            let what = [other.role, role].map(|r| r.told(subjects));
            return Err(rows.error_in(
                head,
                (index, &name),
                &format!("one column for {} and one for {}", what[0], what[1]),
                "name two different columns",
            ));
        }
        let unit = match (request.unit_of(role), unit) {
            (Some(given), _) => Some(given.to_owned()),
            (None, unit) => unit,
        };
        // A column name with the word `cycle` needs no unit.
        let cycles = role == Role::Time && plain(&name).contains("cycle");
        let unit = unit.or_else(|| cycles.then(|| CYCLES[0].to_owned()));
        let unit = match unit {
            None => None,
            Some(unit) => match factor(role, &unit, subjects) {
                Some(factor) => Some((unit.trim_start_matches('_').to_owned(), factor)),
                None => {
                    return Err(unknown_unit(
                        rows,
                        head,
                        (index, &name),
                        role,
                        &unit,
                        subjects,
                    ));
                }
            },
        };
        let kind = match role {
            Role::Of(Quantity::Force(_)) => request.force_kind.unwrap_or(kind),
            _ => kind,
        };
        found.read.push(Column {
            role,
            index,
            name,
            unit,
            kind,
        });
    }
    let used = |i: &usize| found.read.iter().any(|c| c.index == *i);
    found.passed_over = (0..headers.len())
        .filter(|i| !used(i) && !headers[*i].is_empty())
        .map(|i| headers[i].to_owned())
        .collect();
    let has = |time: bool| found.read.iter().any(|c| (c.role == Role::Time) == time);
    let all: Vec<String> = headers.iter().take(20).map(|h| shown(h)).collect();
    let there_are = format!("the columns {}", all.join(", "));
    if headers.iter().all(|h| h.parse::<f64>().is_ok()) {
        let help = "begin the file with a line of column names, such as `t [ms],force [N]`";
        return Err(rows.error(head, "", "a line of names", "numbers only", help));
    }
    if !has(true) {
        let help = "name it: columns = { time = \"t [ms]\", .. }; or set another `delimiter`";
        return Err(rows.error(head, "", "a column of time", &there_are, help));
    }
    if !has(false) {
        let help = "name them: columns = { time = \"t [ms]\", force = \"Fn [kN]\", speed.pinion = \"n1 [1/min]\" }";
        let expected =
            "a column of a contact force, a transmission error, a speed, an angle or a torque";
        return Err(rows.error(head, "", expected, &there_are, help));
    }
    Ok(found)
}

fn unknown_unit(
    rows: &Rows<'_>,
    head: &Row,
    (index, name): (usize, &str),
    role: Role,
    unit: &str,
    subjects: &Subjects,
) -> TableError {
    let mut known = units::known(role.dimension(subjects));
    if role == Role::Time {
        known += match subjects.turning {
            Some(t) if t.speed != 0.0 => {
                ", or of the angle of rotation of the first gear: rad, deg, rev, cycle"
            }
            _ => "; angles of rotation need a first gear that turns at a constant speed",
        };
    }
    let mut error = rows.error_in(
        head,
        (index, name),
        &format!("a unit of {}: {known}", role.told(subjects)),
        "give the unit in the header, `name [unit]`, or in the scene: units = { force = \"kN\" }",
    );
    error.found = shown(unit.trim_start_matches('_'));
    error
}

/// The column of a name that the user gives: the whole header, else the header without its unit.
fn named(
    rows: &Rows<'_>,
    head: &Row,
    wanted: &str,
) -> Result<(usize, ForceKind, Option<String>), TableError> {
    let wanted = wanted.trim();
    let headers = || head.cells.iter().enumerate();
    let whole: Vec<usize> = headers()
        .filter(|(_, h)| *h == wanted)
        .map(|(i, _)| i)
        .collect();
    let bare = || headers().filter(|(_, h)| units::split(h).0 == wanted);
    let all = match whole.is_empty() {
        true => bare().map(|(i, _)| i).collect(),
        false => whole,
    };
    let refuse = |found: String| {
        let listed: Vec<String> = head.cells.iter().take(20).map(shown).collect();
        let expected = format!("one column called {}", shown(wanted));
        let help = format!("the columns are {}", listed.join(", "));
        Err(rows.error(head, "", &expected, &found, &help))
    };
    match all.as_slice() {
        [] => refuse("none".into()),
        [index] => {
            let header = head.cells.get(*index).unwrap_or_default();
            let unit = match units::split(header).1 {
                Some(unit) => Some(unit.to_owned()),
                None => any_ending(header),
            };
            Ok((*index, ForceKind::Normal, unit))
        }
        several => refuse(format!("{}", several.len())),
    }
}

/// The ending of a name that is a unit of something.
fn any_ending(name: &str) -> Option<String> {
    let found = units::longest_ending(name, &Dimension::OF_HISTORIES);
    found.map(|(_, ending, ..)| format!("_{ending}"))
}
