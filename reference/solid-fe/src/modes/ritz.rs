//! Modes within the span of given shapes, by the method of Rayleigh and Ritz.
//!
//! With the shapes `V` as columns and `W = V S` orthonormal in M, the modes are `W Y` with the eigenvectors `Y` of
//! `W^T K W`. An error `e` of the shapes, such as that of printed digits, is an error `e^2` of the squared frequencies.
//! Frequencies are never below those of the body.

use super::{Modes, ModesError, Report, Symmetric, Target, dense};
use crate::assembly::tie::Reduced;
use crate::limits;
use faer::{Mat, MatRef};

/// Least share of a direction of the span that counts as independent of the others, as a squared length.
const INDEPENDENT: f64 = 1e-10;

/// The lowest modes within the span of shapes, or all up to a bound.
pub fn ritz(pair: &Reduced, shapes: MatRef<'_, f64>, target: Target) -> Result<Modes, ModesError> {
    let (k, m) = (
        Symmetric::new(pair.stiffness.as_ref())?,
        Symmetric::new(pair.mass.as_ref())?,
    );
    let (n, count) = (k.size(), shapes.ncols());
    let what = format!("{count} shapes of {n} unknowns");
    limits::check(what, 40.0 * count as f64 * n as f64, "give fewer shapes")?;
    let mut image = Mat::zeros(n, count);
    m.apply(shapes, image.as_mut());
    let gram = shapes.transpose() * &image;
    let lengths: Vec<f64> = (0..count).map(|i| gram[(i, i)].max(0.0).sqrt()).collect();
    let scaled = Mat::from_fn(count, count, |i, j| match lengths[i] * lengths[j] {
        l if l > 0.0 => gram[(i, j)] / l,
        _ => 0.0,
    });
    let (lengths2, directions) = dense::eigen(scaled.as_ref())?;
    let largest = lengths2.last().copied().unwrap_or(0.0);
    let first = lengths2.partition_point(|l| *l <= INDEPENDENT * largest);
    let kept = count - first;
    let basis = Mat::from_fn(count, kept, |i, j| match lengths[i] {
        l if l > 0.0 => directions[(i, first + j)] / (l * lengths2[first + j].sqrt()),
        _ => 0.0,
    });
    let basis = shapes * &basis;
    let mut image = Mat::zeros(n, kept);
    k.apply(basis.as_ref(), image.as_mut());
    let (omega2, mix) = dense::eigen((basis.transpose() * &image).as_ref())?;
    let count = match target {
        Target::Count(wanted) => wanted.min(kept),
        Target::Above(bound) => omega2.partition_point(|w2| *w2 <= bound),
    };
    let vectors = &basis * mix.subcols(0, count);
    let mut force = Mat::zeros(n, count);
    k.apply(vectors.as_ref(), force.as_mut());
    let mut inertia = Mat::zeros(n, count);
    m.apply(vectors.as_ref(), inertia.as_mut());
    let residuals = (0..count).map(|j| {
        let (f, i) = (force.col(j), inertia.col(j));
        let rest: f64 = (f.iter().zip(i.iter()))
            .map(|(f, i)| (f - omega2[j] * i).powi(2))
            .sum();
        (rest / f.squared_norm_l2()).sqrt()
    });
    Ok(Modes {
        residuals: residuals.collect(),
        omega2: omega2[..count].to_vec(),
        vectors,
        report: Report::default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::modes::{Options, lowest};
    use faer::sparse::{SparseColMat, Triplet};

    /// A chain of masses between walls: the span of its own modes, mixed, doubled and with an error, has them again.
    #[test]
    fn own_modes_come_back_from_their_span() {
        let n = 40;
        let k: Vec<_> = (0..n)
            .flat_map(|i| {
                let next = (i + 1 < n).then(|| Triplet::new(i + 1, i, -1.0));
                [Some(Triplet::new(i, i, 2.0)), next].into_iter().flatten()
            })
            .collect();
        let m: Vec<_> = (0..n)
            .map(|i| Triplet::new(i, i, 1.0 + 0.1 * (i % 3) as f64))
            .collect();
        let matrix = |t: &[_]| SparseColMat::<usize, f64>::try_new_from_triplets(n, n, t).unwrap();
        let pair = Reduced {
            stiffness: matrix(&k),
            mass: matrix(&m),
        };
        let exact = lowest(&pair, 6, &Options::default()).unwrap();
        let error = 1e-6;
        let shapes = Mat::from_fn(n, 12, |i, j| {
            let own = exact.vectors[(i, j % 6)] + 2.0 * exact.vectors[(i, (j + 1) % 6)];
            7.0 * own * (1.0 + error * ((3 * i + 5 * (j % 6)) as f64).sin())
        });
        let found = ritz(&pair, shapes.as_ref(), Target::Count(6)).unwrap();
        for (a, b) in found.omega2.iter().zip(&exact.omega2) {
            assert!(*a >= b * (1.0 - 1e-13) && a / b - 1.0 < 1e-9, "{a} {b}");
        }
        let mass = found.vectors.transpose()
            * &Mat::from_fn(n, 6, |i, j| {
                (1.0 + 0.1 * (i % 3) as f64) * found.vectors[(i, j)]
            });
        for i in 0..6 {
            for j in 0..6 {
                let one = f64::from(u8::from(i == j));
                assert!((mass[(i, j)] - one).abs() < 1e-9);
            }
        }
        assert!(
            found.residuals.iter().all(|r| *r < 1e-3),
            "{:?}",
            found.residuals
        );
    }
}
