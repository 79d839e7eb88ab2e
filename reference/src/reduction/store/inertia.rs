//! Arrays of the inertia integrals. All or none are present, as `integrals` in `meta` states.

use super::archive::{Axis, Reader, Writer};
use super::error::StoreError;
use gearbench_models::gear::elastic::inertia::Integrals;
use std::io::{self, Write};

const MASS: &str = "mass_kg";
const CENTRE: &str = "centre_of_mass_m";
const TENSOR: &str = "inertia_tensor_kg_m2";
const TRANSLATION: &str = "modal_translation_sqrt_kg";
const ROTATION: &str = "modal_rotation_sqrt_kg_m";
const RADIAL: &str = "modal_radial_sqrt_kg_m";
const PLANAR: &str = "modal_planar";
const GYROSCOPIC: &str = "modal_gyroscopic";

pub(super) fn write<W: Write>(w: &mut Writer<W>, i: &Integrals) -> io::Result<()> {
    let n = i.modes();
    w.f64s(MASS, &[], std::iter::once(i.mass))?;
    w.f64s(CENTRE, &[3], i.centre.iter().copied())?;
    w.f64s(TENSOR, &[3, 3], i.tensor.iter().copied())?;
    w.f64s(TRANSLATION, &[n, 3], i.translation.iter().copied())?;
    w.f64s(ROTATION, &[n, 3], i.rotation.iter().copied())?;
    w.f64s(RADIAL, &[n], i.radial.iter().copied())?;
    w.f64s(PLANAR, &[n, n], i.planar.iter().copied())?;
    w.f64s(GYROSCOPIC, &[n, n], i.gyroscopic.iter().copied())
}

pub(super) fn read(r: &Reader<'_>, modes: usize) -> Result<Integrals, StoreError> {
    let three = [Axis::Is(modes), Axis::Is(3)];
    let square = [Axis::Is(modes), Axis::Is(modes)];
    let centre = r.f64s(CENTRE, &[Axis::Is(3)])?.1;
    let tensor = r.f64s(TENSOR, &[Axis::Is(3), Axis::Is(3)])?.1;
    Ok(Integrals {
        mass: r.number(MASS)?,
        centre: std::array::from_fn(|k| centre[k]),
        tensor: std::array::from_fn(|k| tensor[k]),
        translation: r.f64s(TRANSLATION, &three)?.1,
        rotation: r.f64s(ROTATION, &three)?.1,
        radial: r.f64s(RADIAL, &[Axis::Is(modes)])?.1,
        planar: r.f64s(PLANAR, &square)?.1,
        gyroscopic: r.f64s(GYROSCOPIC, &square)?.1,
    })
}
