//! Covariance of a fit whose residuals are correlated, and the degrees of freedom of each variance.
//!
//! A fit by least squares stays what it is; its covariance is that of a linear estimator of correlated data,
//!
//! ```text
//! C = B (sum_d J_d^T G_d J_d) B,     B = (J^T J)^+
//! ```
//!
//! with `G_d` the covariance of the residuals of data set `d` ([`super::noise`]): the sandwich of H. White,
//! *Econometrica* 48 (1980) 817, with a fitted process in its middle in place of lagged products, which cannot follow
//! residuals that are correlated over a good part of the data. `J^T J` may be singular: `B` leaves out what the data do
//! not determine at all ([`super::identifiable`]).
//!
//! Where neighbouring residuals are nearly one, means of some neighbours stand for them: a process of low order follows
//! what happens from sample to sample, and what moves smooth sensitivities is what happens over many.
//!
//! The variance of a parameter is itself estimated. By F. E. Satterthwaite (*Biometrics Bull.* 2 (1946) 110) it has as many
//! degrees of freedom as a chi-squared variable of the same relative variance, `2 v^2 / var(v)`, where `var(v)` follows
//! from the information on the process.

use super::coordinates::{Coordinate, Scale};
use super::levenberg_marquardt::Minimum;
use super::noise::{self, Noise};
use super::student::two_sided;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Singular value over the greatest below which a direction is not determined at all: the accuracy of differences of
/// integrated residuals.
pub const RANK: f64 = 1e-4;
/// Residuals and derivatives below this part of the greatest are negligible: without contact of the flanks the data
/// have no information.
const NOTHING: f64 = 1e-9;

/// Uncertainty of the coordinates of a fit: covariance, degrees of freedom and 95 % intervals.
#[derive(Clone, Debug)]
pub struct Uncertainty {
    /// True for coordinates with a linear scale, in place of a logarithmic one.
    pub linear: Vec<bool>,
    /// Indices of the coordinates that are free and not on a bound.
    pub moving: Vec<usize>,
    /// Covariance of all coordinates; zero for fixed ones and those on a bound.
    pub covariance: DMatrix<f64>,
    /// Matrix `B` of all coordinates.
    pub inverse: DMatrix<f64>,
    /// Degrees of freedom of each variance, one per coordinate.
    pub freedom: Vec<f64>,
    /// Half widths of the 95 % intervals.
    pub half: Vec<f64>,
    /// Noise process of each data set; `None` where its residuals vanish.
    pub noise: Vec<Option<Noise>>,
    /// Singular values of the Jacobian over the moving coordinates, descending.
    pub singular: Vec<f64>,
    /// Directions that the data do not determine at all, over all coordinates.
    pub empty: Vec<Vec<f64>>,
}

/// Autocorrelation above which neighbours are replaced by their mean, and the least number of samples that remains.
const ALIKE: (f64, usize) = (0.8, 64);

/// Degrees of freedom at least: fewer come of the quadratic expansion about a process that is correlated over much of the
/// data, not of the data. `gearbench-validation coverage` measures that intervals hold with it.
const LEAST_FREEDOM: f64 = 6.0;

/// A data set: its part of the residuals in which there is anything, its columns, its process.
struct Block {
    /// Number of neighbours in a mean.
    of: f64,
    columns: DMatrix<f64>,
    residuals: Vec<f64>,
    basis: DMatrix<f64>,
    noise: Option<Noise>,
}

/// Returns the rows of a data set from the first to the last with a residual or derivative that is not negligible.
fn telling(minimum: &Minimum, rows: Range<usize>) -> Range<usize> {
    let largest = |m: &mut dyn Iterator<Item = f64>| m.fold(0.0_f64, |a, x| a.max(x.abs()));
    let of_r = NOTHING * largest(&mut minimum.residuals.iter().copied());
    let of_j = NOTHING * largest(&mut minimum.jacobian.iter().copied());
    let tells = |i: &usize| {
        minimum.residuals[*i].abs() > of_r
            || minimum.jacobian.row(*i).iter().any(|x| x.abs() > of_j)
    };
    let first = rows.clone().find(tells).unwrap_or(rows.start);
    let last = rows.clone().rev().find(tells).map_or(first, |i| i + 1);
    first..last
}

/// Returns the number of neighbours that are replaced by their mean, because they are almost equal.
fn block_length(e: &[f64]) -> usize {
    let square: f64 = e.iter().map(|x| x * x).sum();
    let correlated = |lag: usize| {
        let lagged: f64 = e.iter().zip(&e[lag..]).map(|(a, b)| a * b).sum();
        lagged > ALIKE.0 * square
    };
    let most = (e.len() / ALIKE.1).max(1);
    (1..most).find(|&lag| !correlated(lag)).unwrap_or(most)
}

/// Means of neighbours, those at the end left out that are too few for one.
fn means(x: impl Iterator<Item = f64>, of: usize) -> Vec<f64> {
    let all: Vec<f64> = x.collect();
    let mean = |part: &[f64]| part.iter().sum::<f64>() / of as f64;
    all.chunks_exact(of).map(mean).collect()
}

/// Orthonormal basis of the columns of a matrix.
fn basis(columns: &DMatrix<f64>) -> DMatrix<f64> {
    if columns.is_empty() {
        return DMatrix::zeros(columns.nrows(), 0);
    }
    let svd = columns.clone().svd(true, false);
    let greatest = svd.singular_values.iter().copied().fold(0.0, f64::max);
    let Some(u) = svd.u else {
        return DMatrix::zeros(columns.nrows(), 0);
    };
    let kept: Vec<usize> = (0..svd.singular_values.len())
        .filter(|&i| svd.singular_values[i] > RANK * greatest && greatest > 0.0)
        .collect();
    u.select_columns(&kept)
}

/// `G c` for a symmetric Toeplitz matrix of autocovariances.
fn toeplitz(g: &[f64], c: &DVector<f64>) -> DVector<f64> {
    let n = c.len();
    DVector::from_fn(n, |i, _| {
        (0..n).map(|j| g[i.abs_diff(j)] * c[j]).sum::<f64>()
    })
}

impl Block {
    /// `c_i^T G c_j` for the columns of a matrix.
    fn middle(&self, g: &[f64], c: &DMatrix<f64>) -> DMatrix<f64> {
        let mut through = c.clone();
        for j in 0..c.ncols() {
            through.set_column(j, &toeplitz(g, &c.column(j).into_owned()));
        }
        c.tr_mul(&through)
    }

    /// Returns the diagonal of `c^T G c` for the process at other partial autocorrelations, with the corresponding
    /// variance.
    fn at(&self, a: &[f64], noise: &Noise, c: &DMatrix<f64>) -> DVector<f64> {
        let variance = noise::restricted(a, &self.residuals, &self.basis).1;
        let moved = Noise {
            a: a.to_vec(),
            variance,
            ..noise.clone()
        };
        self.middle(&moved.autocovariance(c.nrows()), c).diagonal()
    }
}

/// Computes the uncertainty of a fit to data sets with `blocks` residuals each.
pub fn uncertainty(
    minimum: &Minimum,
    (coordinates, free): (&[Coordinate], &[bool]),
    blocks: &[usize],
    level: f64,
) -> Uncertainty {
    let p = minimum.z.len();
    let moving: Vec<usize> = (0..p)
        .filter(|&j| free[j] && !minimum.at_bound[j])
        .collect();
    let q = moving.len();
    let jacobian = minimum.jacobian.select_columns(&moving);

    // The pseudo-inverse of J^T J, and the directions that it excludes.
    let normal = jacobian.tr_mul(&jacobian);
    // All parameters may be held, or at bounds.
    let (eigenvalues, v) = match q {
        0 => (DVector::zeros(0), DMatrix::zeros(0, 0)),
        _ => {
            let eigen = normal.symmetric_eigen();
            (eigen.eigenvalues, eigen.eigenvectors)
        }
    };
    let greatest = eigenvalues.iter().copied().fold(0.0, f64::max);
    let mut order: Vec<usize> = (0..q).collect();
    order.sort_by(|&a, &b| eigenvalues[b].total_cmp(&eigenvalues[a]));
    let value = |i: usize| eigenvalues[i].max(0.0);
    let known = |i: usize| greatest > 0.0 && value(i) > RANK * RANK * greatest;
    let inverted = DVector::from_fn(q, |i, _| if known(i) { 1.0 / value(i) } else { 0.0 });
    let inverse = &v * DMatrix::from_diagonal(&inverted) * v.transpose();
    let whole = |part: &DVector<f64>| {
        let mut all = vec![0.0; p];
        moving
            .iter()
            .zip(part.iter())
            .for_each(|(&j, x)| all[j] = *x);
        all
    };
    let empty = (order.iter())
        .filter(|&&i| !known(i))
        .map(|&i| whole(&v.column(i).into_owned()))
        .collect();

    let mut start = 0;
    let blocks: Vec<Block> = (blocks.iter())
        .map(|&length| {
            let rows = telling(minimum, start..start + length);
            start += length;
            let columns = jacobian.rows(rows.start, rows.len()).into_owned();
            let residuals: Vec<f64> = minimum.residuals.as_slice()[rows].to_vec();
            let of = block_length(&residuals);
            let residuals = means(residuals.into_iter(), of);
            let columns: Vec<f64> = (0..q)
                .flat_map(|j| means(columns.column(j).iter().copied(), of))
                .collect();
            let columns = DMatrix::from_vec(residuals.len(), q, columns);
            let basis = basis(&columns);
            let noise = noise::fit(&residuals, &basis);
            Block {
                of: of as f64,
                columns,
                residuals,
                basis,
                noise,
            }
        })
        .collect();

    let mut covariance = DMatrix::zeros(q, q);
    let mut spread = DVector::<f64>::zeros(q);
    for block in &blocks {
        let Some(noise) = &block.noise else { continue };
        // The columns of J_d B: what the residuals of this data set move the coordinates by.
        let c = &block.columns * &inverse * block.of;
        let part = block.middle(&noise.autocovariance(c.nrows()), &c);
        for j in 0..q {
            spread[j] += 2.0 * part[(j, j)].powi(2) / noise.freedom;
        }
        let mut slopes = DMatrix::zeros(noise.a.len(), q);
        for i in 0..noise.a.len() {
            let h = 1e-3;
            let at = |by: f64| {
                let mut a = noise.a.clone();
                a[i] += by;
                block.at(&a, noise, &c)
            };
            let slope = (at(h) - at(-h)) / (2.0 * h);
            slopes.set_row(i, &slope.transpose());
        }
        for j in 0..q {
            let g = slopes.column(j);
            spread[j] += g.dot(&(&noise.covariance * g));
        }
        covariance += part;
    }
    let spread_over = |m: &DMatrix<f64>| {
        let mut all = DMatrix::zeros(p, p);
        for (a, &i) in moving.iter().enumerate() {
            for (b, &j) in moving.iter().enumerate() {
                all[(i, j)] = m[(a, b)];
            }
        }
        all
    };
    let mut freedom = vec![f64::INFINITY; p];
    for (a, &j) in moving.iter().enumerate() {
        let v = covariance[(a, a)];
        if spread[a] > 0.0 {
            freedom[j] = (2.0 * v * v / spread[a]).max(LEAST_FREEDOM);
        }
    }
    let covariance = spread_over(&covariance);
    let half = (0..p)
        .map(|j| match covariance[(j, j)] {
            v if v > 0.0 => two_sided(level, freedom[j]) * v.sqrt(),
            v if v.is_nan() => f64::INFINITY,
            _ => 0.0,
        })
        .collect();
    let linear = |c: &Coordinate| matches!(c.scale, Scale::Linear(_));
    Uncertainty {
        linear: coordinates.iter().map(linear).collect(),
        inverse: spread_over(&inverse),
        covariance,
        freedom,
        half,
        noise: blocks.into_iter().map(|b| b.noise).collect(),
        singular: order.iter().map(|&i| value(i).sqrt()).collect(),
        empty,
        moving,
    }
}
