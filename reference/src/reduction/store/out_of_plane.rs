//! Arrays of a hub with out-of-plane freedom. All or none are present, as `lateral` in `meta` states.

use super::archive::{Axis, Reader, Writer};
use super::error::{StoreError, value};
use super::names::{
    ADDED_MASS, ADDED_TILTING, BODY_CENTRE, BODY_INERTIA, BODY_MASS, LATERAL_FREE, LATERAL_HUB,
};
use gearbench_models::gear::elastic::reduced::OutOfPlaneShapes;
use std::io::{self, Write};

pub(super) fn write<W: Write>(
    w: &mut Writer<W>,
    l: &OutOfPlaneShapes,
    [mass, tilting]: [f64; 2],
) -> io::Result<()> {
    w.i64s(LATERAL_FREE, &[6], l.free.iter().map(|f| i64::from(*f)))?;
    let hub = l.hub.iter().flatten().copied();
    w.f64s(LATERAL_HUB, &[l.hub.len(), 6], hub)?;
    w.f64s(BODY_MASS, &[], std::iter::once(l.mass))?;
    w.f64s(BODY_CENTRE, &[3], l.centre.iter().copied())?;
    w.f64s(BODY_INERTIA, &[3, 3], l.inertia.iter().copied())?;
    w.f64s(ADDED_MASS, &[], std::iter::once(mass))?;
    w.f64s(ADDED_TILTING, &[], std::iter::once(tilting))
}

/// Reads the hub and the mass and inertia added at it, about the axes other than the own one.
pub(super) fn read(
    r: &Reader<'_>,
    modes: usize,
) -> Result<(OutOfPlaneShapes, [f64; 2]), StoreError> {
    let free = r.i64s(LATERAL_FREE, Axis::Is(6))?;
    if let Some(f) = free.iter().find(|f| !(0..=1).contains(*f)) {
        return Err(value(LATERAL_FREE, "1 (free) or 0 (held)", f.to_string()));
    }
    let hub = r.f64s(LATERAL_HUB, &[Axis::Is(modes), Axis::Is(6)])?.1;
    let centre = r.f64s(BODY_CENTRE, &[Axis::Is(3)])?.1;
    let inertia = r.f64s(BODY_INERTIA, &[Axis::Is(3), Axis::Is(3)])?.1;
    let lateral = OutOfPlaneShapes {
        free: std::array::from_fn(|d| free[d] == 1),
        hub: hub.as_chunks().0.to_vec(),
        mass: r.number(BODY_MASS)?,
        centre: std::array::from_fn(|k| centre[k]),
        inertia: std::array::from_fn(|k| inertia[k]),
    };
    Ok((lateral, [r.number(ADDED_MASS)?, r.number(ADDED_TILTING)?]))
}
