//! Coordinates of a fit: parameters transformed to numbers of order one, with bounds.
//!
//! Stiffnesses, masses and dampings are positive and known to a factor: their coordinate is the logarithm, so that steps
//! are relative. Gaps and offsets of a clock may be zero: theirs is the value over a typical size. A coordinate that
//! moves by one moves its parameter by as much as a prior guess may be off.

/// Transformation of a parameter into a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// The logarithm of a positive value.
    Logarithm,
    /// The value over a typical size of it.
    Linear(f64),
}

/// Coordinate of a parameter: its scale and bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// Scale of the coordinate, linear or logarithmic.
    pub scale: Scale,
    /// Least and greatest value of the parameter.
    pub bounds: [f64; 2],
}

impl Coordinate {
    /// Coordinate of a positive parameter without bounds.
    pub const POSITIVE: Coordinate = Coordinate {
        scale: Scale::Logarithm,
        bounds: [0.0, f64::INFINITY],
    };

    /// Returns the coordinate of a parameter value.
    pub fn of(&self, x: f64) -> f64 {
        match self.scale {
            Scale::Logarithm => x.ln(),
            Scale::Linear(size) => x / size,
        }
    }

    /// Returns the parameter value at a coordinate.
    pub fn value(&self, z: f64) -> f64 {
        match self.scale {
            Scale::Logarithm => z.exp(),
            Scale::Linear(size) => z * size,
        }
    }

    /// Returns the bounds of the coordinate.
    pub fn range(&self) -> [f64; 2] {
        self.bounds.map(|x| self.of(x))
    }

    /// Returns the coordinate clamped to the bounds.
    pub fn clamp(&self, z: f64) -> f64 {
        let [low, high] = self.range();
        z.max(low).min(high)
    }
}

/// Returns the parameter values at the coordinates `z`.
pub fn values(all: &[Coordinate], z: &[f64]) -> Vec<f64> {
    all.iter().zip(z).map(|(c, &z)| c.value(z)).collect()
}
