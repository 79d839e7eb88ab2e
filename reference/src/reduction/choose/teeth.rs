//! Modes that are made for the teeth of a gear that can touch, where it turns by less than half a pitch: an impact.
//!
//! A hundred eigenmodes give each of twenty teeth five shapes, and a helical tooth, which is struck along lines that cross
//! its flank, answers with more. What flanks of few teeth do lies close to a much smaller space within that of the eigenmodes.
//! A load `f` on the flanks moves the eigenmodes by
//!
//! ```text
//! q(s) = (Omega^2 + s^2)^-1 B^T f,   s = sigma + j omega
//! ```
//!
//! and the space is that of the leading eigenvectors of
//!
//! ```text
//! P = sum_f sum_omega w_f w(omega) Re( q(s) q(s)^H )
//! ```
//!
//! over forces that lie along the lines of contact of these teeth, evenly and rising along each, and over the band of an impact:
//! proper orthogonal decomposition in the norm of the kinetic energy (K. Willcox, J. Peraire, *AIAA J.* 40 (2002) 2323).
//! `sigma` is [`MEMORY`] over the time for which the modes have to hold. After a short time few waves have left the teeth; the
//! longer the time, the more the leading eigenvectors resemble eigenmodes of the whole gear.
//!
//! Let `U` be these eigenvectors. The part of the motion that is orthogonal to them in mass is taken as massless: it follows
//! the loads and the coordinates `x = U^T q` statically (static condensation, R. J. Guyan, *AIAA J.* 3 (1965) 380, in these
//! coordinates). Then
//!
//! ```text
//! x'' + K x = K U^T Omega^-2 B^T f,   K = (U^T Omega^-2 U)^-1
//! ```
//!
//! and the eigenvectors of `K` make independent oscillators of it. The static compliance stays exact for any load. Its first
//! error in frequency, `-omega^2 |(1 - U U^T) q(0)|^2`, is what the decomposition makes small; a Ritz basis in the place of the
//! condensation also omits the inertia between the basis and the static compliance of the rest. Frequencies lie among those of
//! the eigenmodes. With all eigenmodes `U` drops out.

use super::lines::{self, Load};
use super::{Choice, FOR_HUB};
use crate::reduction::{Basis, ReductionError};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par, Side};
use gearbench_models::gear::table::GearContext;
use gearbench_models::geometry::Side as FlankSide;
use gearbench_models::spec::Body;
use std::f64::consts::{PI, TAU};

/// Product of the damping `sigma` with the time for which the modes have to hold. It was found on impacts of gears of six
/// sizes, with 60 and 100 modes: 5 to 15 are about equal there.
const MEMORY: f64 = 8.0;
/// Least damping `sigma`, where forces fall off, the end of the band and the largest distance between its frequencies, over
/// the mean frequency of the flanks' compliance.
const LEAST_SIGMA: f64 = 0.05;
const FALLS: f64 = 2.0;
const BAND: f64 = 6.0;
const SPACING: f64 = 0.1;
/// Directions that move less than this part of the first are rounding.
const ROUNDING: f64 = 1e-13;

/// Returns the teeth of a gear that meshes can reach at the initial position: a flank is within the range of possible
/// contact, plus half a pitch and half the overlap of helical teeth on both sides.
pub fn in_mesh(context: &GearContext<'_>) -> Vec<u32> {
    let (teeth, overlap) = match context.body {
        Body::Gear(g) => (g.teeth(), g.face_width() * g.base_helix_angle().tan().abs()),
        Body::Rack(r) => (
            r.teeth(),
            r.params().face_width * r.params().helix_angle.tan().abs(),
        ),
    };
    let reached = |tooth: &u32| {
        context.meshes.iter().any(|view| {
            let at = view.assembled + f64::from(*tooth) * view.pitch;
            let angle = match context.body {
                Body::Gear(_) => view.direction + (at - view.direction + PI).rem_euclid(TAU) - PI,
                Body::Rack(_) => at,
            };
            let base_pitch = (view.pitch * view.path_per_displacement()).abs();
            let margin = 0.5 * (base_pitch + overlap);
            let [low, high] = view.touching;
            FlankSide::BOTH.iter().any(|side| {
                let place = view.path_coordinate(*side, angle);
                (low - margin..=high + margin).contains(&place)
            })
        })
    };
    (0..teeth).filter(reached).collect()
}

/// Modes made for some teeth.
#[derive(Clone, Debug)]
pub struct FittedModes {
    /// The basis with them in place of its own.
    pub basis: Basis,
    /// Rows of these teeth, ascending.
    pub rows: Vec<u32>,
    /// Displacement of each fitted mode in the modes of the basis, mode by mode of the basis.
    pub span: Vec<f64>,
}

/// As many modes as a choice allows within the span of its candidates, made for some teeth.
pub fn made_for(
    basis: &Basis,
    teeth: &[u32],
    choice: &Choice,
) -> Result<FittedModes, ReductionError> {
    let modes = basis.omega.len();
    let of_candidates = basis.omega.iter().take(choice.candidates);
    let candidates = of_candidates.take_while(|w| **w <= choice.highest).count();
    let omega = &basis.omega[..candidates];
    let (mut rows, mut loads) = (Vec::new(), Vec::new());
    let per_node = basis.per_node() as u32;
    for (index, grid) in basis.flanks.grids().iter().enumerate() {
        if teeth.contains(&grid.tooth) {
            let of_node = |node: &u32| node * per_node..(node + 1) * per_node;
            rows.extend(grid.nodes.iter().flat_map(of_node));
            loads.extend(lines::loads(basis, index, choice.even_over_width));
        }
    }
    rows.sort_unstable();
    let count = choice.count.min(candidates);
    if loads.is_empty() || count == 0 {
        let basis = basis.in_span(&[], &[], Vec::new());
        let span = Vec::new();
        return Ok(FittedModes { basis, rows, span });
    }
    let kinds = gram(basis, &loads, candidates);
    let kinds = with_hub(basis, kinds, omega);
    let answers = answers(omega, mean_frequency(&kinds, omega), choice.time);
    let product = Mat::from_fn(candidates, candidates, |i, j| {
        kinds[(i, j)] * answers[(i, j)]
    });
    let failed = || ReductionError::Mismatch("the modes of some teeth do not converge".into());
    let of_answers = (product.self_adjoint_eigen(Side::Lower)).map_err(|_| failed())?;
    // Ascending: the leading ones come last.
    let strengths = of_answers.S().column_vector();
    let least = ROUNDING * strengths[candidates - 1];
    let count = (0..count)
        .take_while(|k| strengths[candidates - 1 - k] > least)
        .count();
    let leading = |i: usize, k: usize| of_answers.U()[(i, candidates - 1 - k)];
    let yielding = Mat::from_fn(candidates, count, |i, k| leading(i, k) / omega[i]);
    let mut compliance = Mat::zeros(count, count);
    multiply(compliance.as_mut(), yielding.transpose(), yielding.as_ref());
    let of_compliance = (compliance.self_adjoint_eigen(Side::Lower)).map_err(|_| failed())?;
    let mut shapes = Mat::zeros(candidates, count);
    let leading = Mat::from_fn(candidates, count, leading);
    multiply(shapes.as_mut(), leading.as_ref(), of_compliance.U());
    // Largest compliance first: lowest frequency.
    let compliances = of_compliance.S().column_vector();
    let from = |k: usize| count - 1 - k;
    let found: Vec<f64> = (0..count)
        .map(|k| compliances[from(k)].sqrt().recip())
        .collect();
    let mut moving = vec![0.0; modes * count];
    let mut span = moving.clone();
    let of_modes = moving
        .chunks_exact_mut(count)
        .zip(span.chunks_exact_mut(count));
    for (i, (moving, span)) in of_modes.take(candidates).enumerate() {
        for k in 0..count {
            moving[k] = shapes[(i, from(k))];
            span[k] = moving[k] * (found[k] / omega[i]).powi(2);
        }
    }
    let basis = basis.in_span(&moving, &span, found);
    Ok(FittedModes { basis, rows, span })
}

fn multiply(out: faer::MatMut<'_, f64>, a: faer::MatRef<'_, f64>, b: faer::MatRef<'_, f64>) {
    matmul(out, Accum::Replace, a, b, 1.0, Par::Seq);
}

/// `sum_f w_f (B^T f) (B^T f)^T`.
fn gram(basis: &Basis, loads: &[Load], candidates: usize) -> Mat<f64> {
    debug_assert!(candidates <= basis.omega.len());
    let rows = Mat::from_fn(loads.len(), candidates, |f, i| {
        loads[f].weight.sqrt() * loads[f].shapes[i]
    });
    let mut out = Mat::zeros(candidates, candidates);
    multiply(out.as_mut(), rows.transpose(), rows.as_ref());
    out
}

/// Adds unit loads on a hub with out-of-plane freedom, each direction with the weight [`FOR_HUB`] relative to the
/// flanks in statics.
fn with_hub(basis: &Basis, mut kinds: Mat<f64>, omega: &[f64]) -> Mat<f64> {
    let Some(lateral) = &basis.lateral else {
        return kinds;
    };
    let of_flanks: f64 = (0..omega.len())
        .map(|i| kinds[(i, i)] / omega[i].powi(2))
        .sum();
    for d in 0..6 {
        let of_mode = |i: usize| lateral.hub[i][d];
        let total: f64 = (0..omega.len())
            .map(|i| (of_mode(i) / omega[i]).powi(2))
            .sum();
        if total > 0.0 {
            let weight = FOR_HUB * of_flanks / total;
            for j in 0..omega.len() {
                for i in 0..omega.len() {
                    kinds[(i, j)] += weight * of_mode(i) * of_mode(j);
                }
            }
        }
    }
    kinds
}

/// Returns the mean angular frequency [rad/s] of the static deflections under these loads, as a body of their own.
fn mean_frequency(kinds: &Mat<f64>, omega: &[f64]) -> f64 {
    let of = |power: i32| -> f64 {
        let all = omega.iter().enumerate();
        all.map(|(i, w)| kinds[(i, i)] / w.powi(power)).sum()
    };
    (of(2) / of(4)).sqrt()
}

/// `sum w(omega) Re( 1/(omega_i^2 + s^2) 1/conj(omega_j^2 + s^2) )`.
fn answers(omega: &[f64], mean: f64, time: f64) -> Mat<f64> {
    let falls = FALLS * mean;
    let sigma = (MEMORY / time).max(LEAST_SIGMA * mean);
    let spacing = SPACING.min(0.5 * sigma / mean);
    let frequencies = (BAND / spacing).ceil() as usize + 1;
    let parts = Mat::from_fn(omega.len(), 2 * frequencies, |i, k| {
        let at = (k / 2) as f64 / (frequencies - 1) as f64 * BAND * mean;
        let weight = 1.0 / (1.0 + (at / falls).powi(2));
        // omega_i^2 + (sigma + j at)^2
        let (re, im) = (omega[i].powi(2) + sigma * sigma - at * at, 2.0 * sigma * at);
        let part = if k.is_multiple_of(2) { re } else { -im };
        weight.sqrt() * part / (re * re + im * im)
    });
    let mut out = Mat::zeros(omega.len(), omega.len());
    multiply(out.as_mut(), parts.as_ref(), parts.transpose());
    out
}
