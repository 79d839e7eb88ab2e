//! The path of contact, and the pairs in contact along it, in parallel.

use super::curve::{PairOrMesh, StiffnessCurve};
use super::error::{StiffnessError, positive};
use crate::geometry::Pair;

/// Path of contact of a pair, for its stiffness curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Path {
    /// Start of contact (m).
    pub start: f64,
    /// End of contact (m).
    pub end: f64,
    /// Transverse base pitch, the distance of successive pairs (m).
    pub base_pitch: f64,
}

impl From<&Pair> for Path {
    fn from(pair: &Pair) -> Self {
        Path {
            start: pair.s_start(),
            end: pair.s_end(),
            base_pitch: pair.base_pitch(),
        }
    }
}

impl Path {
    /// Returns the transverse contact ratio.
    pub fn contact_ratio(&self) -> f64 {
        (self.end - self.start) / self.base_pitch
    }

    /// Returns the path coordinates (m) of all pairs in contact when one pair is at `s` (m).
    pub fn pairs_in_contact(&self, s: f64) -> impl Iterator<Item = f64> + use<> {
        let Path {
            start,
            end,
            base_pitch,
        } = *self;
        let before = ((s - start) / base_pitch).floor();
        let first = s - before * base_pitch;
        (0..)
            .map(move |j| first + f64::from(j) * base_pitch)
            .take_while(move |&at| at <= end)
    }

    pub(super) fn check(&self) -> Result<(), StiffnessError> {
        positive("base pitch [m]", self.base_pitch)?;
        if self.start.is_finite() && self.end.is_finite() && self.end > self.start {
            return Ok(());
        }
        Err(StiffnessError::Path {
            start: self.start,
            end: self.end,
        })
    }
}

/// Returns the stiffness of the mesh (N/m) when one pair is at `s` (m): the force of all pairs in contact per common
/// approach, or the curve itself when it is that of the mesh.
pub fn mesh_stiffness(curve: &StiffnessCurve, path: impl Into<Path>, s: f64) -> f64 {
    match curve.of() {
        PairOrMesh::Mesh => curve.eval(s).0,
        PairOrMesh::Pair => {
            let at: Vec<f64> = path.into().pairs_in_contact(s).collect();
            pressed_together(curve, &at).iter().sum()
        }
    }
}

/// Returns the path coordinate (m) and the load share of every pair in contact when one pair is at `s` (m), for flanks
/// without deviations; equal shares for the stiffness of a mesh.
pub fn load_shares(curve: &StiffnessCurve, path: impl Into<Path>, s: f64) -> Vec<(f64, f64)> {
    let at: Vec<f64> = path.into().pairs_in_contact(s).collect();
    let weights = match curve.of() {
        PairOrMesh::Mesh => vec![1.0; at.len()],
        PairOrMesh::Pair => pressed_together(curve, &at),
    };
    let total: f64 = weights.iter().sum();
    at.into_iter()
        .zip(weights.iter().map(|w| w / total))
        .collect()
}

/// Returns the forces (N/m) of the pairs at the path coordinates `at` (m), one base pitch apart, per common approach:
/// the solution of `C N = 1` with the compliances of the pairs and between them, over the loaded pairs.
fn pressed_together(curve: &StiffnessCurve, at: &[f64]) -> Vec<f64> {
    let mut pressing: Vec<usize> = (0..at.len()).collect();
    loop {
        let n = pressing.len();
        let mut c = vec![0.0; n * n];
        for (row, &i) in pressing.iter().enumerate() {
            c[row * n + row] = 1.0 / curve.eval(at[i]).0;
            for (column, &j) in pressing.iter().enumerate().take(row) {
                let (between, _) = curve.coupling(i - j, 0.5 * (at[i] + at[j]));
                c[row * n + column] = between;
                c[column * n + row] = between;
            }
        }
        let mut forces = vec![1.0; n];
        eliminate(&mut c, &mut forces);
        // A pair that its neighbours bend away from its mate carries nothing.
        let lifted = (0..n).min_by(|&i, &j| forces[i].total_cmp(&forces[j]));
        match lifted {
            Some(row) if forces[row] < 0.0 && n > 1 => {
                pressing.remove(row);
            }
            _ => {
                let mut all = vec![0.0; at.len()];
                for (&i, force) in pressing.iter().zip(forces) {
                    all[i] = force;
                }
                return all;
            }
        }
    }
}

/// Solves a small symmetric positive definite system by Gaussian elimination, row by row.
fn eliminate(c: &mut [f64], b: &mut [f64]) {
    let n = b.len();
    for k in 0..n {
        for i in k + 1..n {
            let factor = c[i * n + k] / c[k * n + k];
            for j in k..n {
                c[i * n + j] -= factor * c[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| c[k * n + j] * b[j]).sum();
        b[k] = (b[k] - known) / c[k * n + k];
    }
}
