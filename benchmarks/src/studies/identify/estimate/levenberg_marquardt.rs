//! Levenberg-Marquardt minimisation of a sum of squares between bounds.
//!
//! The step of `min |r(z)|^2` solves `(J^T J + lambda diag(J^T J)) d = -J^T r` over the coordinates that are free: one on
//! a bound is held while the gradient points outwards. `J` comes from central differences, at a bound from one side.
//! D. W. Marquardt, *SIAM J. Appl. Math.* 11 (1963) 431; C. T. Kelley, *Iterative Methods for Optimization*, SIAM 1999,
//! ch. 5 (projected steps). A fit ends by its work, never by a clock.
//!
//! **Why differences.** Where contact is elastic the force is continuous when flanks touch and part, so that the sensitivity
//! of the motion passes through these events without a jump, and differences converge as they would without events. Held
//! against the exact sensitivities of one oscillator (`sensitivity_tests`: closed form, times of touch and release included)
//! their error is below 2e-5 of a column, and moves an estimate by less than a fiftieth of its standard error. Exact ones
//! through every segment would cost a run for each parameter in the place of two: of the fits of `spur_impact`, 42 and 1795
//! trials in 0.1 and 3.9 s of one processor, half at most, beside the minutes to hours of the finite elements that are
//! fitted. Nothing is gained where so little is spent.

use super::coordinates::Coordinate;
use nalgebra::{DMatrix, DVector};

/// Residuals at coordinates; `None` where they cannot be evaluated.
pub type Residuals<'a> = dyn FnMut(&[f64]) -> Option<Vec<f64>> + 'a;

/// A minimum of the sum of squares.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// Coordinates at the minimum.
    pub z: Vec<f64>,
    /// Residuals at the minimum.
    pub residuals: DVector<f64>,
    /// Derivatives of the residuals by the coordinates, one column per coordinate.
    pub jacobian: DMatrix<f64>,
    /// Sum of squared residuals.
    pub sum: f64,
    /// Number of evaluations of the residuals.
    pub evaluations: u32,
    /// True if the sum converged before the bound on iterations.
    pub converged: bool,
    /// Coordinates that ended on a bound with the sum falling outwards.
    pub at_bound: Vec<bool>,
}

/// Change of a coordinate for the Jacobian: the error of central differences is its square.
const DIFFERENCE: f64 = 1e-3;
/// Largest number of iterations.
const MAX_ITERATIONS: u32 = 60;
/// Longest step of a coordinate: half a decade is as far as a linear model may be trusted.
const LONGEST: f64 = 1.15;
/// Step below which a fit has converged.
const SHORTEST: f64 = 1e-7;

/// Stopping criterion and extent of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Relative decrease of the sum in an iteration below which the fit has converged.
    pub settled: f64,
    /// True if the Jacobian at the minimum is computed; otherwise it is empty.
    pub jacobian: bool,
}

impl Effort {
    /// Effort for an estimate, with the Jacobian at the minimum.
    pub const WHOLE: Effort = Effort {
        settled: 1e-9,
        jacobian: true,
    };
    /// Effort for a sum of squares to two digits, without Jacobian.
    pub const SUM: Effort = Effort {
        settled: 1e-4,
        jacobian: false,
    };
}

/// Minimises from a start; coordinates that are not `free` stay. `None` when not even the start can be evaluated.
pub fn minimise(
    residuals: &mut Residuals<'_>,
    coordinates: &[Coordinate],
    free: &[bool],
    start: &[f64],
    effort: Effort,
) -> Option<Minimum> {
    let p = start.len();
    let mut evaluations = 0;
    let mut eval = |z: &[f64]| {
        evaluations += 1;
        let r = residuals(z).map(DVector::from_vec)?;
        r.iter().all(|x| x.is_finite()).then_some(r)
    };
    let clamp = |z: &[f64]| -> Vec<f64> {
        (z.iter().zip(coordinates))
            .map(|(&z, c)| c.clamp(z))
            .collect()
    };
    let mut z = clamp(start);
    let mut r = eval(&z)?;
    let mut sum = r.norm_squared();
    let mut lambda = 1e-2;
    let mut converged = false;
    let mut iterations = 0;
    loop {
        if converged && !effort.jacobian {
            return Some(Minimum {
                z,
                residuals: r,
                jacobian: DMatrix::zeros(0, 0),
                sum,
                evaluations,
                converged,
                at_bound: vec![false; p],
            });
        }
        let jacobian = differences(&mut eval, coordinates, free, &z, &r)?;
        let normal = jacobian.tr_mul(&jacobian);
        let gradient = jacobian.tr_mul(&r);
        let outwards: Vec<bool> = (0..p)
            .map(|j| {
                let [low, high] = coordinates[j].range();
                let edge = 1e-9 * (1.0 + z[j].abs());
                (z[j] <= low + edge && gradient[j] > 0.0)
                    || (z[j] >= high - edge && gradient[j] < 0.0)
            })
            .collect();
        let moving: Vec<usize> = (0..p).filter(|&j| free[j] && !outwards[j]).collect();
        if converged || iterations == MAX_ITERATIONS || moving.is_empty() || sum == 0.0 {
            return Some(Minimum {
                z,
                residuals: r,
                jacobian,
                sum,
                evaluations,
                converged: converged || moving.is_empty() || sum == 0.0,
                at_bound: (0..p).map(|j| free[j] && outwards[j]).collect(),
            });
        }
        iterations += 1;
        converged = true;
        while lambda < 1e10 {
            let part = DMatrix::from_fn(moving.len(), moving.len(), |a, b| {
                let (i, j) = (moving[a], moving[b]);
                let more = if a == b {
                    lambda * normal[(i, i)].max(1e-300)
                } else {
                    0.0
                };
                normal[(i, j)] + more
            });
            let down = DVector::from_fn(moving.len(), |a, _| -gradient[moving[a]]);
            let Some(mut step) = part.cholesky().map(|c| c.solve(&down)) else {
                lambda *= 10.0;
                continue;
            };
            let longest = step.amax();
            if longest > LONGEST {
                step *= LONGEST / longest;
            }
            let mut trial = z.clone();
            for (a, &j) in moving.iter().enumerate() {
                trial[j] = coordinates[j].clamp(z[j] + step[a]);
            }
            match eval(&trial) {
                Some(at) if at.norm_squared() < sum => {
                    let gained = 1.0 - at.norm_squared() / sum;
                    z = trial;
                    r = at;
                    sum = r.norm_squared();
                    lambda = (lambda * 0.2).max(1e-9);
                    converged = gained < effort.settled || step.amax() < SHORTEST;
                    break;
                }
                // Steps this short cannot make the sum fall further.
                _ if step.amax() < 0.01 * SHORTEST => break,
                _ => lambda *= 5.0,
            }
        }
        // The damping is reset if no trial reduced the sum of squares.
        lambda = lambda.min(1.0);
    }
}

/// The Jacobian by central differences; columns of coordinates that are not free are zero.
fn differences(
    eval: &mut impl FnMut(&[f64]) -> Option<DVector<f64>>,
    coordinates: &[Coordinate],
    free: &[bool],
    z: &[f64],
    r: &DVector<f64>,
) -> Option<DMatrix<f64>> {
    let mut jacobian = DMatrix::zeros(r.len(), z.len());
    for j in (0..z.len()).filter(|&j| free[j]) {
        let mut at = |to: f64| {
            let inside = coordinates[j].clamp(to) == to;
            let mut moved = z.to_vec();
            moved[j] = to;
            inside.then(|| eval(&moved)).flatten()
        };
        let (up, down) = (at(z[j] + DIFFERENCE), at(z[j] - DIFFERENCE));
        let column = match (up, down) {
            (Some(a), Some(b)) => (a - b) / (2.0 * DIFFERENCE),
            (Some(a), None) => (a - r) / DIFFERENCE,
            (None, Some(b)) => (r - b) / DIFFERENCE,
            (None, None) => return None,
        };
        jacobian.set_column(j, &column);
    }
    Some(jacobian)
}

#[cfg(test)]
mod tests {
    use super::super::coordinates::{Scale, values};
    use super::*;

    fn decay(x: &[f64]) -> Vec<f64> {
        (0..40)
            .map(|i| x[0] * (-x[1] * 0.1 * f64::from(i)).exp())
            .collect()
    }

    fn fit(all: &[Coordinate], free: &[bool], start: [f64; 2]) -> Minimum {
        let y = decay(&[2.5, 0.7]);
        let mut residuals = |z: &[f64]| {
            let found = decay(&values(all, z));
            Some(found.iter().zip(&y).map(|(a, b)| a - b).collect())
        };
        let z: Vec<f64> = all.iter().zip(start).map(|(c, x)| c.of(x)).collect();
        minimise(&mut residuals, all, free, &z, Effort::WHOLE).unwrap()
    }

    #[test]
    fn exact_data_give_their_parameters_back() {
        let all = [Coordinate::POSITIVE; 2];
        let got = fit(&all, &[true; 2], [1.0, 2.0]);
        let x = values(&all, &got.z);
        assert!(
            (x[0] - 2.5).abs() < 1e-8 && (x[1] - 0.7).abs() < 1e-8,
            "{x:?}"
        );
        assert!(got.converged && got.at_bound == [false; 2]);
    }

    /// The constrained minimum lies on the bound, and the other parameter is what it is best at there.
    #[test]
    fn bounds_are_kept_and_what_is_fixed_stays() {
        let bounded = Coordinate {
            scale: Scale::Linear(1.0),
            bounds: [0.0, 0.5],
        };
        let all = [Coordinate::POSITIVE, bounded];
        let got = fit(&all, &[true; 2], [1.0, 0.2]);
        let x = values(&all, &got.z);
        assert_eq!((x[1], got.at_bound.as_slice()), (0.5, &[false, true][..]));
        let y = decay(&[2.5, 0.7]);
        let shape = decay(&[1.0, 0.5]);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!((x[0] / (dot(&shape, &y) / dot(&shape, &shape)) - 1.0).abs() < 1e-6);
        let held = fit(&all, &[true, false], [1.0, 0.2]);
        assert_eq!(values(&all, &held.z)[1], 0.2);
        assert_eq!(held.jacobian.column(1).amax(), 0.0);
    }

    #[test]
    fn a_start_that_cannot_be_evaluated_is_no_fit() {
        let one = [Coordinate::POSITIVE];
        assert!(minimise(&mut |_| None, &one, &[true], &[0.0], Effort::WHOLE).is_none());
    }
}
