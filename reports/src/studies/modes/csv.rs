//! CSV tables of natural frequencies: modes with their shares of energy, and motions of members.

use super::{ModeRecord, ModelModes};
use crate::csv_table::{CsvTable, number};

/// Returns the tables with a row per mode and member or spring.
pub fn tables(vibrations: &[ModelModes]) -> Vec<CsvTable> {
    vec![
        frequencies(vibrations),
        energies(vibrations),
        shapes(vibrations),
    ]
}

type Mode<'a> = (&'a ModelModes, usize, &'a ModeRecord);

fn modes(vibrations: &[ModelModes]) -> impl Iterator<Item = Mode<'_>> {
    let of = |v| ModelModes::modes_of(v);
    vibrations.iter().flat_map(of)
}

impl ModelModes {
    /// Returns the modes of the model with their numbers, from 1.
    fn modes_of(&self) -> impl Iterator<Item = Mode<'_>> {
        (self.modes.iter().enumerate()).map(move |(i, m)| (self, i + 1, m))
    }
}

fn frequencies(vibrations: &[ModelModes]) -> CsvTable {
    CsvTable::new::<Mode<'_>>(
        "modes.csv",
        modes(vibrations),
        &[
            ("model", &|(v, ..)| v.label.clone()),
            ("mode", &|(_, i, _)| i.to_string()),
            ("frequency_hz", &|(.., m)| number(m.frequency_hz)),
            ("multiplicity", &|(.., m)| m.multiplicity.to_string()),
            ("damping_ratio", &|(.., m)| number(m.damping_ratio)),
            ("damped_frequency_hz", &|(.., m)| {
                number(m.damped_frequency_hz)
            }),
            ("mode_name", &|(.., m)| m.name.clone()),
        ],
    )
}

fn energies(vibrations: &[ModelModes]) -> CsvTable {
    type Row<'a> = (Mode<'a>, &'static str, &'a str, f64);
    let rows = modes(vibrations).flat_map(|mode| {
        let (v, _, m) = mode;
        let kinetic = v.members.iter().map(|p| p.name.as_str()).zip(&m.kinetic);
        let strain = v.springs.iter().map(String::as_str).zip(&m.strain);
        let kinetic = kinetic.map(move |(name, share)| (mode, "kinetic", name, *share));
        kinetic.chain(strain.map(move |(name, share)| (mode, "strain", name, *share)))
    });
    CsvTable::new::<Row<'_>>(
        "modes_energy.csv",
        rows,
        &[
            ("model", &|((v, ..), ..)| v.label.clone()),
            ("mode", &|((_, i, _), ..)| i.to_string()),
            ("energy", &|(_, kind, ..)| (*kind).to_owned()),
            ("place", &|(.., place, _)| (*place).to_owned()),
            ("share", &|(.., share)| number(*share)),
        ],
    )
}

fn shapes(vibrations: &[ModelModes]) -> CsvTable {
    type Row<'a> = (Mode<'a>, usize);
    let rows = modes(vibrations).flat_map(|mode| (0..mode.2.shape.len()).map(move |k| (mode, k)));
    CsvTable::new::<Row<'_>>(
        "modes_shapes.csv",
        rows,
        &[
            ("model", &|((v, ..), _)| v.label.clone()),
            ("mode", &|((_, i, _), _)| i.to_string()),
            ("member", &|((v, ..), k)| {
                v.members
                    .get(*k)
                    .map_or_else(String::new, |p| p.name.clone())
            }),
            ("turn_rad", &|((v, _, m), k)| {
                let slides = v.members.get(*k).is_some_and(|p| p.slides);
                number((!slides).then_some(m.shape[*k].turn_rad))
            }),
            ("slide_m", &|((v, _, m), k)| {
                let slides = v.members.get(*k).is_some_and(|p| p.slides);
                number(slides.then_some(m.shape[*k].turn_rad))
            }),
            ("hub_x_m", &|((.., m), k)| number(m.shape[*k].x_m)),
            ("hub_y_m", &|((.., m), k)| number(m.shape[*k].y_m)),
            ("hub_z_m", &|((.., m), k)| number(m.shape[*k].z_m)),
            ("hub_tilt_x_rad", &|((.., m), k)| {
                number(m.shape[*k].tilt_x_rad)
            }),
            ("hub_tilt_y_rad", &|((.., m), k)| {
                number(m.shape[*k].tilt_y_rad)
            }),
            ("own_share", &|((.., m), k)| number(m.shape[*k].own)),
        ],
    )
}
