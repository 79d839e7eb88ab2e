//! Profiles: increase of the sum of squares when one parameter is fixed away from its estimate and all others are
//! fitted again.
//!
//! `S_j(z)` is the least sum of squares with coordinate `j` held at `z`. Near its least `S` it is `S + (z - z_j)^2/B_jj`
//! with `B = (J^T J)^-1`. With correlated residuals the sum is no likelihood; scaled so that its curvature gives the
//! variance `C_jj` of the fit, `D(z) = (S_j(z) - S) B_jj/C_jj`, its signed root is a standardised deviation, and the
//! interval is where it stays below the quantile (R. E. Chandler, S. Bate, *Biometrika* 94 (2007) 167; D. M. Bates,
//! D. G. Watts, *Nonlinear Regression Analysis*, Wiley 1988, ch. 6). Where the problem is not linear over the interval the
//! two ends lie at unequal distances, or there is none.

use super::coordinates::Coordinate;
use super::levenberg_marquardt::{Effort, Minimum, Residuals, minimise};
use super::uncertainty::Uncertainty;

/// Profile of one coordinate: the increase of the sum of squares over its fixed values.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Fixed values of the coordinate, ascending.
    pub z: Vec<f64>,
    /// Standardised deviations at the fixed values: signed root of the scaled increase.
    pub deviation: Vec<f64>,
    /// Ends of the interval; infinite where the increase stays below the quantile.
    pub interval: [f64; 2],
    /// True if the problem is not linear over the linear interval, so that the interval is that of the profile.
    pub bent: bool,
    /// Standardised deviation at the ends of the interval.
    pub quantile: f64,
}

impl Profile {
    /// True if the data do not bound the coordinate on both sides: the interval has an infinite end although the fit
    /// was tried at values that differ by more than a hundredth. Closer by, the sum of squares of data without noise is
    /// rounding.
    pub fn is_open(&self, coordinate: &Coordinate) -> bool {
        let best = (self.z.iter().zip(&self.deviation)).find(|(_, d)| **d == 0.0);
        let Some(best) = best.map(|(z, _)| coordinate.value(*z)) else {
            return false;
        };
        let tried = [self.z.first(), self.z.last()];
        (self.interval.iter().zip(tried)).any(|(end, tried)| {
            let apart = tried.map_or(0.0, |z| (coordinate.value(*z) - best).abs());
            !end.is_finite() && apart > APART * best.abs()
        })
    }
}

/// Relative deviation of the profile from the straight line above which the profile gives the interval.
pub const BENT: f64 = 0.15;
/// Relative distance of values that a measurement can distinguish.
const APART: f64 = 0.01;
/// Places of a profile in half widths.
const PLACES: [f64; 5] = [0.5, 1.0, 1.5, 2.25, 4.0];
/// Largest half width of a step: over several factors a fixed value is no longer near the estimate.
const FURTHEST: f64 = 3.0;

/// Fit whose profiles are computed.
pub struct ProfiledFit<'a> {
    /// Coordinates of the parameters.
    pub coordinates: &'a [Coordinate],
    /// Minimum of the sum of squares.
    pub minimum: &'a Minimum,
    /// Uncertainty at the minimum.
    pub known: &'a Uncertainty,
}

impl ProfiledFit<'_> {
    /// Returns the standardised deviation with coordinate `j` fixed a number of half widths away, with its place.
    fn at(&self, residuals: &mut Residuals<'_>, j: usize, widths: f64) -> Option<(f64, f64)> {
        let ProfiledFit {
            coordinates,
            minimum,
            known,
        } = self;
        let (c, b) = (known.covariance[(j, j)], known.inverse[(j, j)]);
        let wanted = minimum.z[j] + widths * known.half[j].min(FURTHEST);
        let held = coordinates[j].clamp(wanted);
        // The others start where the linear problem has them.
        let mut start = minimum.z.clone();
        for &i in &known.moving {
            start[i] += known.inverse[(i, j)] / b * (held - minimum.z[j]);
        }
        start[j] = held;
        let free: Vec<bool> = (0..start.len())
            .map(|i| i != j && known.moving.contains(&i))
            .collect();
        let found = minimise(residuals, coordinates, &free, &start, Effort::SUM)?;
        let rise = ((found.sum - minimum.sum) * b / c).max(0.0);
        Some((held, rise.sqrt().copysign(widths)))
    }

    /// The profile of a coordinate that moved; only its first step either way where it is as straight as it should be, then
    /// without the profile's own interval.
    pub fn of(&self, residuals: &mut Residuals<'_>, j: usize, always: bool) -> Option<Profile> {
        let half = self.known.half[j];
        let se = self.known.covariance[(j, j)].sqrt();
        if !(half > 0.0 && se > 0.0) {
            return None;
        }
        let t = half / se;
        let ends = [-1.0, 1.0].map(|side| self.at(residuals, j, side));
        let straight = |end: &Option<(f64, f64)>| {
            end.is_some_and(|(z, d)| {
                let expected = (z - self.minimum.z[j]) / se;
                (d / expected - 1.0).abs() < BENT
            })
        };
        let bent = half > FURTHEST || !ends.iter().all(straight);
        if !bent && !always {
            return None;
        }
        let mut points = vec![(self.minimum.z[j], 0.0)];
        for side in [-1.0, 1.0] {
            for place in PLACES {
                let point = match (place == 1.0, side < 0.0) {
                    (true, true) => ends[0],
                    (true, false) => ends[1],
                    _ => self.at(residuals, j, side * place),
                };
                points.extend(point);
                // Beyond the quantile there is nothing to learn.
                if point.is_some_and(|(_, d)| d.abs() > 1.3 * t) && place >= 1.0 {
                    break;
                }
            }
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.dedup_by(|a, b| a.0 == b.0);
        let crossing = |level: f64| {
            let pair = points.windows(2).find(|w| {
                let (a, b) = (w[0].1 - level, w[1].1 - level);
                a <= 0.0 && b >= 0.0
            })?;
            let [(z0, d0), (z1, d1)] = [pair[0], pair[1]];
            Some(z0 + (z1 - z0) * (level - d0) / (d1 - d0).max(f64::MIN_POSITIVE))
        };
        let z = &self.minimum.z[j];
        let interval = if bent {
            [
                crossing(-t).unwrap_or(f64::NEG_INFINITY),
                crossing(t).unwrap_or(f64::INFINITY),
            ]
        } else {
            [z - half, z + half]
        };
        Some(Profile {
            z: points.iter().map(|p| p.0).collect(),
            deviation: points.iter().map(|p| p.1).collect(),
            interval,
            bent,
            quantile: t,
        })
    }
}
