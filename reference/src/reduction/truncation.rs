//! Residual compliance: the static compliance without the part that the kept modes carry.
//!
//! ```text
//! R = A - B Omega^-2 B^T,     r = a - B Omega^-2 h
//! ```
//!
//! with the shapes `B` at the flank nodes, outwards, and `h` at the hub. `A` holds inward displacements by forces
//! into the teeth, which is the same matrix as outward by outward; `a` outward displacements by unit torque.

use super::error::ReductionError;
use crate::vector::dot;
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use gearbench_models::gear::elastic::deflated::Deflated;
use gearbench_models::gear::elastic::reduced::{FlankCompliance, Residual};

/// Teeth may differ by this fraction of the largest compliance of a node and still count as alike.
const ALIKE: f64 = 1e-6;

/// Kept modes at the flank nodes and the hub.
#[derive(Clone, Copy, Debug)]
pub struct KeptModes<'a> {
    /// Angular frequencies [rad/s].
    pub omega: &'a [f64],
    /// Outward shapes at the flank nodes, `node * modes + mode` [1/sqrt(kg)].
    pub shapes: &'a [f64],
    /// Rotation (displacement) of a free hub in each mode; zeros for a fixed hub.
    pub hub: &'a [f64],
    /// Rows of the teeth that the modes are made for; none where all teeth have the same of them.
    pub made_for: &'a [u32],
}

/// Subtracts the part that the kept modes carry from the static compliance.
pub fn without_modes(total: &Residual, kept: KeptModes<'_>) -> Result<Residual, ReductionError> {
    let (nodes, modes) = (total.hub.len(), kept.omega.len());
    if kept.shapes.len() != nodes * modes || kept.hub.len() != modes {
        return Err(ReductionError::Mismatch(format!(
            "{} shapes and {} hub shapes, expected {modes} modes at {nodes} flank nodes",
            kept.shapes.len(),
            kept.hub.len()
        )));
    }
    if let Some(w) = kept.omega.iter().find(|w| !(w.is_finite() && **w > 0.0)) {
        return Err(ReductionError::Mismatch(format!(
            "a mode of {w:e} rad/s carries no static load: leave rigid motions out"
        )));
    }
    // Static displacement of the flank nodes per root of the load's work on each mode: s = b / omega.
    let s: Vec<f64> = kept
        .shapes
        .iter()
        .enumerate()
        .map(|(i, b)| b / kept.omega[i % modes])
        .collect();
    let h: Vec<f64> = kept
        .hub
        .iter()
        .zip(kept.omega)
        .map(|(h, w)| h / w)
        .collect();
    let at = |node: usize| &s[node * modes..][..modes];
    let mut rest = total.clone();
    for (k, r) in rest.hub.iter_mut().enumerate() {
        *r -= dot(at(k), &h);
    }
    rest.hub_hub -= dot(&h, &h);
    if let FlankCompliance::Cyclic { .. } = &rest.flanks
        && !kept.made_for.is_empty()
        && modes > 0
    {
        let less = Deflated::new(rest.flanks, modes, s, kept.made_for);
        rest.flanks = FlankCompliance::Deflated(Box::new(less));
        return Ok(rest);
    }
    match &mut rest.flanks {
        FlankCompliance::Full(c) => {
            subtract(c, &s, &s, nodes, modes);
            symmetrise(c, nodes);
        }
        FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks,
        } => {
            let (z, m) = (*teeth, *per_tooth);
            alike(&s, largest(blocks, z, m), z, m, modes)?;
            for (d, block) in blocks.chunks_exact_mut(m * m).enumerate() {
                let tooth = &s[d * m * modes..][..m * modes];
                subtract(block, tooth, &s[..m * modes], m, modes);
            }
            symmetrise_blocks(blocks, z, m);
        }
        FlankCompliance::Deflated(_) => {
            return Err(ReductionError::Mismatch(
                "modes are taken from the compliance of a whole mesh, but some were taken before"
                    .into(),
            ));
        }
    }
    Ok(rest)
}

/// `c -= a b^T`, `c` of `m x m`, `a` and `b` of `m x modes`, all row by row.
fn subtract(c: &mut [f64], a: &[f64], b: &[f64], m: usize, modes: usize) {
    if modes == 0 {
        return;
    }
    matmul(
        MatMut::from_row_major_slice_mut(c, m, m),
        Accum::Add,
        MatRef::from_row_major_slice(a, m, modes),
        MatRef::from_row_major_slice(b, m, modes).transpose(),
        -1.0,
        Par::Seq,
    );
}

/// Returns the largest compliance of a node of tooth 0 with itself.
fn largest(blocks: &[f64], z: usize, m: usize) -> f64 {
    debug_assert_eq!(blocks.len(), z * m * m);
    (0..m).map(|i| blocks[i * m + i]).fold(0.0, f64::max)
}

/// Checks that all teeth have equal modes, by the compliance of each node with itself: half a pair leaves nodal
/// diameters.
fn alike(s: &[f64], scale: f64, z: usize, m: usize, modes: usize) -> Result<(), ReductionError> {
    let own = |k: usize| -> f64 { s[k * modes..][..modes].iter().map(|x| x * x).sum() };
    for i in 0..m {
        let first = own(i);
        for tooth in 1..z {
            let other = own(tooth * m + i);
            if (other - first).abs() > ALIKE * scale {
                return Err(ReductionError::Mismatch(format!(
                    "the kept modes give flank node {i} of tooth 1 the compliance {first:.6e} m/N, that of tooth {} \
                     {other:.6e} m/N: keep both modes of a pair of equal frequency, or neither",
                    tooth + 1
                )));
            }
        }
    }
    Ok(())
}

/// Takes the mean of a matrix of `n x n` and its transposed: symmetric up to rounding before, exactly after.
pub(super) fn symmetrise(c: &mut [f64], n: usize) {
    for i in 0..n {
        for j in 0..i {
            let mean = 0.5 * (c[i * n + j] + c[j * n + i]);
            c[i * n + j] = mean;
            c[j * n + i] = mean;
        }
    }
}

/// Symmetrises the blocks of a cyclic gear: block `z - d` is block `d` transposed.
pub(super) fn symmetrise_blocks(blocks: &mut [f64], z: usize, m: usize) {
    for d in 0..=z / 2 {
        let opposite = (z - d) % z;
        for i in 0..m {
            for j in 0..m {
                let (a, b) = ((d * m + i) * m + j, (opposite * m + j) * m + i);
                let mean = 0.5 * (blocks[a] + blocks[b]);
                blocks[a] = mean;
                blocks[b] = mean;
            }
        }
    }
}
