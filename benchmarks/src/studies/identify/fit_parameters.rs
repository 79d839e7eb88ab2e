//! Parameters of a fit, and its starting points.

use super::estimate::coordinates::{Coordinate, values};
use super::parameters::Parameter;
use crate::scene_file::calibration::{CURVATURE, Constants, SLOPE};
use crate::scene_file::changes::KeyPath;
use std::f64::consts::PI;

/// Ratio by which further starting points differ from the model's, either way.
const SCATTER: f64 = 2.0;

/// Clock of a recorder: the time of the scene is `offset + scale t` at its time `t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the scene at time zero of the recorder [s].
    pub offset: f64,
    /// Seconds of the scene over seconds of the recorder.
    pub scale: f64,
}

impl Default for Clock {
    /// The clock of the scene.
    fn default() -> Self {
        Clock {
            offset: 0.0,
            scale: 1.0,
        }
    }
}

impl Clock {
    /// The time of the scene at a time of the recorder [s].
    pub fn scene_time(self, t: f64) -> f64 {
        self.offset + self.scale * t
    }
}

/// The parameters of a fit.
#[derive(Clone, Debug, Default)]
pub struct FitParameters {
    /// Parameters of the fit, those with a fixed value included.
    pub parameters: Vec<Parameter>,
    /// Coordinates of the parameters.
    pub coordinates: Vec<Coordinate>,
    /// True for parameters that are fitted; the others keep their starting value.
    pub free: Vec<bool>,
    /// Fixed values of the other parameters, with all digits.
    pub held: Vec<Option<f64>>,
    /// For every data set the first one of its recorder.
    pub recorders: Vec<usize>,
    /// Starting points in coordinates.
    pub starts: Vec<Vec<f64>>,
}

impl FitParameters {
    /// Returns true for parameters that refine an existing model: variations of a stiffness along the path.
    pub fn courses(&self) -> Vec<bool> {
        let is_course =
            |p: &Parameter| matches!(p, Parameter::Constant(k) if k == SLOPE || k == CURVATURE);
        self.parameters.iter().map(is_course).collect()
    }

    /// Adds starting points about the first, over even places of a cube that an irrational step fills (a Kronecker
    /// sequence of `sqrt` of primes): the same each time, whatever the machine.
    pub(super) fn scatter(&mut self, count: usize) {
        let Some(first) = self.starts.first().cloned() else {
            return;
        };
        for n in 1..=count {
            let point = first.iter().enumerate().map(|(j, z)| {
                if !self.free[j] {
                    return *z;
                }
                let step = (2.0 + PI * j as f64).sqrt().fract();
                let place = (0.5 + step * n as f64).fract();
                self.coordinates[j].clamp(z + (2.0 * place - 1.0) * SCATTER.ln())
            });
            let point = point.collect();
            self.starts.push(point);
        }
    }

    /// Returns parameter values as constants of a calibration, without those of clocks.
    pub fn constants(&self, values: &[f64]) -> Constants {
        let named = self.parameters.iter().zip(values);
        Constants::of(named.filter_map(|(p, &x)| match p {
            Parameter::Constant(key) => Some((key.as_str(), x)),
            Parameter::Key(_) | Parameter::Clock(_) | Parameter::ClockScale(_) => None,
        }))
    }

    /// Returns parameter values that are keys of the scene.
    pub fn keys(&self, values: &[f64]) -> Vec<(KeyPath, f64)> {
        let named = self.parameters.iter().zip(values);
        let of = |(p, x): (&Parameter, &f64)| match p {
            Parameter::Key(path) => Some((path.clone(), *x)),
            Parameter::Constant(_) | Parameter::Clock(_) | Parameter::ClockScale(_) => None,
        };
        named.filter_map(of).collect()
    }

    /// Returns the constants from which a fit starts.
    pub fn initial(&self) -> Option<Constants> {
        let start = values(&self.coordinates, self.starts.first()?);
        let held = start.iter().zip(&self.held);
        let all: Vec<f64> = held.map(|(x, held)| held.unwrap_or(*x)).collect();
        Some(self.constants(&all))
    }

    /// Returns the clock of the recorder of a data set.
    pub fn clock(&self, values: &[f64], set: usize) -> Clock {
        let first = self.recorders.get(set).copied().unwrap_or(set);
        let value = |of: Parameter| {
            let place = self.parameters.iter().position(|p| *p == of)?;
            values.get(place).copied()
        };
        Clock {
            offset: value(Parameter::Clock(first)).unwrap_or(0.0),
            scale: value(Parameter::ClockScale(first)).unwrap_or(1.0),
        }
    }
}
