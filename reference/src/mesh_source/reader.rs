//! Parameters of a gear as its model reads them: numbers in their ranges, errors that name model and key.

use gearbench_models::error::{BuildError, Reason};
use gearbench_models::gear::table::GearContext;

/// Parameters of a gear as its model reads them: errors name model and key.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    /// Id of the model.
    pub model: &'static str,
    /// Context from which the gear is built.
    pub context: &'a GearContext<'a>,
}

impl Reader<'_> {
    /// An error about a parameter.
    pub fn error(&self, key: &str, why: impl Into<Reason>) -> BuildError {
        BuildError::parameter(self.model, key, why)
    }

    /// Returns a positive number, if one is given.
    pub fn positive(&self, key: &str, value: Option<f64>) -> Result<Option<f64>, BuildError> {
        match value {
            Some(x) if !(x.is_finite() && x > 0.0) => {
                Err(self.error(key, "expected a number above 0"))
            }
            value => Ok(value),
        }
    }

    /// Returns the constants of a damping `alpha M + beta K` [1/s, s], zero where they are not given.
    ///
    /// # Errors
    /// [`BuildError`] for a number below zero.
    pub fn rayleigh(&self, given: Option<[f64; 2]>) -> Result<[f64; 2], BuildError> {
        let both = given.unwrap_or_default();
        match both.iter().all(|x| x.is_finite() && *x >= 0.0) {
            true => Ok(both),
            false => Err(self.error(
                "rayleigh",
                "expected two numbers of 0 or more: [alpha, beta]",
            )),
        }
    }

    /// A number of 0 or more; 0 when none is given.
    pub fn not_negative(&self, key: &str, value: Option<f64>) -> Result<f64, BuildError> {
        match value {
            Some(x) if !(x.is_finite() && x >= 0.0) => {
                Err(self.error(key, "expected a number of 0 or more"))
            }
            value => Ok(value.unwrap_or(0.0)),
        }
    }

    /// Returns a whole number from `least` to `most`, if one is given.
    pub fn count(
        &self,
        key: &str,
        value: Option<usize>,
        least: usize,
        most: usize,
    ) -> Result<Option<usize>, BuildError> {
        match value {
            Some(n) if !(least..=most).contains(&n) => Err(self.error(
                key,
                format!("expected a whole number from {least} to {most}"),
            )),
            value => Ok(value),
        }
    }
}
