//! Levenberg-Marquardt for a few positive parameters, with confidence intervals.
//!
//! Parameters are fitted as logarithms, so they stay positive and steps are relative. The Jacobian comes
//! from central differences. With `S = sum r^2`, `n` residuals and `p` parameters the covariance of the
//! logarithms is `S/(n - p) (J^T J)^-1`. D. W. Marquardt, *SIAM J. Appl. Math.* 11 (1963) 431.

use nalgebra::{DMatrix, DVector};

#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    pub x: Vec<f64>,
    /// Half width of the 95 % confidence interval of each parameter, relative to it.
    pub relative_95: Vec<f64>,
    /// Sum of squared residuals.
    pub sum: f64,
    pub evaluations: u32,
    /// The sum of squares stopped falling before the bound on iterations.
    pub converged: bool,
}

/// Relative change of a parameter for the Jacobian.
const DIFFERENCE: f64 = 1e-4;
const MAX_ITERATIONS: u32 = 40;

/// Minimises `sum r(x)^2` from `x0 > 0`; `residuals` returns `None` where they cannot be evaluated.
/// `None` when not even the start can.
pub fn fit(mut residuals: impl FnMut(&[f64]) -> Option<Vec<f64>>, x0: &[f64]) -> Option<Fit> {
    let p = x0.len();
    let mut evaluations = 0;
    let mut eval = |z: &DVector<f64>| {
        evaluations += 1;
        let x: Vec<f64> = z.iter().map(|z| z.exp()).collect();
        residuals(&x).map(DVector::from_vec)
    };
    let mut z = DVector::from_iterator(p, x0.iter().map(|x| x.ln()));
    let mut r = eval(&z)?;
    let mut sum = r.norm_squared();
    let mut lambda = 1e-2;
    let mut converged = false;
    let mut normal = DMatrix::zeros(p, p);
    for _ in 0..MAX_ITERATIONS {
        let mut jacobian = DMatrix::zeros(r.len(), p);
        for j in 0..p {
            let mut moved = z.clone();
            moved[j] += DIFFERENCE;
            let up = eval(&moved);
            moved[j] -= 2.0 * DIFFERENCE;
            let column = match (up, eval(&moved)) {
                (Some(a), Some(b)) => (a - b) / (2.0 * DIFFERENCE),
                (Some(a), None) => (a - &r) / DIFFERENCE,
                (None, Some(b)) => (&r - b) / DIFFERENCE,
                (None, None) => return None,
            };
            jacobian.set_column(j, &column);
        }
        normal = jacobian.tr_mul(&jacobian);
        let gradient = jacobian.tr_mul(&r);
        let mut improved = false;
        while lambda < 1e10 {
            let mut damped = normal.clone();
            for j in 0..p {
                damped[(j, j)] += lambda * normal[(j, j)].max(1e-300);
            }
            let Some(mut step) = damped.cholesky().map(|c| c.solve(&-&gradient)) else {
                lambda *= 10.0;
                continue;
            };
            // Half a decade at once is as far as a linear model may be trusted.
            let longest = step.amax();
            if longest > 1.15 {
                step *= 1.15 / longest;
            }
            let trial = &z + &step;
            match eval(&trial) {
                Some(rt) if rt.norm_squared() < sum => {
                    let gained = 1.0 - rt.norm_squared() / sum;
                    z = trial;
                    r = rt;
                    sum = r.norm_squared();
                    lambda = (lambda * 0.2).max(1e-9);
                    improved = true;
                    converged = gained < 1e-7 || step.amax() < 1e-8;
                    break;
                }
                _ => lambda *= 5.0,
            }
        }
        if !improved {
            converged = true;
        }
        if converged {
            break;
        }
    }
    let freedom = (r.len().max(p + 1) - p) as f64;
    let covariance = normal.try_inverse().map(|m| m * (sum / freedom));
    let relative_95 = (0..p)
        .map(|j| {
            covariance
                .as_ref()
                .map_or(f64::INFINITY, |c| 1.96 * c[(j, j)].max(0.0).sqrt())
        })
        .collect();
    Some(Fit {
        x: z.iter().map(|z| z.exp()).collect(),
        relative_95,
        sum,
        evaluations,
        converged,
    })
}

#[cfg(test)]
mod tests {
    use super::fit;

    #[test]
    fn recovers_known_parameters() {
        // y = a exp(-b t) with a = 2.5, b = 0.7, exact data.
        let t: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.1).collect();
        let model =
            |x: &[f64]| -> Vec<f64> { t.iter().map(|t| x[0] * (-x[1] * t).exp()).collect() };
        let y = model(&[2.5, 0.7]);
        let got = fit(
            |x| Some(model(x).iter().zip(&y).map(|(a, b)| a - b).collect()),
            &[1.0, 2.0],
        )
        .unwrap();
        assert!(
            (got.x[0] - 2.5).abs() < 1e-8 && (got.x[1] - 0.7).abs() < 1e-8,
            "{got:?}"
        );
    }

    #[test]
    fn interval_covers_the_truth_and_scales_with_noise() {
        let t: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
        let model =
            |x: &[f64]| -> Vec<f64> { t.iter().map(|t| x[0] * (-x[1] * t).exp()).collect() };
        // A fixed, zero-mean, non-smooth disturbance.
        let noise = |i: usize, s: f64| s * ((i as f64 * 12.9898).sin() * 43_758.547).fract();
        let with = |s: f64| {
            let y: Vec<f64> = model(&[2.5, 0.7])
                .iter()
                .enumerate()
                .map(|(i, y)| y + noise(i, s))
                .collect();
            fit(
                |x| Some(model(x).iter().zip(&y).map(|(a, b)| a - b).collect()),
                &[1.0, 2.0],
            )
            .unwrap()
        };
        let (small, large) = (with(0.01), with(0.1));
        let ratio = large.relative_95[1] / small.relative_95[1];
        assert!((7.0..14.0).contains(&ratio), "{ratio}");
        assert!(
            (small.x[1] / 0.7 - 1.0).abs() < 3.0 * small.relative_95[1],
            "{small:?}"
        );
    }

    #[test]
    fn a_start_that_cannot_be_evaluated_is_no_fit() {
        assert_eq!(fit(|_| None, &[1.0]), None);
    }
}
