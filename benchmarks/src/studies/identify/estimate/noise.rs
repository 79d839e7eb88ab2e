//! Correlated residuals: an autoregressive process fitted by restricted maximum likelihood.
//!
//! Residuals of a fit are `e = (I - H) u`, with `u` a stationary process and `H` the projection on the columns `X` of the
//! Jacobian. The fit takes out of `u` what `X` can follow, so that the autocovariance of `e` is too small. Restricted
//! likelihood (H. D. Patterson, R. Thompson, *Biometrika* 58 (1971) 545) is that of the contrasts that `X` does not touch,
//!
//! ```text
//! -2 l = (n - k) ln s^2 + ln|R| + ln|X^T R^-1 X| + const,    s^2 = min_b |R^(-1/2) (e - X b)|^2 / (n - k)
//! ```
//!
//! with `R` the covariance of an AR(p) of unit innovations. It is written in partial autocorrelations `tanh(a_i)`, for
//! which every `a` is stationary (O. Barndorff-Nielsen, G. Schou, *J. Multivar. Anal.* 3 (1973) 408), and evaluated by
//! the recursion of Levinson and Durbin in O(n (p + k^2)). A process may be correlated over half the data at most, its
//! integrated correlation being `prod (1 + tanh a_i)/(1 - tanh a_i) = exp(2 sum a_i)` samples: beyond that nothing tells
//! its level from that of the model, and no data would be long enough to tell anything. The order is that of the least corrected information
//! criterion (C. M. Hurvich, C.-L. Tsai, *Biometrika* 76 (1989) 297).

use nalgebra::{DMatrix, DVector};

/// Greatest order that is tried.
const MOST: usize = 8;
/// Samples per order at least.
const SAMPLES_PER_ORDER: usize = 8;
/// Rise of `-2 l` per square beyond the longest correlation.
const BEYOND: f64 = 1e4;
/// Bound of `a`: a partial autocorrelation of 0.9999.
const STEEPEST: f64 = 4.95;

/// Stationary autoregressive process of the residuals.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Inverse hyperbolic tangents of the partial autocorrelations.
    pub a: Vec<f64>,
    /// Variance of the innovations.
    pub variance: f64,
    /// Degrees of freedom of the variance.
    pub freedom: f64,
    /// Covariance of the estimates `a`.
    pub covariance: DMatrix<f64>,
}

impl Noise {
    /// Returns the autocovariances at the lags 0 to `n - 1`.
    pub fn autocovariance(&self, n: usize) -> Vec<f64> {
        autocovariance(&self.a, n)
            .into_iter()
            .map(|g| g * self.variance)
            .collect()
    }

    /// Returns the autocorrelation at a lag.
    pub fn correlation(&self, lag: usize) -> f64 {
        let g = autocovariance(&self.a, lag + 1);
        g[lag] / g[0]
    }

    /// Returns the standard deviation of the process.
    pub fn deviation(&self) -> f64 {
        self.autocovariance(1)[0].sqrt()
    }
}

/// Coefficients of the predictions from the last `0..=p` samples, and the variances of their errors for unit innovations.
fn levinson(a: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let kappa: Vec<f64> = a.iter().map(|a| a.tanh()).collect();
    let product: f64 = kappa.iter().map(|k| 1.0 - k * k).product();
    let (mut rows, mut variances) = (vec![Vec::new()], vec![1.0 / product]);
    for (m, &k) in kappa.iter().enumerate() {
        let before: &Vec<f64> = &rows[m];
        let mut row: Vec<f64> = (0..m).map(|i| before[i] - k * before[m - 1 - i]).collect();
        row.push(k);
        rows.push(row);
        variances.push(variances[m] * (1.0 - k * k));
    }
    (rows, variances)
}

/// Computes the autocovariances for unit innovations.
fn autocovariance(a: &[f64], n: usize) -> Vec<f64> {
    let (rows, variances) = levinson(a);
    let p = a.len();
    let mut g = vec![variances[0]];
    for lag in 1..n.max(p + 1) {
        let m = lag.min(p);
        // Up to the order the prediction of that order, with its partial autocorrelation, gives the next covariance.
        let row = &rows[m];
        let value = if lag <= p {
            let before = &rows[lag - 1];
            let inner: f64 = (0..lag - 1).map(|i| before[i] * g[lag - 1 - i]).sum();
            inner + row[lag - 1] * variances[lag - 1]
        } else {
            (0..p).map(|i| row[i] * g[lag - 1 - i]).sum()
        };
        g.push(value);
    }
    g.truncate(n);
    g
}

/// `R^(-1/2) x`, and `ln|R|`.
fn whitened(a: &[f64], x: &[f64]) -> Vec<f64> {
    let (rows, variances) = levinson(a);
    (0..x.len())
        .map(|t| {
            let m = t.min(a.len());
            let predicted: f64 = rows[m]
                .iter()
                .enumerate()
                .map(|(i, f)| f * x[t - 1 - i])
                .sum();
            (x[t] - predicted) / variances[m].sqrt()
        })
        .collect()
}

/// Computes `-2 l` and `s^2` at partial autocorrelations.
pub(super) fn restricted(a: &[f64], e: &[f64], basis: &DMatrix<f64>) -> (f64, f64) {
    let (n, k) = (e.len(), basis.ncols());
    let (_, variances) = levinson(a);
    let determinant: f64 = variances.iter().take(n.min(a.len())).map(|v| v.ln()).sum();
    let y = DVector::from_vec(whitened(a, e));
    let mut sum = y.norm_squared();
    let mut inner = 0.0;
    if k > 0 {
        let mut x = DMatrix::zeros(n, k);
        for j in 0..k {
            let column: Vec<f64> = basis.column(j).iter().copied().collect();
            x.set_column(j, &DVector::from_vec(whitened(a, &column)));
        }
        let qr = x.qr();
        let r = qr.r();
        inner = (0..k).map(|j| 2.0 * r[(j, j)].abs().max(1e-300).ln()).sum();
        sum -= qr.q().tr_mul(&y).norm_squared();
    }
    let freedom = (n - k) as f64;
    let variance = (sum / freedom).max(f64::MIN_POSITIVE);
    (freedom * variance.ln() + determinant + inner, variance)
}

/// Gradient and Hessian of a function of a few numbers by central differences.
fn derivatives(f: &dyn Fn(&[f64]) -> f64, a: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
    let (p, h, here) = (a.len(), 1e-3, f(a));
    let at = |moves: &[(usize, f64)]| {
        let mut moved = a.to_vec();
        moves.iter().for_each(|&(i, by)| moved[i] += by);
        f(&moved)
    };
    let mut gradient = DVector::zeros(p);
    let mut hessian = DMatrix::zeros(p, p);
    for i in 0..p {
        let (up, down) = (at(&[(i, h)]), at(&[(i, -h)]));
        gradient[i] = (up - down) / (2.0 * h);
        hessian[(i, i)] = (up - 2.0 * here + down) / (h * h);
        for j in 0..i {
            let cross = at(&[(i, h), (j, h)]) - at(&[(i, h), (j, -h)]) - at(&[(i, -h), (j, h)])
                + at(&[(i, -h), (j, -h)]);
            hessian[(i, j)] = cross / (4.0 * h * h);
            hessian[(j, i)] = hessian[(i, j)];
        }
    }
    (gradient, hessian)
}

/// `|H|` with its eigenvalues at least `floor`, inverted.
fn inverse(hessian: &DMatrix<f64>, floor: f64) -> DMatrix<f64> {
    let eigen = hessian.clone().symmetric_eigen();
    let inverted = eigen.eigenvalues.map(|l| 1.0 / l.abs().max(floor));
    let v = &eigen.eigenvectors;
    v * DMatrix::from_diagonal(&inverted) * v.transpose()
}

/// Damped Newton steps on `-2 l` of an order from a start.
fn climb(f: &dyn Fn(&[f64]) -> f64, start: Vec<f64>) -> (Vec<f64>, f64) {
    let (mut a, mut value) = (start.clone(), f(&start));
    for _ in 0..40 {
        let (gradient, hessian) = derivatives(f, &a);
        let mut step = -inverse(&hessian, 1.0) * &gradient;
        let longest = step.amax();
        if longest > 0.7 {
            step *= 0.7 / longest;
        }
        let before = value;
        for _ in 0..12 {
            let trial: Vec<f64> = (a.iter().zip(step.iter()))
                .map(|(a, d)| (a + d).clamp(-STEEPEST, STEEPEST))
                .collect();
            let at = f(&trial);
            if at < value {
                (a, value) = (trial, at);
                break;
            }
            step *= 0.4;
        }
        if before - value < 1e-7 {
            break;
        }
    }
    (a, value)
}

/// Fits the process to residuals of a fit with an orthonormal basis of its Jacobian's columns. `None` for residuals that
/// are too few, or nothing.
pub fn fit(e: &[f64], basis: &DMatrix<f64>) -> Option<Noise> {
    let (n, k) = (e.len(), basis.ncols());
    if n < k + 3 || e.iter().all(|e| *e == 0.0) {
        return None;
    }
    let most = MOST.min((n - k) / SAMPLES_PER_ORDER);
    let longest = 0.5 * (0.5 * n as f64).max(1.0).ln();
    let f = |a: &[f64]| {
        let beyond = (a.iter().sum::<f64>() - longest).max(0.0);
        restricted(a, e, basis).0 + BEYOND * beyond * beyond
    };
    let mut best: Option<(Vec<f64>, f64)> = None;
    let mut start: Vec<f64> = Vec::new();
    for p in 0..=most {
        let (a, value) = match p {
            0 => (Vec::new(), f(&[])),
            _ => climb(&f, start.clone()),
        };
        start = [a.as_slice(), &[0.0]].concat();
        let (m, q) = ((n - k) as f64, (p + 1) as f64);
        let criterion = value + 2.0 * q * m / (m - q - 1.0).max(1.0);
        if best.as_ref().is_none_or(|b| criterion < b.1) {
            best = Some((a, criterion));
        }
    }
    let (a, _) = best?;
    let (_, variance) = restricted(&a, e, basis);
    // Twice the inverse of the Hessian of -2 l is the inverse of the information.
    let covariance = match a.is_empty() {
        true => DMatrix::zeros(0, 0),
        false => 2.0 * inverse(&derivatives(&f, &a).1, 1.0),
    };
    Some(Noise {
        a,
        variance,
        freedom: (n - k) as f64,
        covariance,
    })
}
