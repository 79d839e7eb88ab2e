//! Columns and units of a reference table by gear, body, mesh and shaft.

use super::super::SceneError;
use super::super::reading::Place;
use super::super::reading::keys::keys;
use super::super::reading::suggest::there_are;
use super::super::reading::values::OrderedTable;
use super::subjects;
use gearbench_models::spec::SceneSpec;
use gearbench_reference::data::{Dimension, Quantity, factor};
use serde::{Deserialize, Serialize};

keys! {
    /// Names of the columns of a reference.
    struct ColumnTable {
        /// column of time
        time: Option<String>,
        /// column of the contact force of the first mesh, or { pinion-wheel = "Fn [kN]" } by mesh
        force: Option<OneOrNamed>,
        /// column of the transmission error of the first mesh, or by mesh
        transmission_error: Option<OneOrNamed>,
        /// columns of speeds by gear or body: speed.pinion = "n1 [1/min]"
        speed: Option<OrderedTable<String>>,
        /// columns of angles by gear or body
        angle: Option<OrderedTable<String>>,
        /// columns of torques of the contact forces by gear
        torque: Option<OrderedTable<String>>,
        /// columns of torques of held and driven mounts, by gear or body
        mount_torque: Option<OrderedTable<String>>,
        /// columns of torques through shafts and stages: shaft_torque.motor-pinion = "T1 [N m]"
        shaft_torque: Option<OrderedTable<String>>,
    }

    /// Units of the columns of a reference.
    struct UnitTable {
        /// unit of time, for example "ms"
        time: Option<String>,
        /// unit of contact forces, for example "kN"
        force: Option<String>,
        /// unit of transmission errors, for example "um", or "arcsec" as an angle of the mesh's second gear
        transmission_error: Option<String>,
        /// unit of speeds, for example "1/min", or by gear
        speed: Option<OneOrNamed>,
        /// unit of angles, for example "deg", or by gear
        angle: Option<OneOrNamed>,
        /// unit of torques, for example "N m", or by gear
        torque: Option<OneOrNamed>,
        /// the same of torques of mounts
        mount_torque: Option<OneOrNamed>,
        /// unit of torques through shafts, or by both members
        shaft_torque: Option<OneOrNamed>,
    }
}

/// One entry for all gears or meshes, or one for each name.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum OneOrNamed {
    #[serde(rename = "<text>")]
    One(String),
    #[serde(rename = "<table>")]
    Named(OrderedTable<String>),
}

type RecognisedColumns = (Option<String>, Vec<(Quantity, String)>);
type QuantityOfGear = fn(usize) -> Quantity;

/// Index of a mesh by its name: the names of both gears, joined.
fn mesh_of(spec: &SceneSpec, name: &str) -> Option<usize> {
    let named = |i: usize| spec.gears[i].name.as_str();
    spec.meshes.iter().position(|m| {
        let [a, b] = m.gears.map(named);
        [format!("{a}-{b}"), format!("{a}_{b}")].contains(&name.to_owned())
    })
}

/// Number of gears and bodies.
fn members(spec: &SceneSpec) -> usize {
    spec.gears.len() + spec.bodies().count()
}

/// Index of a gear or, behind them, of a body.
fn member_of(spec: &SceneSpec, name: &str) -> Option<usize> {
    (0..members(spec)).find(|i| spec.member_name(*i) == name)
}

/// Index of a span of a shaft, or of a stage, by the names of both members, joined.
fn span_of(spec: &SceneSpec, name: &str) -> Option<usize> {
    spans(spec)
        .iter()
        .position(|[a, b]| [format!("{a}-{b}"), format!("{a}_{b}")].contains(&name.to_owned()))
}

/// Names of the members of all spans.
pub(super) fn spans(spec: &SceneSpec) -> Vec<[String; 2]> {
    let named = |members: [usize; 2]| members.map(|i| spec.member_name(i).to_owned());
    spec.spans().into_iter().map(named).collect()
}

/// Reads entries by names; each is a quantity of its gear or mesh.
fn by_name(
    list: &OrderedTable<String>,
    of: QuantityOfGear,
    find: impl Fn(&str) -> Option<usize>,
    known: &[String],
    at: &Place<'_>,
) -> Result<Vec<(Quantity, String)>, SceneError> {
    let one = |(name, text): &(String, String)| match find(name) {
        Some(i) => Ok((of(i), text.clone())),
        None => at.key(name).refuse(
            format!("there is nothing called `{name}` in the scene"),
            "not known",
            there_are(name, known),
        ),
    };
    list.0.iter().map(one).collect()
}

fn names(spec: &SceneSpec) -> Vec<String> {
    let names = (0..members(spec)).map(|i| spec.member_name(i).to_owned());
    names.collect()
}

/// Names of all spans, as keys.
fn joined(spec: &SceneSpec) -> Vec<String> {
    spans(spec)
        .iter()
        .map(|[a, b]| format!("{a}-{b}"))
        .collect()
}

fn meshes(spec: &SceneSpec) -> Vec<String> {
    let named = |i: usize| spec.gears[i].name.as_str();
    let names = spec.meshes.iter().map(|m| m.gears.map(named));
    names.map(|[a, b]| format!("{a}-{b}")).collect()
}

/// Reads the column of time and the columns of quantities.
pub(super) fn columns(
    keys: Option<&ColumnTable>,
    spec: &SceneSpec,
    at: &Place<'_>,
) -> Result<RecognisedColumns, SceneError> {
    let Some(keys) = keys else {
        return Ok(RecognisedColumns::default());
    };
    let mut all = Vec::new();
    let of_meshes: [(&str, &Option<OneOrNamed>, QuantityOfGear); 2] = [
        ("force", &keys.force, Quantity::Force),
        (
            "transmission_error",
            &keys.transmission_error,
            Quantity::TransmissionError,
        ),
    ];
    for (key, choice, of) in of_meshes {
        match choice {
            None => {}
            Some(OneOrNamed::One(name)) => all.push((of(0), name.clone())),
            Some(OneOrNamed::Named(list)) => {
                let find = |name: &str| mesh_of(spec, name);
                all.extend(by_name(list, of, find, &meshes(spec), &at.key(key))?);
            }
        }
    }
    let of_gears: [(&str, &Option<OrderedTable<String>>, QuantityOfGear); 4] = [
        ("speed", &keys.speed, Quantity::Speed),
        ("angle", &keys.angle, Quantity::Angle),
        ("torque", &keys.torque, Quantity::Torque),
        ("mount_torque", &keys.mount_torque, Quantity::MountTorque),
    ];
    for (key, list, of) in of_gears {
        if let Some(list) = list {
            let find = |name: &str| member_of(spec, name);
            all.extend(by_name(list, of, find, &names(spec), &at.key(key))?);
        }
    }
    if let Some(list) = &keys.shaft_torque {
        let find = |name: &str| span_of(spec, name);
        let at = at.key("shaft_torque");
        all.extend(by_name(
            list,
            Quantity::ShaftTorque,
            find,
            &joined(spec),
            &at,
        )?);
    }
    Ok((keys.time.clone(), all))
}

/// Reads the unit of time and the units of quantities.
pub(super) fn units(
    keys: Option<&UnitTable>,
    spec: &SceneSpec,
    at: &Place<'_>,
) -> Result<RecognisedColumns, SceneError> {
    let Some(keys) = keys else {
        return Ok(RecognisedColumns::default());
    };
    let subjects = subjects(spec);
    let mut all = Vec::new();
    let of_meshes: [(&Option<String>, QuantityOfGear); 2] = [
        (&keys.force, Quantity::Force),
        (&keys.transmission_error, Quantity::TransmissionError),
    ];
    for (unit, of) in of_meshes {
        let every = unit
            .iter()
            .flat_map(|u| (0..spec.meshes.len()).map(move |m| (of(m), u.clone())));
        all.extend(every);
    }
    let of_gears: [(&str, &Option<OneOrNamed>, QuantityOfGear); 4] = [
        ("speed", &keys.speed, Quantity::Speed),
        ("angle", &keys.angle, Quantity::Angle),
        ("torque", &keys.torque, Quantity::Torque),
        ("mount_torque", &keys.mount_torque, Quantity::MountTorque),
    ];
    for (key, choice, of) in of_gears {
        match choice {
            None => {}
            Some(OneOrNamed::One(unit)) => {
                all.extend((0..members(spec)).map(|g| (of(g), unit.clone())));
            }
            Some(OneOrNamed::Named(list)) => {
                let find = |name: &str| member_of(spec, name);
                all.extend(by_name(list, of, find, &names(spec), &at.key(key))?);
            }
        }
    }
    match &keys.shaft_torque {
        None => {}
        Some(OneOrNamed::One(unit)) => {
            let spans = 0..spec.spans().len();
            all.extend(spans.map(|s| (Quantity::ShaftTorque(s), unit.clone())));
        }
        Some(OneOrNamed::Named(list)) => {
            let find = |name: &str| span_of(spec, name);
            let at = at.key("shaft_torque");
            all.extend(by_name(
                list,
                Quantity::ShaftTorque,
                find,
                &joined(spec),
                &at,
            )?);
        }
    }
    // Units of a rack may be those of its mate, which the reader knows: here only what is a unit of nothing is refused.
    let known = |text: &str| {
        let mut all = Dimension::OF_HISTORIES.into_iter();
        text == "cycle" || all.any(|d| factor(text, d).is_some())
    };
    let time = keys.time.iter().map(|u| ("time".to_owned(), u.clone()));
    let of_quantities = all.iter().map(|(q, u)| (subjects.told(*q), u.clone()));
    for (what, unit) in time.chain(of_quantities) {
        if !known(&unit) {
            return at.refuse(
                format!("the unit \"{unit}\" of {what} is not known"),
                "here",
                "known units are s, ms, us; N, kN; m, mm, um; rad, deg; rad/s, 1/min; N m; m/s",
            );
        }
    }
    Ok((keys.time.clone(), all))
}
