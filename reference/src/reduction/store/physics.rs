//! Checks of a stored reduction that follow from mechanics alone.
//!
//! The compliance `A` between flank nodes is that of all elastic modes, so by reciprocity it is symmetric, it is positive
//! semidefinite, and with the modes that are stored, normalised to unit modal mass,
//!
//! ```text
//! |A_kl| <= sqrt(A_kk A_ll),     A_kk >= sum_r phi_kr^2 / omega_r^2
//! ```
//!
//! A node gives way by a force that spreads over the width of the face: `E b A_kk` is a number of order 10 to 1000 for
//! toothed bodies, and no wave passes an element faster than the speed of sound.

use super::error::{StoreError, value};
use super::names::{COMPLIANCE, INERTIA, OMEGA, SHAPES};
use super::{Meta, Motion};
use crate::reduction::Basis;
use gearbench_models::gear::elastic::reduced::FlankCompliance;

/// Part of the greatest compliance that rounding and the tolerances of eigenvalues and factors leave.
const ROUNDING: f64 = 1e-4;
/// Part by which the modes may be more compliant than the whole body: that of the tolerance of their frequencies.
const MODAL: f64 = 0.02;
/// Bounds of `E b A_kk`.
const COMPLIANT: [f64; 2] = [0.05, 1e6];
/// Least length of an element over the width of the face.
const FINEST: f64 = 1e-5;
/// Relative difference of two inertias of one mesh that is accepted.
const SAME: f64 = 0.01;

/// Returns the first property of a reduction that no elastic body can have, if any.
pub(super) fn problem(b: &Basis, meta: &Meta) -> Option<StoreError> {
    (asymmetry(b).or_else(|| modal(b)))
        .or_else(|| scale(b, meta))
        .or_else(|| inertia(b, meta))
}

/// A pair of rows whose compliances differ by the order of cause and effect, or couple more than they give way themselves.
fn asymmetry(b: &Basis) -> Option<StoreError> {
    let own: Vec<f64> = rows(b).map(|k| between(b, k, k)).collect();
    let unequal = |i: usize, j: usize, there: f64, back: f64| {
        let scale = (own[i] * own[j]).sqrt();
        let expected = if (there - back).abs() > ROUNDING * scale {
            "the same displacement by a force at either of two nodes (reciprocity)"
        } else if there.abs() > (1.0 + ROUNDING) * scale {
            "nodes that move less by a force elsewhere than both do by their own (positive definite)"
        } else {
            return None;
        };
        let found = format!("{there:e} and {back:e} m/N between rows {i} and {j}");
        Some(value(COMPLIANCE, expected, found))
    };
    match &b.compliance.flanks {
        FlankCompliance::Full(c) => {
            let n = own.len();
            let mut pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
            pairs.find_map(|(i, j)| unequal(i, j, c[i * n + j], c[j * n + i]))
        }
        FlankCompliance::Cyclic {
            teeth,
            per_tooth: m,
            blocks,
        } => (0..*teeth).find_map(|d| {
            let opposite = (teeth - d) % teeth;
            let mut pairs = (0..*m).flat_map(|i| (0..*m).map(move |j| (i, j)));
            pairs.find_map(|(i, j)| {
                let there = blocks[(d * m + i) * m + j];
                unequal(i, j, there, blocks[(opposite * m + j) * m + i])
            })
        }),
        FlankCompliance::Deflated(_) => None,
    }
}

fn rows(b: &Basis) -> std::ops::Range<usize> {
    0..b.directions()
}

/// Compliance between two rows of the first tooth, or of the whole gear.
fn between(b: &Basis, i: usize, j: usize) -> f64 {
    b.compliance
        .flanks
        .between(i as u32, j as u32, b.directions())
}

/// A row that the stored modes alone move further than the whole body gives way.
fn modal(b: &Basis) -> Option<StoreError> {
    let modes = b.omega.len();
    rows(b).find_map(|k| {
        let shapes = &b.shapes[k * modes..][..modes];
        let of_modes: f64 = (shapes.iter().zip(&b.omega))
            .map(|(x, w)| (x / w).powi(2))
            .sum();
        let whole = between(b, k, k);
        (of_modes > (1.0 + MODAL) * whole).then(|| {
            value(
                SHAPES,
                "modes that are not more compliant than the whole body (sum of phi^2 / omega^2 up to the compliance)",
                format!("{of_modes:e} m/N by the modes and {whole:e} m/N in all, at row {k}"),
            )
        })
    })
}

/// Compliances and frequencies that no toothed body of this size and material has.
fn scale(b: &Basis, meta: &Meta) -> Option<StoreError> {
    let places = b.flanks.grids().iter().flat_map(|g| &g.positions);
    let ends = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = places.fold(ends, |[a, b], x| [a.min(x.z), b.max(x.z)]);
    let width = high - low;
    let young = meta.material.young;
    // The outward rows are used, because a node may hardly move along the profile.
    let step = if b.along_profile { 2 } else { 1 };
    let normal = rows(b).step_by(step).map(|k| (k, between(b, k, k)));
    let within = |c: f64| (COMPLIANT[0]..=COMPLIANT[1]).contains(&(young * width * c));
    if let Some((k, c)) = normal.into_iter().find(|(_, c)| !within(*c)) {
        let [least, most] = COMPLIANT.map(|x| x / (young * width));
        return Some(value(
            COMPLIANCE,
            format!("from {least:.1e} to {most:.1e} m/N for a body of this width and modulus"),
            format!("{c:e} m/N at row {k}"),
        ));
    }
    let sound = (young / meta.material.density).sqrt();
    let most = 4.0 * sound / (FINEST * width);
    let found = b.omega.last().filter(|w| **w > most)?;
    Some(value(
        OMEGA,
        format!("at most {most:.1e} rad/s for a body of this width, modulus and density"),
        format!("{found:e} rad/s"),
    ))
}

/// Checks that the inertia agrees with the mass of the mesh.
fn inertia(b: &Basis, meta: &Meta) -> Option<StoreError> {
    let i = b.integrals.as_ref()?;
    let about = [i.tensor[0], i.tensor[4], i.tensor[8]];
    if !(i.mass > 0.0 && about.iter().all(|x| *x > 0.0)) {
        return Some(value(
            "mass_kg",
            "a positive mass and positive inertias",
            format!("{} kg, {about:?} kg m^2", i.mass),
        ));
    }
    let own = match meta.motion {
        Motion::Turn => i.tensor[8],
        Motion::Slide => i.mass,
    };
    let stated = b.inertia - b.added_inertia;
    ((stated - own).abs() > SAME * own).then(|| {
        value(
            INERTIA,
            format!("{own:e}, that of the mass of the mesh, and what is added at the hub"),
            format!("{stated:e} without what is added"),
        )
    })
}
