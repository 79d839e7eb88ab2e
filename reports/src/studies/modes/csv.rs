//! CSV tables of natural frequencies: modes with their shares of energy, and motions of members.

use super::{MemberShape, ModeRecord, ModelModes};
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;

/// Returns the tables with a row per mode and member or spring.
pub fn tables(vibrations: &[ModelModes]) -> Vec<CsvTable> {
    let shares = modes(vibrations).flat_map(|mode| {
        let (v, _, m) = mode;
        let kinetic = v.members.iter().map(|p| p.name.as_str()).zip(&m.kinetic);
        let strain = v.springs.iter().map(String::as_str).zip(&m.strain);
        let kinetic = kinetic.map(move |(name, share)| (mode, "kinetic", name, *share));
        kinetic.chain(strain.map(move |(name, share)| (mode, "strain", name, *share)))
    });
    let members =
        modes(vibrations).flat_map(|mode| (0..mode.2.shape.len()).map(move |k| (mode, k)));
    vec![
        frequencies().table(modes(vibrations)),
        energies().table(shares),
        shapes().table(members),
    ]
}

/// A mode with its model and its number.
pub type Mode<'a> = (&'a ModelModes, usize, &'a ModeRecord);
/// A share of energy in a mode: kind, place, value.
type Share<'a> = (Mode<'a>, &'static str, &'a str, f64);
/// A member in a mode, by its place.
type Member<'a> = (Mode<'a>, usize);

fn modes(vibrations: &[ModelModes]) -> impl Iterator<Item = Mode<'_>> {
    let of = |v| ModelModes::modes_of(v);
    vibrations.iter().flat_map(of)
}

impl ModelModes {
    /// Returns the modes of the model with their numbers, from 1.
    fn modes_of(&self) -> impl Iterator<Item = Mode<'_>> {
        (self.modes.iter().enumerate()).map(move |(i, m)| (self, i + 1, m))
    }

    fn slides(&self, member: usize) -> bool {
        self.members.get(member).is_some_and(|p| p.slides)
    }
}

/// Returns the columns of modes.
#[rustfmt::skip]
pub fn frequencies<'a>() -> Columns<'a, Mode<'a>> {
    Columns::<Mode<'_>>::of("modes.csv", "`modes`: one row per natural mode.")
        .model(|(v, ..)| v.label.clone())
        .add("mode", "number of a natural mode, from 1 for the lowest", |(_, i, _)| *i).shown("Mode", Format::Plain)
        .add("frequency_hz", "natural frequency", |(.., m)| m.frequency_hz).shown("Frequency", Format::Short(5)).result()
        .add("multiplicity", "number of modes with this frequency", |(.., m)| m.multiplicity).shown("Times", Format::Plain)
        .add("damping_ratio", "damping ratio of the mode; empty for rigid motions", |(.., m)| m.damping_ratio).shown("Damping ratio", Format::Percents(3)).result()
        .add("damped_frequency_hz", "frequency with damping and gyroscopic terms, where these couple modes", |(.., m)| m.damped_frequency_hz).shown("Frequency, damped", Format::Short(5))
        .add("mode_name", "member with most of the strain energy", |(.., m)| m.name.clone()).shown("What it is", Format::Text).result()
}

#[rustfmt::skip]
pub fn energies<'a>() -> Columns<'a, Share<'a>> {
    Columns::<Share<'_>>::of("modes_energy.csv", "`modes`: one row per mode and place of energy.")
        .model(|((v, ..), ..)| v.label.clone())
        .add("mode", "number of the mode", |((_, i, _), ..)| *i)
        .add("energy", "`kinetic` or `strain`", |(_, kind, ..)| *kind)
        .add("place", "place of the energy: a gear or body; a mesh, shaft, bearing, or the teeth or body of a gear", |(.., place, _)| *place)
        .add("share", "its share of that energy", |(.., share)| *share)
}

#[rustfmt::skip]
pub fn shapes<'a>() -> Columns<'a, Member<'a>> {
    let of = |value: fn(&MemberShape) -> f64| move |((.., m), k): &Member<'_>| value(&m.shape[*k]);
    Columns::<Member<'_>>::of("modes_shapes.csv", "`modes`: one row per mode and gear or body, scaled so that the greatest displacement at a flank is 1 um.")
        .model(|((v, ..), _)| v.label.clone())
        .add("mode", "number of the mode", |((_, i, _), _)| *i)
        .add("member", "gear or body", |((v, ..), k)| Some(v.members.get(*k)?.name.clone()))
        .add("turn_rad", "rotation in the mode", |((v, _, m), k)| (!v.slides(*k)).then_some(m.shape[*k].turn_rad))
        .add("slide_m", "displacement of a rack in the mode", |((v, _, m), k)| v.slides(*k).then_some(m.shape[*k].turn_rad))
        .add("hub_x_m", "displacement of the hub along its first axis", of(|s| s.x_m))
        .add("hub_y_m", "displacement of the hub along its second axis", of(|s| s.y_m))
        .add("hub_z_m", "displacement of the hub along the axis of the gear", of(|s| s.z_m))
        .add("hub_tilt_x_rad", "tilt of the hub about its first axis", of(|s| s.tilt_x_rad))
        .add("hub_tilt_y_rad", "tilt of the hub about its second axis", of(|s| s.tilt_y_rad))
        .add("own_share", "share of its internal coordinates (teeth, modes) in the total kinetic energy", of(|s| s.own))
}
