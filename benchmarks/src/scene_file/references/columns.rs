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
type QuantityOf = fn(usize) -> Quantity;

/// Parts of a scene that quantities belong to, in the order of their numbers.
#[derive(Clone, Copy)]
enum Subject {
    /// Meshes.
    Mesh,
    /// Gears, then bodies on shafts.
    Member,
    /// Spans of shafts, then stages.
    Span,
}

/// Quantities of gears, bodies and shafts, by their keys.
const OF_MEMBERS: [(&str, QuantityOf, Subject); 5] = [
    ("speed", Quantity::Speed, Subject::Member),
    ("angle", Quantity::Angle, Subject::Member),
    ("torque", Quantity::Torque, Subject::Member),
    ("mount_torque", Quantity::MountTorque, Subject::Member),
    ("shaft_torque", Quantity::ShaftTorque, Subject::Span),
];

impl Subject {
    /// Returns the names of the members of every part: two of a mesh or span.
    fn members(self, spec: &SceneSpec) -> Vec<Vec<&str>> {
        let named = |members: &[usize]| members.iter().map(|i| spec.member_name(*i)).collect();
        let gears_and_bodies = spec.gears.len() + spec.bodies().count();
        match self {
            Subject::Mesh => spec.meshes.iter().map(|m| named(&m.gears)).collect(),
            Subject::Member => (0..gears_and_bodies).map(|i| named(&[i])).collect(),
            Subject::Span => spec.spans().iter().map(|span| named(span)).collect(),
        }
    }
}

/// Names of the members of all spans.
pub(super) fn spans(spec: &SceneSpec) -> Vec<[String; 2]> {
    let named = |members: [usize; 2]| members.map(|i| spec.member_name(i).to_owned());
    spec.spans().into_iter().map(named).collect()
}

/// Reads entries by the names of the members of their subjects, joined by `-` or `_`.
fn by_name(
    list: &OrderedTable<String>,
    (of, subject): (QuantityOf, Subject),
    spec: &SceneSpec,
    at: &Place<'_>,
) -> Result<Vec<(Quantity, String)>, SceneError> {
    let all = subject.members(spec);
    let one = |(name, text): &(String, String)| {
        let is = |members: &Vec<&str>| ["-", "_"].iter().any(|by| members.join(by) == *name);
        match all.iter().position(is) {
            Some(i) => Ok((of(i), text.clone())),
            None => {
                let known: Vec<String> = all.iter().map(|members| members.join("-")).collect();
                at.key(name).refuse(
                    format!("there is nothing called `{name}` in the scene"),
                    "not known",
                    there_are(name, &known),
                )
            }
        }
    };
    list.0.iter().map(one).collect()
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
    let of_meshes: [(&str, &Option<OneOrNamed>, QuantityOf); 2] = [
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
                all.extend(by_name(list, (of, Subject::Mesh), spec, &at.key(key))?);
            }
        }
    }
    let others = [
        &keys.speed,
        &keys.angle,
        &keys.torque,
        &keys.mount_torque,
        &keys.shaft_torque,
    ];
    for ((key, of, subject), list) in OF_MEMBERS.into_iter().zip(others) {
        if let Some(list) = list {
            all.extend(by_name(list, (of, subject), spec, &at.key(key))?);
        }
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
    let of_meshes: [(&Option<String>, QuantityOf); 2] = [
        (&keys.force, Quantity::Force),
        (&keys.transmission_error, Quantity::TransmissionError),
    ];
    for (unit, of) in of_meshes {
        let every = unit
            .iter()
            .flat_map(|u| (0..spec.meshes.len()).map(move |m| (of(m), u.clone())));
        all.extend(every);
    }
    let others = [
        &keys.speed,
        &keys.angle,
        &keys.torque,
        &keys.mount_torque,
        &keys.shaft_torque,
    ];
    for ((key, of, subject), choice) in OF_MEMBERS.into_iter().zip(others) {
        match choice {
            None => {}
            Some(OneOrNamed::One(unit)) => {
                let parts = 0..subject.members(spec).len();
                all.extend(parts.map(|i| (of(i), unit.clone())));
            }
            Some(OneOrNamed::Named(list)) => {
                all.extend(by_name(list, (of, subject), spec, &at.key(key))?);
            }
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
