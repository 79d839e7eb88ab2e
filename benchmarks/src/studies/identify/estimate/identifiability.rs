//! Identifiability: the combinations of parameters that the data determine.
//!
//! Coordinates are scaled so that one is what a prior guess may be off by: a factor e, a typical gap, or the value itself
//! where that is greater. A direction among them
//! is not determined where the residuals do not change along it at all (a singular value of nothing), or where the 95 %
//! interval along it reaches further than a factor of two: then the data say less than any guess, and a number would be
//! an answer to another question. R. Brun, P. Reichert, H. R. Kuensch, *Water Resour. Res.* 37 (2001) 1015.

use super::levenberg_marquardt::Minimum;
use super::uncertainty::Uncertainty;
use nalgebra::DMatrix;
use std::f64::consts::LN_2;

/// Part of a direction from which on a parameter belongs to it.
const PART: f64 = 0.1;

/// A combination of parameters that the data do not determine.
#[derive(Clone, Debug, PartialEq)]
pub struct UndeterminedCombination {
    /// Unit vector over the coordinates.
    pub direction: Vec<f64>,
    /// Half width of the 95 % interval along it in scaled coordinates; infinite where the data do not change along it.
    pub half: f64,
}

impl UndeterminedCombination {
    /// Returns the coordinates that belong to the combination, those with the greatest part first.
    pub fn members(&self) -> Vec<usize> {
        let of = &self.direction;
        let mut all: Vec<usize> = (0..of.len()).filter(|&j| of[j].abs() > PART).collect();
        all.sort_by(|&a, &b| of[b].abs().total_cmp(&of[a].abs()));
        all
    }
}

/// Returns the prior uncertainty of each coordinate: one, or its magnitude where its scale is linear and that is
/// greater.
fn sizes(minimum: &Minimum, known: &Uncertainty) -> Vec<f64> {
    let linear = |j: usize| known.linear[j].then(|| minimum.z[j].abs());
    (0..minimum.z.len())
        .map(|j| linear(j).unwrap_or(1.0).max(1.0))
        .collect()
}

/// Returns the combinations of parameters that are not determined.
pub fn weak(minimum: &Minimum, known: &Uncertainty) -> Vec<UndeterminedCombination> {
    let empty = known.empty.iter().map(|direction| UndeterminedCombination {
        direction: direction.clone(),
        half: f64::INFINITY,
    });
    let mut all: Vec<UndeterminedCombination> = empty.collect();
    let size = sizes(minimum, known);
    let p = size.len();
    // Residuals that wander without bound leave no interval at all.
    let open = (known.moving.iter()).filter(|&&j| !known.covariance[(j, j)].is_finite());
    let alone = open.map(|&j| UndeterminedCombination {
        direction: (0..p).map(|i| f64::from(u8::from(i == j))).collect(),
        half: f64::INFINITY,
    });
    all.extend(alone);
    if !known.covariance.iter().all(|c| c.is_finite()) {
        return all;
    }
    let scaled = DMatrix::from_fn(p, p, |i, j| known.covariance[(i, j)] / (size[i] * size[j]));
    let eigen = scaled.symmetric_eigen();
    // Quantiles differ little between parameters: the widest serves.
    let t = (known.moving.iter())
        .map(|&j| known.half[j] / known.covariance[(j, j)].sqrt())
        .filter(|t| t.is_finite())
        .fold(0.0, f64::max);
    for (i, &variance) in eigen.eigenvalues.iter().enumerate() {
        let half = t * variance.max(0.0).sqrt();
        if half > LN_2 {
            let direction = eigen.eigenvectors.column(i).iter().copied().collect();
            all.push(UndeterminedCombination { direction, half });
        }
    }
    all
}

/// Returns true for coordinates without a usable value: members of a combination that is not determined, if its
/// interval is infinite or the coordinate's own interval is as wide.
pub fn unknown(
    minimum: &Minimum,
    known: &Uncertainty,
    weak: &[UndeterminedCombination],
) -> Vec<bool> {
    let size = sizes(minimum, known);
    (0..known.half.len())
        .map(|j| {
            weak.iter().any(|w| {
                let member = w.direction[j].abs() > PART;
                member && (w.half.is_infinite() || known.half[j] > LN_2 * size[j])
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    /// A coordinate with infinite variance has no value, and its combination is named.
    #[test]
    fn without_an_interval_there_is_no_answer() {
        let minimum = Minimum {
            z: vec![1.0, 2.0],
            residuals: DVector::zeros(3),
            jacobian: DMatrix::zeros(3, 2),
            sum: 0.0,
            evaluations: 1,
            converged: true,
            at_bound: vec![false; 2],
        };
        for (variance, weak_ones) in [(1e-4, 0), (f64::INFINITY, 2), (f64::NAN, 2)] {
            let known = Uncertainty {
                linear: vec![false; 2],
                moving: vec![0, 1],
                covariance: DMatrix::from_diagonal_element(2, 2, variance),
                inverse: DMatrix::zeros(2, 2),
                freedom: vec![f64::INFINITY; 2],
                half: vec![2.0 * variance.sqrt(); 2],
                noise: vec![None],
                singular: vec![1.0; 2],
                empty: vec![],
            };
            let weak = weak(&minimum, &known);
            assert_eq!(weak.len(), weak_ones, "{variance}");
            let unknown = unknown(&minimum, &known, &weak);
            assert_eq!(unknown, [weak_ones > 0; 2], "{variance}");
        }
    }
}
