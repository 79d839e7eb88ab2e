//! The record of an identification: fits, estimates with their intervals, and parameters that the data do not
//! determine.

use crate::record::Results;
use crate::record::checks::{each, same_length};
use crate::series::TimeSeries;
use crate::studies::Part;
use crate::words::words;
use serde::{Deserialize, Serialize};

/// The part of a record that is specific to an identification.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct IdentifyRecord {
    /// Fits, one per model.
    pub fits: Vec<FitRecord>,
    /// Runs of the scene that measured curves are compared with: each fitted model with its initial and with its
    /// identified constants; empty without measured curves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<FitHistory>,
}

words! {
    /// Constants that a model of a fit ran with.
    pub enum ConstantSet {
        /// Constants that the fit started from.
        #[default]
        Initial = "initial",
        /// Constants that the fit found.
        Identified = "identified",
    }
}

/// Histories of a model of a fit over the time of the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FitHistory {
    /// Label of the model in its scene.
    pub label: String,
    /// Set of constants that the histories were computed with.
    pub constants: ConstantSet,
    /// Histories over the time of the scene.
    pub series: TimeSeries,
}

impl Results {
    /// Returns the fits; empty in records of other studies.
    pub fn fits(&self) -> &[FitRecord] {
        match &self.part {
            Part::Identify(part) => &part.fits,
            _ => &[],
        }
    }
}

words! {
    /// Outcome of the fit for one parameter.
    pub enum Outcome {
        /// The data determine it.
        #[default]
        Identified = "identified",
        /// The data would have it beyond a bound; its value is the bound.
        AtBound = "at bound",
        /// The parameter was held at its given value.
        Held = "held",
        /// The data do not determine it; it has no value.
        NotIdentifiable = "not identifiable",
    }
}

words! {
    /// Quantity of a data set.
    pub enum DataKind {
        /// The contact force over time.
        #[default]
        Force = "force",
        /// A torque on a gear, at a mount or through a shaft over time.
        Torque = "torque",
        /// A speed over time.
        Speed = "speed",
        /// An angle of rotation over time.
        Angle = "angle",
        /// The compliance of the mesh at rest over positions in a mesh cycle.
        Compliance = "compliance",
    }
}

/// A model fitted to data.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FitRecord {
    /// Label of the model in its scene.
    pub label: String,
    /// Parameters of the fit, held ones included.
    pub parameters: Vec<ParameterRecord>,
    /// Correlation of the parameters that were fitted, in their order, a row each.
    pub correlation: Vec<Vec<f64>>,
    /// Condition number of the sensitivities; absent where a combination of parameters has no effect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub condition: Option<f64>,
    /// Combinations of parameters that the data do not determine, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub undetermined: Vec<String>,
    /// Data sets of the fit, and data sets held out for validation.
    pub data: Vec<DataRecord>,
    /// Profiles of the sum of squares over single parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub profiles: Vec<ProfileRecord>,
    /// Evaluations of the model on all data.
    pub evaluations: u32,
    /// Number of starting points.
    pub starts: usize,
    /// Starting points that led to the same least sum of squares within 0.1 %.
    pub starts_agreed: usize,
}

/// A parameter of a fit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ParameterRecord {
    /// Key as written in scenes, with the unit at its end.
    pub key: String,
    /// Name of the parameter in words.
    pub name: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Outcome of the fit for this parameter.
    pub outcome: Outcome,
    /// Value; absent where the data do not determine it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Lower end of the 95 % interval; absent where it is open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// Upper end of the 95 % interval; absent where it is open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
    /// Degrees of freedom of its variance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub freedom: Option<f64>,
    /// True if the interval comes from a profile, because the problem is not linear over it.
    pub by_profile: bool,
}

impl ParameterRecord {
    /// Returns half the width of the interval over the magnitude of the value, where both ends are known.
    pub fn relative(&self) -> Option<f64> {
        let (low, high) = (self.low?, self.high?);
        let x = self.value.filter(|x| *x != 0.0)?;
        (self.outcome == Outcome::Identified).then_some(0.5 * (high - low) / x.abs())
    }
}

/// A data set with the values of the fitted model at the same abscissa.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct DataRecord {
    /// Name of the data set.
    pub name: String,
    /// True if the data were held out of the fit, for validation.
    pub validation: bool,
    /// Quantity of the data set.
    pub kind: DataKind,
    /// Weight of its residuals over their size.
    pub weight: f64,
    /// Relative L2 error of the fitted model against the data.
    pub l2: f64,
    /// Relative error of the greatest force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_rel: Option<f64>,
    /// Relative error of the impulse.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impulse_rel: Option<f64>,
    /// Autocorrelation at lag 1 of the noise process of which the residuals are a sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation_lag1: Option<f64>,
    /// Order of that process.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_order: Option<usize>,
    /// Times \[s\] of a history, positions in base pitches of a compliance.
    pub abscissa: Vec<f64>,
    /// The data \[N, N m, rad/s, rad, m/N\].
    pub data: Vec<f64>,
    /// Values of the fitted model at the abscissa \[N, N m, rad/s, rad, m/N\].
    pub model: Vec<f64>,
}

/// Rise of the sum of squares of a fit with one parameter held away from its estimate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ProfileRecord {
    /// Key of the parameter.
    pub key: String,
    /// Values at which the parameter was held.
    pub value: Vec<f64>,
    /// Signed root of the scaled rise of the sum of squares.
    pub deviation: Vec<f64>,
    /// Deviation at the ends of the 95 % interval.
    pub quantile: f64,
}

impl FitRecord {
    /// Returns the label of the axis of a parameter: its name in words with its unit.
    pub fn axis_name(&self, key: &str) -> String {
        match self.parameters.iter().find(|p| p.key == key) {
            Some(p) if p.unit.is_empty() => p.name.clone(),
            Some(p) => format!("{} [{}]", p.name, p.unit),
            None => key.to_owned(),
        }
    }

    /// Checks the lengths of its lists.
    pub(crate) fn validate(&self) -> Result<(), String> {
        each("data", &self.data, |d| {
            let n = d.abscissa.len();
            same_length("data", d.data.len(), "abscissa", n)?;
            same_length("model", d.model.len(), "abscissa", n)
        })?;
        each("profiles", &self.profiles, |p| {
            same_length("deviation", p.deviation.len(), "value", p.value.len())
        })
    }

    /// Removes all numbers that are not finite.
    pub fn keep_finite(&mut self) {
        let finite = |x: Option<f64>| x.filter(|x| x.is_finite());
        self.condition = finite(self.condition);
        for p in &mut self.parameters {
            p.value = finite(p.value);
            p.low = finite(p.low);
            p.high = finite(p.high);
            p.freedom = finite(p.freedom);
        }
        for d in &mut self.data {
            d.peak_rel = finite(d.peak_rel);
            d.impulse_rel = finite(d.impulse_rel);
            d.correlation_lag1 = finite(d.correlation_lag1);
        }
        let numbers = |all: &[f64]| all.iter().all(|x| x.is_finite());
        self.data
            .retain(|d| d.l2.is_finite() && numbers(&d.data) && numbers(&d.model));
        self.profiles
            .retain(|p| numbers(&p.value) && numbers(&p.deviation));
    }
}
