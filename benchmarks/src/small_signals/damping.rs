//! Damping of the natural modes of a linearised scene.
//!
//! With orthonormal modes `Phi` in coordinates of unit mass the damping matrix is `d = Phi^T D Phi`. If it is diagonal
//! the damping ratios are exactly `d_ii / (2 omega_i)`. Dampers that couple modes, and gyroscopic terms, which are
//! skew, require the eigenvalues of the first-order system,
//!
//! ```text
//! |  0      1 |            z = -zeta omega +- i omega sqrt(1 - zeta^2)
//! | -Omega^2 -d |
//! ```
//!
//! each assigned to the mode with the largest component in its eigenvector. For more coordinates than [`MOST`] the
//! diagonal is used.

use faer::Mat;
use nalgebra::DMatrix;

/// Largest number of coordinates for the eigenvalues of the first-order system.
const MOST: usize = 260;
/// Coupling of modes, relative to the largest damping, that counts as zero.
const COUPLED: f64 = 1e-9;
/// Share of the highest frequency below which a mode counts as rigid.
const SLACK: f64 = 1e-6;

/// Damping ratio and damped frequency of a mode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damped {
    /// Damping ratio, relative to critical damping [-].
    pub ratio: f64,
    /// Angular frequency [rad/s], if it differs from the undamped one.
    pub omega: Option<f64>,
}

/// Computes the damping of modes from their angular frequencies [rad/s], zero for rigid-body motions, and `d` [1/s].
pub fn damped(omega: &[f64], d: &DMatrix<f64>) -> Vec<Option<Damped>> {
    let highest = omega.iter().fold(0.0_f64, |m, w| m.max(*w));
    let swings = |i: usize| omega[i] > SLACK * highest;
    let n = omega.len();
    let largest = d.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let coupled = |i: usize| (0..n).any(|j| i != j && d[(i, j)].abs() > COUPLED * largest);
    let diagonal = |i: usize| {
        swings(i).then(|| Damped {
            ratio: 0.5 * d[(i, i)] / omega[i],
            omega: None,
        })
    };
    let mut found: Vec<_> = (0..n).map(diagonal).collect();
    if n > MOST || !(0..n).any(coupled) {
        return found;
    }
    for (mode, z) in in_first_order(omega, d, highest) {
        let size = z[0].hypot(z[1]);
        if swings(mode) && size > 0.0 {
            found[mode] = Some(Damped {
                ratio: -z[0] / size,
                omega: Some(z[1]),
            });
        }
    }
    found
}

/// Eigenvalues `[re, im]` [1/s] with `im >= 0` and the modes that they belong to.
fn in_first_order(omega: &[f64], d: &DMatrix<f64>, highest: f64) -> Vec<(usize, [f64; 2])> {
    let n = omega.len();
    // In units of the fastest mode's time entries are of size one.
    let matrix = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) => 0.0,
        (true, false) => f64::from(u8::from(i == j - n)),
        (false, true) if i - n == j => -(omega[j] / highest).powi(2),
        (false, true) => 0.0,
        (false, false) => -d[(i - n, j - n)] / highest,
    });
    let Ok(eigen) = matrix.eigen() else {
        return Vec::new();
    };
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let mut parts: Vec<(f64, usize, usize)> = Vec::new();
    for k in 0..2 * n {
        // An overdamped mode has two real values: the slower one is kept.
        if values[k].im < 0.0 {
            continue;
        }
        let size = |i: usize| vectors[(i, k)].re.hypot(vectors[(i, k)].im).powi(2);
        let all: f64 = (0..n).map(size).sum();
        parts.extend((0..n).map(|i| (size(i) / all.max(f64::MIN_POSITIVE), i, k)));
    }
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (mut modes, mut taken) = (vec![false; n], vec![false; 2 * n]);
    let mut found = Vec::new();
    for (_, i, k) in parts {
        if !modes[i] && !taken[k] {
            (modes[i], taken[k]) = (true, true);
            found.push((i, [values[k].re * highest, values[k].im * highest]));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two modes that a damper couples: the roots of the characteristic polynomial; and a gyroscopic pair,
    /// `omega sqrt(1 + g^2) +- omega g` with `g = G / (2 omega)`.
    #[test]
    fn coupled_modes_have_the_roots_of_their_polynomial() {
        let d = DMatrix::from_row_slice(2, 2, &[0.4, 0.3, 0.3, 0.9]);
        let omega = [2.0, 5.0];
        for (damped, w) in damped(&omega, &d).iter().zip(omega) {
            let found = damped.unwrap();
            let im = found.omega.unwrap();
            let size = im / (1.0 - found.ratio.powi(2)).sqrt();
            let z = faer::c64::new(-found.ratio * size, im);
            let of = |w: f64, d: f64| z * z + z * d + w * w;
            let left = of(2.0, 0.4) * of(5.0, 0.9) - z * z * 0.09;
            assert!(left.re.hypot(left.im) < 1e-10 * w.powi(4), "{left:?}");
        }
        let (w, g) = (3.0, 0.5);
        let spin = DMatrix::from_row_slice(2, 2, &[0.0, g, -g, 0.0]);
        let found: Vec<f64> = (damped(&[w, w], &spin).iter())
            .map(|d| d.unwrap().omega.unwrap())
            .collect();
        let (root, half) = ((w * w + 0.25 * g * g).sqrt(), 0.5 * g);
        let mut exact = [root - half, root + half];
        if found[0] > found[1] {
            exact.reverse();
        }
        for (f, e) in found.iter().zip(exact) {
            assert!((f / e - 1.0).abs() < 1e-12, "{f} for {e}");
        }
    }
}
