//! The highest eigenfrequency with lumped masses, from above: it bounds the step of explicit integration,
//! `h < 2 / omega`.
//!
//! Lanczos steps on `A = P M^-1/2 K M^-1/2 P` over all nodes, `P` the projection onto what the tie leaves free.
//! Ritz values approach the largest eigenvalue from below. With a start of uniform direction `k` of them miss it
//! by more than the fraction `e` only with a probability below `1.648 sqrt(n) exp(-(2 k - 1) sqrt(e))`, whatever
//! the spectrum (J. Kuczynski, H. Wozniakowski, *SIAM J. Matrix Anal. Appl.* 13 (1992) 1094). The number of
//! steps follows from that, and the Ritz value is divided by `1 - e`. Gershgorin's row sums are a bound without
//! chance but coarse: the lower of the two counts.

use super::tie::Tie;
use super::{Assembly, BlockMatrix};
use nalgebra::DMatrix;

/// Fraction `e` of the squared frequency that is added: the result is at most 1 % too high.
const FRACTION: f64 = 0.02;
/// Accepted probability that the true value lies higher.
const CHANCE: f64 = 1e-9;

/// Highest eigenfrequency [rad/s] of a tied mesh with its lumped masses, from above.
///
/// It lies above the true one (with probability 1e-9 otherwise) by at most 1 %. Inertia that is added at the hub can
/// only lower the true one; consistent masses would make it higher. Central differences are stable up to the step
/// `2 / omega`. Zero for a mesh without free motion.
#[must_use]
pub fn highest_frequency(assembly: &Assembly, tie: &Tie) -> f64 {
    let scale: Vec<f64> = assembly
        .lumped
        .iter()
        .map(|&m| if m > 0.0 { 1.0 / m.sqrt() } else { 0.0 })
        .collect();
    let projection = Projection::new(assembly, tie);
    let n = 3 * scale.len();
    let wanted = 1.0 + ((1.648 * (n as f64).sqrt() / CHANCE).ln() / FRACTION.sqrt() + 1.0) / 2.0;
    let ritz = largest_ritz(&assembly.stiffness, &scale, &projection, wanted as usize);
    (ritz / (1.0 - FRACTION))
        .min(row_sums(&assembly.stiffness, &scale))
        .sqrt()
}

/// Largest row sum of absolute values of `M^-1/2 K M^-1/2`.
fn row_sums(k: &BlockMatrix, scale: &[f64]) -> f64 {
    let mut sums = vec![[0.0_f64; 3]; scale.len()];
    for (row, column, place) in k.pattern().iter() {
        let size = scale[row] * scale[column];
        let b = &k.blocks()[place];
        for i in 0..3 {
            for j in 0..3 {
                let x = size * b[3 * i + j].abs();
                sums[row][i] += x;
                if row != column {
                    sums[column][j] += x;
                }
            }
        }
    }
    sums.iter().flatten().fold(0.0, |m, x| m.max(*x))
}

/// Projection of scaled displacements `M^1/2 u` onto those that the tie allows.
struct Projection {
    /// Held nodes.
    held: Vec<usize>,
    /// Orthonormal motions of the held nodes with the hub, three entries per held node.
    motions: Vec<Vec<f64>>,
}

impl Projection {
    fn new(assembly: &Assembly, tie: &Tie) -> Self {
        let places = tie.places();
        let held: Vec<usize> = (0..places.len())
            .filter(|&i| places[i] == Tie::HELD)
            .collect();
        let mut full = vec![0.0; 3 * places.len()];
        let mut reduced = vec![0.0; tie.coordinates()];
        let mut motions: Vec<Vec<f64>> = Vec::new();
        for hub in 3 * tie.free().len()..tie.coordinates() {
            reduced.fill(0.0);
            reduced[hub] = 1.0;
            tie.expand(&reduced, &mut full);
            let mut w: Vec<f64> = held
                .iter()
                .flat_map(|&i| {
                    let m = assembly.lumped[i].max(0.0).sqrt();
                    [m * full[3 * i], m * full[3 * i + 1], m * full[3 * i + 2]]
                })
                .collect();
            let before = dot(&w, &w).sqrt();
            for _ in 0..2 {
                for q in &motions {
                    let part = dot(q, &w);
                    w.iter_mut().zip(q).for_each(|(w, q)| *w -= part * q);
                }
            }
            // A motion that is one of the others, or moves no mass, adds nothing.
            let size = dot(&w, &w).sqrt();
            if size > 1e-9 * before {
                w.iter_mut().for_each(|w| *w /= size);
                motions.push(w);
            }
        }
        Projection { held, motions }
    }

    fn apply(&self, w: &mut [f64], scratch: &mut Vec<f64>) {
        scratch.clear();
        for &i in &self.held {
            scratch.extend_from_slice(&w[3 * i..][..3]);
            w[3 * i..][..3].fill(0.0);
        }
        for q in &self.motions {
            let part = dot(q, scratch);
            for (&i, q) in self.held.iter().zip(q.chunks_exact(3)) {
                for axis in 0..3 {
                    w[3 * i + axis] += part * q[axis];
                }
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Largest Ritz value after at most `steps` Lanczos steps. Without reorthogonalisation: copies of converged
/// values do not harm the largest.
fn largest_ritz(k: &BlockMatrix, scale: &[f64], projection: &Projection, steps: usize) -> f64 {
    let n = 3 * scale.len();
    let mut held = Vec::new();
    let mut v = normal_numbers(n);
    projection.apply(&mut v, &mut held);
    let mut before = vec![0.0; n];
    let (mut scaled, mut image) = (vec![0.0; n], vec![0.0; n]);
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    let mut size = dot(&v, &v).sqrt();
    let start = size;
    for _ in 0..steps {
        if size <= 1e-14 * start {
            break;
        }
        v.iter_mut().for_each(|v| *v /= size);
        for (i, s) in scaled.iter_mut().enumerate() {
            *s = scale[i / 3] * v[i];
        }
        k.apply(&scaled, &mut image);
        for (i, y) in image.iter_mut().enumerate() {
            *y *= scale[i / 3];
        }
        projection.apply(&mut image, &mut held);
        let own = dot(&v, &image);
        let last = beside.last().copied().unwrap_or(0.0);
        for i in 0..n {
            image[i] -= own * v[i] + last * before[i];
        }
        diagonal.push(own);
        size = dot(&image, &image).sqrt();
        beside.push(size);
        std::mem::swap(&mut before, &mut v);
        std::mem::swap(&mut v, &mut image);
    }
    let m = diagonal.len();
    if m == 0 {
        return 0.0;
    }
    let mut tridiagonal = DMatrix::zeros(m, m);
    for i in 0..m {
        tridiagonal[(i, i)] = diagonal[i];
        if i + 1 < m {
            tridiagonal[(i, i + 1)] = beside[i];
            tridiagonal[(i + 1, i)] = beside[i];
        }
    }
    tridiagonal
        .symmetric_eigenvalues()
        .iter()
        .fold(0.0, |m: f64, x| m.max(*x))
}

/// Normally distributed numbers (Box and Muller on splitmix64), the same in every run: their direction is uniform.
fn normal_numbers(n: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut uniform = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..n)
        .map(|_| {
            let radius = (-2.0 * (1.0 - uniform()).ln()).sqrt();
            radius * (std::f64::consts::TAU * uniform()).cos()
        })
        .collect()
}
