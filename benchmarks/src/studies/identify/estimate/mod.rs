//! Estimation of a few parameters from data with correlated errors: the mathematics, without gears.
//!
//! | module | owns |
//! |---|---|
//! | [`coordinates`] | parameters as numbers of order one between bounds |
//! | [`levenberg_marquardt`] | the fit |
//! | [`noise`] | the process that the residuals are a part of |
//! | [`uncertainty`] | covariance under that process, degrees of freedom |
//! | [`identifiability`] | combinations that the data do not determine |
//! | [`profile`] | intervals where the problem is not linear over them |
//! | `student` | quantiles |

pub mod coordinates;
pub mod identifiability;
pub mod levenberg_marquardt;
pub mod noise;
pub mod profile;
mod student;
#[cfg(test)]
pub(super) mod tests;
pub mod uncertainty;

use coordinates::Coordinate;
use identifiability::{UndeterminedCombination, unknown, weak};
use levenberg_marquardt::{Effort, Minimum, Residuals, minimise};
use profile::{Profile, ProfiledFit};
use uncertainty::{Uncertainty, uncertainty};

/// Confidence level of all intervals.
pub const LEVEL: f64 = 0.95;

/// Estimation problem: coordinates, data blocks and starting points.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Coordinates of the parameters.
    pub coordinates: Vec<Coordinate>,
    /// True for parameters that are fitted; the others keep their starting value.
    pub free: Vec<bool>,
    /// Number of residuals of each data set: correlated within, independent between.
    pub blocks: Vec<usize>,
    /// Starting points in coordinates.
    pub starts: Vec<Vec<f64>>,
    /// True for parameters that refine a model which exists without them, at zero: fits start without them as well.
    pub courses: Vec<bool>,
    /// True if profiles of all parameters are computed, in place of those that need them.
    pub profiles: bool,
}

/// Result of an estimation: minimum, uncertainty, and combinations that are not determined.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Minimum of the sum of squares.
    pub minimum: Minimum,
    /// Covariance and degrees of freedom at the minimum.
    pub known: Uncertainty,
    /// Combinations that the data do not determine.
    pub weak: Vec<UndeterminedCombination>,
    /// True for parameters that have no usable value.
    pub unknown: Vec<bool>,
    /// Profiles of the parameters, where they were computed.
    pub profiles: Vec<Option<Profile>>,
    /// Values and 95 % intervals; the interval of a parameter which was not fitted is its value alone.
    pub values: Vec<(f64, [f64; 2])>,
    /// Sums of squares reached from each start; `None` where one could not be evaluated.
    pub starts: Vec<Option<f64>>,
    /// Total number of evaluations of the residuals.
    pub evaluations: u32,
}

impl Estimate {
    /// Returns the correlation of two parameters; 0 where one was not fitted or is on a bound.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        let c = &self.known.covariance;
        let size = (c[(i, i)] * c[(j, j)]).sqrt();
        if size > 0.0 { c[(i, j)] / size } else { 0.0 }
    }

    /// Returns the condition number of the Jacobian; infinite where a direction changes nothing.
    pub fn condition(&self) -> f64 {
        let s = &self.known.singular;
        match (s.first(), s.last()) {
            (Some(a), Some(b)) if *b > 0.0 => a / b,
            (None, _) => 1.0,
            _ => f64::INFINITY,
        }
    }
}

/// Fits so far: the sum reached from each start, and the least minimum.
#[derive(Default)]
struct FitProgress {
    /// Sums of squares as in [`Estimate::starts`].
    sums: Vec<Option<f64>>,
    least: Option<Minimum>,
    evaluations: u32,
}

impl FitProgress {
    /// Minimises from further starting points.
    fn from(
        &mut self,
        (coordinates, free): (&[Coordinate], &[bool]),
        starts: &[Vec<f64>],
        residuals: &mut Residuals<'_>,
    ) {
        for start in starts {
            let found = minimise(residuals, coordinates, free, start, Effort::SUM);
            self.sums.push(found.as_ref().map(|m| m.sum));
            let Some(found) = found else { continue };
            self.evaluations += found.evaluations;
            if self.least.as_ref().is_none_or(|l| found.sum < l.sum) {
                self.least = Some(found);
            }
        }
    }
}

/// Returns the fits with the variations along the path fixed at zero, if there are any.
fn simplest(problem: &Problem, residuals: &mut Residuals<'_>) -> FitProgress {
    let courses: Vec<usize> = (0..problem.free.len())
        .filter(|&j| problem.free[j] && problem.courses[j])
        .collect();
    let mut descents = FitProgress::default();
    if courses.is_empty() {
        return descents;
    }
    let (mut free, mut starts) = (problem.free.clone(), problem.starts.clone());
    for j in courses {
        let c = &problem.coordinates[j];
        free[j] = false;
        starts.iter_mut().for_each(|s| s[j] = c.clamp(c.of(0.0)));
    }
    descents.from((&problem.coordinates, &free), &starts, residuals);
    descents
}

/// Solves an estimation problem; `None` where no start can be evaluated.
pub fn estimate(problem: &Problem, residuals: &mut Residuals<'_>) -> Option<Estimate> {
    let Problem {
        coordinates, free, ..
    } = problem;
    let mut descents = FitProgress::default();
    descents.from((coordinates, free), &problem.starts, residuals);
    // What refines a model leads into valleys of its own: the best without it is a start too.
    let simple = simplest(problem, residuals);
    descents.evaluations += simple.evaluations;
    let nested = simple.least.map(|m| m.z);
    descents.from((coordinates, free), nested.as_slice(), residuals);
    let FitProgress {
        sums: starts,
        least,
        mut evaluations,
    } = descents;
    // Minima are distinguished with a coarse tolerance; the lowest is then converged.
    let minimum = minimise(residuals, coordinates, free, &least?.z, Effort::WHOLE)?;
    evaluations += minimum.evaluations;
    let known = uncertainty(&minimum, (coordinates, free), &problem.blocks, LEVEL);
    let weak = weak(&minimum, &known);
    let mut unknown = unknown(&minimum, &known, &weak);
    let mut counted = |z: &[f64]| {
        evaluations += 1;
        residuals(z)
    };
    let profiled = ProfiledFit {
        coordinates,
        minimum: &minimum,
        known: &known,
    };
    let profiles: Vec<Option<Profile>> = (0..coordinates.len())
        .map(
            |j| match known.empty.is_empty() && known.moving.contains(&j) {
                true => profiled.of(&mut counted, j, problem.profiles),
                false => None,
            },
        )
        .collect();
    // Data that bound a value to one side alone do not determine it.
    for (j, unknown) in unknown.iter_mut().enumerate() {
        *unknown |= (profiles[j].as_ref()).is_some_and(|p| p.is_open(&coordinates[j]));
    }
    let values = (0..coordinates.len())
        .map(|j| {
            let (c, z) = (&coordinates[j], minimum.z[j]);
            let own = [z - known.half[j], z + known.half[j]];
            let interval = profiles[j].as_ref().map_or(own, |p| p.interval);
            let ends = interval.map(|z| c.value(z).clamp(c.bounds[0], c.bounds[1]));
            (c.value(z), ends)
        })
        .collect();
    Some(Estimate {
        minimum,
        known,
        weak,
        unknown,
        profiles,
        values,
        starts,
        evaluations,
    })
}
