//! Modes that are made for the teeth of a gear that can touch, where it turns by less than a pitch: an impact.
//!
//! A hundred eigenmodes give each of twenty teeth five shapes, and a helical tooth, which is struck along lines that cross
//! its flank, answers with more. What flanks of few teeth do lies close to a much smaller space within that of the eigenmodes,
//! and the modes of the gear within it are oscillators like any others (Ritz; M. Geradin, D. J. Rixen, *Mechanical Vibrations*,
//! 3rd ed. 2015, section 2.9). A load `f` on the flanks moves the modes by
//!
//! ```text
//! q(s) = (Omega^2 + s^2)^-1 B^T f,   s = sigma + j omega
//! ```
//!
//! and the space is that of the leading eigenvectors of
//!
//! ```text
//! P = Omega sum_f sum_omega w_f w(omega) Re( q(s) q(s)^H ) Omega
//! ```
//!
//! over forces that lie along the lines of contact of these teeth, evenly and rising along each, and over the band of an impact:
//! proper orthogonal decomposition in the norm of the strain energy (K. Willcox, J. Peraire, *AIAA J.* 40 (2002) 2323), where
//! `sigma` stands for the end of the run. With `U` the leading eigenvectors the shapes `Omega^-1 U` have the stiffness 1 and the
//! mass `U^T Omega^-2 U`, whose eigenvectors diagonalise both. Frequencies lie among those of the eigenmodes.

use super::lines::{self, Load};
use super::{Choice, FOR_HUB};
use crate::reduction::{Basis, ReductionError};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par, Side};
use gearbench_models::gear::table::GearContext;
use gearbench_models::geometry::Side as FlankSide;
use gearbench_models::spec::Body;
use std::f64::consts::{PI, TAU};

/// Damping `sigma`, where forces fall off, and the end of the band, over the mean frequency of the flanks' compliance.
const SIGMA: f64 = 0.1;
const FALLS: f64 = 2.0;
const BAND: f64 = 6.0;
/// Frequencies in the band.
const FREQUENCIES: usize = 61;
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
    /// Coefficients of each fitted mode in the modes of the basis, mode by mode of the basis.
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
        let basis = basis.in_span(&[], Vec::new());
        let span = Vec::new();
        return Ok(FittedModes { basis, rows, span });
    }
    let kinds = gram(basis, &loads, candidates);
    let kinds = with_hub(basis, kinds, omega);
    let answers = answers(omega, mean_frequency(&kinds, omega));
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
    let leading = Mat::from_fn(candidates, count, |i, k| {
        of_answers.U()[(i, candidates - 1 - k)] / omega[i]
    });
    let mut mass = Mat::zeros(count, count);
    multiply(mass.as_mut(), leading.transpose(), leading.as_ref());
    let of_mass = (mass.self_adjoint_eigen(Side::Lower)).map_err(|_| failed())?;
    let mut shapes = Mat::zeros(candidates, count);
    multiply(shapes.as_mut(), leading.as_ref(), of_mass.U());
    // Largest mass over stiffness 1: lowest frequency.
    let masses = of_mass.S().column_vector();
    let from = |k: usize| count - 1 - k;
    let found: Vec<f64> = (0..count).map(|k| 1.0 / masses[from(k)].sqrt()).collect();
    let mut v = vec![0.0; modes * count];
    for (i, row) in v.chunks_exact_mut(count).take(candidates).enumerate() {
        for (k, v) in row.iter_mut().enumerate() {
            *v = shapes[(i, from(k))] * found[k];
        }
    }
    let basis = basis.in_span(&v, found);
    let span = v;
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

/// `omega_i omega_j sum w(omega) Re( 1/(omega_i^2 + s^2) 1/conj(omega_j^2 + s^2) )`.
fn answers(omega: &[f64], mean: f64) -> Mat<f64> {
    let falls = FALLS * mean;
    let parts = Mat::from_fn(omega.len(), 2 * FREQUENCIES, |i, k| {
        let at = (k / 2) as f64 / (FREQUENCIES - 1) as f64 * BAND * mean;
        let weight = 1.0 / (1.0 + (at / falls).powi(2));
        let sigma = SIGMA * mean;
        // omega_i^2 + (sigma + j at)^2
        let (re, im) = (omega[i].powi(2) + sigma * sigma - at * at, 2.0 * sigma * at);
        let part = if k.is_multiple_of(2) { re } else { -im };
        weight.sqrt() * omega[i] * part / (re * re + im * im)
    });
    let mut out = Mat::zeros(omega.len(), omega.len());
    multiply(out.as_mut(), parts.as_ref(), parts.transpose());
    out
}
