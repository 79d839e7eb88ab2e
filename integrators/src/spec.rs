//! Methods as data: identifier and parameters, and their text form `rk4` or `newmark(beta=0.3)`. This module has the
//! only parser of that form.

use crate::linear_stability::Stability;
use crate::method::{Integrator, MethodInfo, Resolution};
use crate::scheme::Scheme;
use crate::table::{FREE_FLIGHT, METHODS, Method};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// Largest number of parameters of a method.
pub(crate) const MOST_PARAMETERS: usize = 2;

/// A method of the table with its parameters. The text form is `id` or `id(name=value, ...)`, with the given
/// parameters in declared order.
#[derive(Clone, Copy)]
pub struct MethodSpec {
    row: &'static Method,
    /// Given values of the parameters of the method, in declared order.
    given: [Option<f64>; MOST_PARAMETERS],
    /// Given value of [`FREE_FLIGHT`], if any.
    free_flight: Option<bool>,
}

/// Reason why a requested method, step or tolerance is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MethodError {
    /// The table has no method with this identifier.
    #[error("there is no integrator `{0}`; there are {known}", known = ids().join(", "))]
    Unknown(String),
    /// The list has no method.
    #[error("no integrator named; there are {}", ids().join(", "))]
    Empty,
    /// A parameter is unknown, out of range or malformed.
    #[error("{0}")]
    Parameter(String),
    /// A step or tolerance is malformed or does not suit the method.
    #[error("{0}")]
    Resolution(String),
}

/// Returns the identifiers of all methods, in the order of the table.
pub fn ids() -> Vec<&'static str> {
    METHODS.iter().map(|m| m.info.id).collect()
}

impl MethodSpec {
    /// Returns a method of the table with its default parameters.
    pub const fn of(row: &'static Method) -> Self {
        Self {
            row,
            given: [None; MOST_PARAMETERS],
            free_flight: None,
        }
    }

    /// Sets the only parameter of a method in a constant expression; an invalid value does not compile.
    #[must_use]
    pub const fn with_value(mut self, value: f64) -> Self {
        let parameters = self.row.info.parameters;
        assert!(parameters.len() == 1);
        let (low, high) = parameters[0].range;
        assert!(low <= value && value <= high);
        self.given[0] = Some(value);
        self
    }

    /// Sets a parameter by name: one of the method, or [`FREE_FLIGHT`].
    pub fn with(mut self, name: &str, value: f64) -> Result<Self, MethodError> {
        let info = self.row.info;
        let wrong = |why: String| Err(MethodError::Parameter(why));
        if name == FREE_FLIGHT.name {
            if value != 0.0 && value != 1.0 {
                return wrong(format!("{} {name} = {value} is neither 0 nor 1", info.id));
            }
            let on = value == 1.0;
            if !self.build().free_flight(on) {
                let what = if on {
                    "steps through flights"
                } else {
                    "always crosses flights in one step"
                };
                return wrong(format!("{} {what}; leave `{name}` out", info.id));
            }
            self.free_flight = Some(on);
            return Ok(self);
        }
        if name == "coast" {
            return wrong(format!("`coast` is called `{}`", FREE_FLIGHT.name));
        }
        let Some(i) = info.parameters.iter().position(|p| p.name == name) else {
            let known: Vec<&str> = info.parameters.iter().map(|p| p.name).collect();
            return wrong(if known.is_empty() {
                format!(
                    "{} has no parameters of its own, but `{name}` was given; all methods take `{}`",
                    info.id, FREE_FLIGHT.name
                )
            } else {
                let known = known.join(", ");
                let (id, all) = (info.id, FREE_FLIGHT.name);
                format!("{id} has no parameter `{name}`; it has {known} and {all}")
            });
        };
        let (low, high) = info.parameters[i].range;
        if !(low..=high).contains(&value) {
            return wrong(format!(
                "{} {name} = {value} lies outside [{low}, {high}]",
                info.id
            ));
        }
        self.given[i] = Some(value);
        Ok(self)
    }

    /// Returns the declared properties of the method.
    pub const fn info(&self) -> &'static MethodInfo {
        self.row.info
    }

    /// Returns the identifier of the method, without parameters.
    pub const fn id(&self) -> &'static str {
        self.row.info.id
    }

    /// Returns the value of a parameter of the method, given or default; `None` if there is no such parameter.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        let i = self.info().parameters.iter().position(|p| p.name == name)?;
        Some(self.values()[i])
    }

    fn values(&self) -> Vec<f64> {
        (self.info().parameters.iter().zip(self.given))
            .map(|(p, given)| given.unwrap_or(p.default))
            .collect()
    }

    /// Builds an integrator that is ready to run.
    pub fn build(&self) -> Box<dyn Integrator> {
        let mut built = (self.row.make)(&self.values());
        if let Some(on) = self.free_flight {
            built.free_flight(on);
        }
        built
    }

    /// Returns the data that determine the stability of the method at fixed steps.
    pub fn stability(&self) -> Stability {
        (self.row.stability)(&self.values())
    }

    /// Combines the method with a step or tolerance.
    pub const fn at(self, resolution: Resolution) -> Scheme {
        Scheme {
            method: self,
            resolution,
        }
    }

    /// Combines the method with a fixed step [s].
    pub const fn at_step(self, h: f64) -> Scheme {
        self.at(Resolution::Step(h))
    }

    /// Combines the method with a relative tolerance.
    pub const fn at_tolerance(self, rtol: f64) -> Scheme {
        self.at(Resolution::Tolerance(rtol))
    }
}

impl PartialEq for MethodSpec {
    fn eq(&self, other: &Self) -> bool {
        (self.id(), self.given, self.free_flight) == (other.id(), other.given, other.free_flight)
    }
}

impl fmt::Display for MethodSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let own = self.info().parameters.iter().zip(self.given);
        let mut given: Vec<String> = own
            .filter_map(|(p, value)| Some(format!("{}={}", p.name, value?)))
            .collect();
        given.extend((self.free_flight).map(|on| format!("{}={}", FREE_FLIGHT.name, u8::from(on))));
        // Padding is for the whole.
        f.pad(&match given.is_empty() {
            true => self.id().to_owned(),
            false => format!("{}({})", self.id(), given.join(", ")),
        })
    }
}

impl fmt::Debug for MethodSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl FromStr for MethodSpec {
    type Err = MethodError;

    fn from_str(text: &str) -> Result<Self, MethodError> {
        let wrong = |why: String| MethodError::Parameter(why);
        let text = text.trim();
        let (id, parameters) = match text.split_once('(') {
            Some((id, rest)) => {
                let inner = rest
                    .strip_suffix(')')
                    .ok_or_else(|| wrong(format!("`{text}`: the closing bracket is missing")))?;
                (id.trim(), inner)
            }
            None => (text, ""),
        };
        let row = (METHODS.iter().find(|m| m.info.id == id))
            .ok_or_else(|| MethodError::Unknown(id.into()))?;
        let parts = parameters.split(',').map(str::trim);
        parts
            .filter(|p| !p.is_empty())
            .try_fold(Self::of(row), |spec, part| {
                let (name, value) = part.split_once('=').ok_or_else(|| {
                    wrong(format!(
                        "`{part}`: expected name=value, for example rho_inf=0.8"
                    ))
                })?;
                let value = value.trim();
                let number: f64 = (value.parse())
                    .map_err(|_| wrong(format!("`{part}`: `{value}` is not a number")))?;
                spec.with(name.trim(), number)
            })
    }
}

impl Serialize for MethodSpec {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for MethodSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{GENERALISED_ALPHA, NEWMARK, RK4};

    #[test]
    fn text_and_back() {
        for m in METHODS {
            let spec: MethodSpec = m.info.id.parse().unwrap();
            assert_eq!((spec, spec.build().info()), (MethodSpec::of(m), m.info));
            for text in [
                m.info.id.to_owned(),
                format!("{}(free_flight=1)", m.info.id),
            ] {
                let spec: MethodSpec = text.parse().unwrap();
                assert_eq!(spec.to_string(), text);
                let json = serde_json::to_string(&spec).unwrap();
                assert_eq!(json, format!("\"{text}\""));
                assert_eq!(serde_json::from_str::<MethodSpec>(&json).unwrap(), spec);
            }
        }
        let spec: MethodSpec = " newmark( free_flight = 1,beta=0.30 ) ".parse().unwrap();
        assert_eq!(spec.to_string(), "newmark(beta=0.3, free_flight=1)");
        assert_eq!("newmark()".parse(), Ok(NEWMARK));
        assert_eq!(format!("{RK4:>5}|"), "  rk4|");
    }

    #[test]
    fn parameters_are_given_or_default() {
        const SOFT: MethodSpec = GENERALISED_ALPHA.with_value(0.5);
        assert_eq!(SOFT.parameter("rho_inf"), Some(0.5));
        assert_eq!(
            SOFT.with("rho_inf", 0.25).unwrap().parameter("rho_inf"),
            Some(0.25)
        );
        assert_eq!(NEWMARK.parameter("beta"), Some(0.25));
        assert_eq!(NEWMARK.parameter("rho_inf"), None);
        assert_ne!(SOFT, GENERALISED_ALPHA);
    }

    #[test]
    fn refusals_say_what_is_known() {
        for (text, says) in [
            ("rk5", "semi-implicit-euler"),
            ("rk4(h=1)", "no parameters"),
            ("rk4(free_flight=0.5)", "neither 0 nor 1"),
            ("rk4(coast=1)", "is called `free_flight`"),
            ("trigonometric(free_flight=0)", "always crosses"),
            ("newmark(gamma=0.5)", "it has beta"),
            ("newmark(beta=2)", "outside [0, 0.5]"),
            ("newmark(beta=NaN)", "outside"),
            ("newmark(beta)", "name=value"),
            ("newmark(beta=x)", "not a number"),
            ("newmark(beta=0.2", "closing bracket"),
        ] {
            let error = text.parse::<MethodSpec>().unwrap_err().to_string();
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}
